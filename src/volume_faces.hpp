// SPDX-License-Identifier: BSD-3-Clause
// Faces of volume elements.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A face by its corner nodes, ordered as in local_faces.
struct VolumeFace {
  std::array<Index, 4> nodes{};
  std::uint8_t n_nodes = 0;

  std::span<const Index> corners() const { return {nodes.data(), n_nodes}; }
};

/// Face `face` of an element.
VolumeFace volume_face(const ElementBlock& block, Index element, std::size_t face);

/// Faces that belong to exactly one volume element, by their nodes; in the order of their smallest
/// node, then of their other nodes. Elements with the same corners are one.
std::vector<VolumeFace> boundary_faces(const Mesh& mesh);

}  // namespace roughmesh::detail
