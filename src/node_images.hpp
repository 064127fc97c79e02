// SPDX-License-Identifier: BSD-3-Clause
// Nodes of a mesh that a translation carries into each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "disjoint_sets.hpp"

namespace roughmesh::detail {

/// What the links of a mesh say about its nodes.
struct NodeLinks {
  DisjointSets translated;         ///< nodes that are images by translations
  std::vector<std::uint8_t> held;  ///< n_nodes flags: an image by something else
};

NodeLinks node_links(const Mesh& mesh);

/// Unites nodes that differ by whole periods, to 1e-9 of the largest.
/// @param nodes   those to look at
/// @param period  0 along axes that are not periodic
void unite_by_position(const Mesh& mesh, std::span<const Index> nodes, const Vec3& period,
                       DisjointSets& classes);

}  // namespace roughmesh::detail
