// SPDX-License-Identifier: BSD-3-Clause
// Field points: the distinct positions of a surface, in an order that only positions decide.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

struct WeldedPoints {
  std::vector<Vec3> points;          ///< canonical order (docs/math.md, section "Points")
  std::vector<Index> point_of_node;  ///< for every node of the mesh, its point or -1
  Index n_coincident_nodes = 0;      ///< nodes at the positions of points that are on none
};

/// Points of the nodes that occur in `face_nodes`; no other node is on a point. One at the same
/// position belongs to something else, like a second body in contact, and is only counted.
/// @throws InputError  a coordinate that is not finite, or all positions are one
WeldedPoints weld_points(const Mesh& mesh, std::span<const Index> face_nodes);

}  // namespace roughmesh::detail
