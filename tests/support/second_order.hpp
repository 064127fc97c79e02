// SPDX-License-Identifier: BSD-3-Clause
// Elements of order 2 from those of order 1.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"

namespace roughmesh::test {

/// The mesh with straight elements of order 2; `complete`: with nodes in the middle of quadrangles
/// and hexahedra as well.
inline Mesh second_order(Mesh mesh, bool complete) {
  std::map<std::vector<Index>, Index> middles;
  const auto middle = [&](std::vector<Index> corners) {
    std::sort(corners.begin(), corners.end());
    const auto [at, is_new] = middles.try_emplace(corners, mesh.n_nodes());
    if (is_new) {
      Vec3 sum = Vec3::Zero();
      for (const Index node : corners) sum += mesh.nodes[node];
      mesh.nodes.push_back(sum / static_cast<double>(corners.size()));
    }
    return at->second;
  };
  for (ElementBlock& block : mesh.blocks) {
    const ElementShape shape = block.type.shape;
    std::vector<Index> nodes;
    for (Index e = 0; e < block.size(); ++e) {
      const auto old = block.element(e);
      nodes.insert(nodes.end(), old.begin(), old.end());
      for (const auto& [a, b] : local_edges(shape)) nodes.push_back(middle({old[a], old[b]}));
      for (const std::vector<int>& face : local_faces(shape))
        if (complete && face.size() == 4)
          nodes.push_back(middle({old[face[0]], old[face[1]], old[face[2]], old[face[3]]}));
      if (complete && (shape == ElementShape::quadrangle || shape == ElementShape::hexahedron))
        nodes.push_back(middle({old.begin(), old.end()}));
    }
    block.nodes = std::move(nodes);
    block.type = {shape, 2, static_cast<int>(block.nodes.size() / block.tags.size())};
  }
  number_nodes(mesh);
  return mesh;
}

}  // namespace roughmesh::test
