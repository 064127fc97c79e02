// SPDX-License-Identifier: BSD-3-Clause
// Physical groups of any dimension on the meshes that tests make.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"

namespace roughmesh::test {

/// A group of elements of one dimension, added to a mesh.
inline void add_group(Mesh& mesh, ElementType type, Tag tag, const std::string& name,
                      std::vector<Index> nodes) {
  mesh.blocks.push_back(make_block(type, 100 + tag, {tag}, std::move(nodes), 100000));
  mesh.groups.push_back({dimension(type.shape), tag, name});
  std::sort(mesh.groups.begin(), mesh.groups.end(), [](const auto& a, const auto& b) {
    return std::pair(a.dimension, a.tag) < std::pair(b.dimension, b.tag);
  });
}

/// [0, 1]^2 in `divisions` squares, its four sides being the line group "rim" (7).
inline Mesh framed_plate(int divisions) {
  Mesh mesh = plate(divisions);
  const auto node = [&](int i, int j) { return static_cast<Index>(j * (divisions + 1) + i); };
  std::vector<Index> lines;
  for (int i = 0; i < divisions; ++i)
    for (const int end : {0, divisions})
      lines.insert(lines.end(), {node(i, end), node(i + 1, end), node(end, i), node(end, i + 1)});
  add_group(mesh, line_type, 7, "rim", lines);
  return mesh;
}

}  // namespace roughmesh::test
