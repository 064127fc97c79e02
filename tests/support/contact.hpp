// SPDX-License-Identifier: BSD-3-Clause
// Bodies in contact, each with nodes of its own.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"

namespace roughmesh::test {

/// Gives the elements of block `body` nodes of their own where they share nodes with the faces of
/// block `faces`, at the same positions. The faces on the new nodes are group "far side" (9).
inline void detach(Mesh& mesh, std::size_t body, std::size_t faces) {
  ElementBlock far_side = mesh.blocks[faces];
  std::map<Index, Index> copies;
  for (Index& node : far_side.nodes) {
    const auto [at, is_new] = copies.try_emplace(node, mesh.n_nodes());
    if (is_new) mesh.nodes.push_back(Vec3(mesh.nodes[node]));
    node = at->second;
  }
  for (Index& node : mesh.blocks[body].nodes)
    if (const auto at = copies.find(node); at != copies.end()) node = at->second;
  far_side.physical_groups = {9};
  for (Tag& tag : far_side.tags) tag += 100'000;
  mesh.blocks.push_back(std::move(far_side));
  mesh.groups.push_back({2, 9, "far side"});
  number_nodes(mesh);
}

}  // namespace roughmesh::test
