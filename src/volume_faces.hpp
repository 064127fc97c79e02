// SPDX-License-Identifier: BSD-3-Clause
// Faces of volume elements, and lines around the elements of a planar mesh.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "element_nodes.hpp"

namespace roughmesh::detail {

/// A side of an element, its corners ordered as in local_faces.
struct CellFace {
  ElementType type;  ///< of order 1 for a side of an element of order above 2
  std::array<Index, most_face_nodes> nodes{};
  Tag element = 0;  ///< number in the file of the element it is a side of

  std::span<const Index> corners() const {
    return {nodes.data(), static_cast<std::size_t>(n_corners(type.shape))};
  }
  std::span<const Index> all() const {
    return {nodes.data(), static_cast<std::size_t>(type.n_nodes)};
  }
};

/// Side `face` of an element.
CellFace cell_face(const ElementBlock& block, Index element, std::size_t face);

/// Sides that belong to exactly one of the elements of dimension `cell_dimension`, by their
/// corners; in the order of their smallest node, then of their other nodes. Elements with the same
/// corners are one.
std::vector<CellFace> boundary_faces(const Mesh& mesh, int cell_dimension);

}  // namespace roughmesh::detail
