// SPDX-License-Identifier: BSD-3-Clause
// Where the nodes of elements of order 1 and 2 lie: on corners, edges, faces and inside.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Nodes of one face, at most those of a quadrangle of order 2 with a node in its middle.
inline constexpr std::size_t most_face_nodes = 9;

/// Of a side with so many corners, 2 to 4.
ElementShape shape_of_face(std::size_t n_corners);

/// One side of an element of dimension 2 or 3: its type, and its local nodes in the order of that
/// type, corners as in local_faces.
struct LocalFace {
  ElementType type;
  std::array<int, most_face_nodes> nodes{};
};

/// The sides of an element of order 1 or 2, in the order of local_faces. Of higher orders, those of
/// the element of order 1 with the same corners.
std::span<const LocalFace> element_faces(const ElementType& type);

/// Local nodes of the linear pieces that an element of dimension 1 or 2 falls into, each with the
/// orientation of the element, together on all of its nodes (docs/math.md, eq. 38). Of order 1 and
/// above 2, the element on its corners.
std::span<const std::vector<int>> facets(const ElementType& type);

/// A node of an element of order 2 that is no corner, as mean of others with weights that add up to
/// 1 (docs/math.md, eq. 38).
struct FollowingNode {
  int node = 0;
  std::vector<std::pair<int, double>> of_others;  ///< local number and weight
};

/// Nodes on edges first, then those in the middle of faces, then of the element: each depends on
/// earlier ones and corners only. Empty unless the order is 2.
std::span<const FollowingNode> following_nodes(const ElementType& type);

}  // namespace roughmesh::detail
