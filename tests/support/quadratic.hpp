// SPDX-License-Identifier: BSD-3-Clause
// One element of order 2 of every kind, on nodes of its own.
#pragma once

#include <random>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "support/meshes.hpp"

namespace roughmesh::test {

/// Types of order 2 that VTK has a cell for.
inline std::vector<ElementType> quadratic_types() {
  using enum ElementShape;
  return {{line, 2, 3},         {triangle, 2, 6},    {quadrangle, 2, 8},  {quadrangle, 2, 9},
          {tetrahedron, 2, 10}, {hexahedron, 2, 20}, {hexahedron, 2, 27}, {prism, 2, 15},
          {prism, 2, 18},       {pyramid, 2, 13}};
}

/// Positions at random: what is compared is their order.
inline Mesh quadratic_elements(const std::vector<ElementType>& types) {
  std::mt19937 random(5);
  Mesh mesh;
  Tag tag = 1;
  for (const ElementType& type : types) {
    std::vector<Index> nodes;
    for (int k = 0; k < type.n_nodes; ++k) {
      nodes.push_back(mesh.n_nodes());
      Vec3& x = mesh.nodes.emplace_back();
      for (int axis = 0; axis < 3; ++axis) x[axis] = static_cast<double>(random() % 1000) / 1024;
    }
    mesh.blocks.push_back(make_block(type, tag, {}, nodes, tag));
    ++tag;
  }
  number_nodes(mesh);
  return mesh;
}

}  // namespace roughmesh::test
