// SPDX-License-Identifier: BSD-3-Clause
// What the tests of surface formats share: small meshes, equality, normals computed by hand.
#pragma once

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/mesh.hpp"

#include "support/meshes.hpp"

namespace roughmesh::test {

inline constexpr ElementType quadrangle_type{ElementShape::quadrangle, 1, 4};

/// Two triangles and a quadrangle on a strip; node 6 is at the position of node 0, node 7 is used
/// by nothing. All coordinates are numbers of float32.
inline Mesh strip() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0},     {1, 0, 0.25}, {1, 1, 0}, {0, 1, -0.5},
                {2, 0, 0.125}, {2, 1, 0},    {0, 0, 0}, {9, 9, 9}};
  mesh.blocks = {make_block(triangle_type, 0, {}, {0, 1, 2, 6, 2, 3}, 1),
                 make_block(quadrangle_type, 0, {}, {1, 4, 5, 2}, 3)};
  number_nodes(mesh);
  return mesh;
}

/// The nearest numbers of float32. GCC 12 leaves the rounding out where it vectorizes conversions
/// to float and back, hence the volatile number.
inline Vec3 as_float(const Vec3& x) {
  Vec3 nearest;
  for (int k = 0; k < 3; ++k) {
    const volatile float rounded = static_cast<float>(x[k]);
    nearest[k] = rounded;
  }
  return nearest;
}

/// Positions and elements; not their groups and entities.
inline void expect_same_elements(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.nodes, b.nodes);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    EXPECT_EQ(a.blocks[i].type, b.blocks[i].type);
    EXPECT_EQ(a.blocks[i].nodes, b.blocks[i].nodes);
    EXPECT_EQ(a.blocks[i].tags, b.blocks[i].tags);
  }
}

/// Everything but positions.
inline void expect_same_topology(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.n_nodes(), b.n_nodes());
  EXPECT_EQ(a.node_tags, b.node_tags);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    EXPECT_EQ(a.blocks[i].type, b.blocks[i].type);
    EXPECT_EQ(a.blocks[i].entity, b.blocks[i].entity);
    EXPECT_EQ(a.blocks[i].physical_groups, b.blocks[i].physical_groups);
    EXPECT_EQ(a.blocks[i].nodes, b.blocks[i].nodes);
    EXPECT_EQ(a.blocks[i].tags, b.blocks[i].tags);
  }
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t i = 0; i < a.groups.size(); ++i) {
    EXPECT_EQ(a.groups[i].dimension, b.groups[i].dimension);
    EXPECT_EQ(a.groups[i].tag, b.groups[i].tag);
    EXPECT_EQ(a.groups[i].name, b.groups[i].name);
  }
}

/// Corners of the elements of each group, by its name.
inline std::map<std::string, std::multiset<std::vector<Index>>> elements_by_name(const Mesh& mesh) {
  std::map<std::string, std::multiset<std::vector<Index>>> elements;
  for (const ElementBlock& block : mesh.blocks)
    for (const Tag tag : block.physical_groups)
      for (const PhysicalGroup& group : mesh.groups)
        if (group.tag == tag && group.dimension == dimension(block.type.shape))
          for (Index i = 0; i < block.size(); ++i) {
            const auto element = block.element(i);
            elements[group.name].insert({element.begin(), element.end()});
          }
  return elements;
}

/// docs/math.md, eq. 2, at one node, from the angles at the corners: sin(angle) / (|a| |b|) times
/// the unit normal of the corner.
inline Vec3 normal_at(const Mesh& mesh, Index node) {
  Vec3 sum = Vec3::Zero();
  for (const ElementBlock& block : mesh.blocks)
    for (Index f = 0; f < block.size(); ++f) {
      const auto face = block.element(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        if (face[k] != node) continue;
        const auto at = [&](std::size_t j) {
          return mesh.nodes[static_cast<std::size_t>(face[j % face.size()])];
        };
        const Vec3 a = at(k + 1) - at(k), b = at(k + face.size() - 1) - at(k);
        const double angle = std::acos(a.dot(b) / (a.norm() * b.norm()));
        sum += std::sin(angle) / (a.norm() * b.norm()) * a.cross(b).normalized();
      }
    }
  return sum.normalized();
}

}  // namespace roughmesh::test
