// SPDX-License-Identifier: BSD-3-Clause
// Meshes that tests and benchmarks make themselves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::test {

inline ElementBlock make_block(ElementType type, Tag entity, std::vector<Tag> groups,
                               std::vector<Index> nodes, Tag first_tag) {
  ElementBlock block{type, entity, std::move(groups), std::move(nodes), {}};
  block.tags.resize(block.nodes.size() / static_cast<std::size_t>(type.n_nodes));
  std::iota(block.tags.begin(), block.tags.end(), first_tag);
  return block;
}

inline constexpr ElementType point_type{ElementShape::point, 1, 1};
inline constexpr ElementType line_type{ElementShape::line, 1, 2};
inline constexpr ElementType triangle_type{ElementShape::triangle, 1, 3};
inline constexpr ElementType tetrahedron_type{ElementShape::tetrahedron, 1, 4};

inline void number_nodes(Mesh& mesh) {
  mesh.node_tags.resize(mesh.nodes.size());
  std::iota(mesh.node_tags.begin(), mesh.node_tags.end(), Tag{1});
}

inline Mesh surface_mesh(std::vector<Vec3> nodes, std::vector<Index> triangles) {
  Mesh mesh;
  mesh.nodes = std::move(nodes);
  mesh.blocks = {make_block(triangle_type, 1, {1}, std::move(triangles), 1)};
  mesh.groups = {{2, 1, "surface"}};
  number_nodes(mesh);
  return mesh;
}

/// Icosahedron, each triangle split in four `subdivisions` times, on a sphere: 10 * 4^s + 2 nodes,
/// oriented outward.
inline Mesh icosphere(int subdivisions, double radius = 1.0) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> nodes = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                             {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                             {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Index> faces = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                              4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                              6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [it, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<Index>(nodes.size()));
      if (is_new) nodes.push_back((nodes[a] + nodes[b]) / 2);
      return it->second;
    };
    std::vector<Index> finer;
    for (std::size_t f = 0; f < faces.size(); f += 3) {
      const Index a = faces[f], b = faces[f + 1], c = faces[f + 2];
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    faces = std::move(finer);
  }
  for (Vec3& x : nodes) x *= radius / x.norm();
  return surface_mesh(std::move(nodes), std::move(faces));
}

/// Square [0, length]^2 in the plane z = 0, `divisions` squares along each side, two triangles
/// each; normal +z.
inline Mesh plate(int divisions, double length = 1.0) {
  std::vector<Vec3> nodes;
  for (int j = 0; j <= divisions; ++j)
    for (int i = 0; i <= divisions; ++i)
      nodes.emplace_back(length * i / divisions, length * j / divisions, 0.0);
  std::vector<Index> faces;
  const int row = divisions + 1;
  for (int j = 0; j < divisions; ++j)
    for (int i = 0; i < divisions; ++i) {
      const Index a = j * row + i, b = a + 1, c = a + row + 1, d = a + row;
      faces.insert(faces.end(), {a, b, c, a, c, d});
    }
  return surface_mesh(std::move(nodes), std::move(faces));
}

/// Nodes of [-1, 1]^3, `divisions` cells along each side, numbered along x, then y, then z.
struct CubeGrid {
  int divisions;

  Index node(int i, int j, int k) const {
    const int row = divisions + 1;
    return static_cast<Index>((k * row + j) * row + i);
  }
  Vec3 position(int i, int j, int k) const {
    return Vec3(i, j, k) * (2.0 / divisions) - Vec3::Ones();
  }
};

/// Inside the half-size cube the shells |x|_inf = const become spheres; outside they go back to
/// cubes.
inline Vec3 round_off(const Vec3& x) {
  const double cube = x.lpNorm<Eigen::Infinity>();
  if (cube == 0) return x;
  const double blend = cube <= 0.5 ? 1.0 : (1.0 - cube) / 0.5;
  return x * (1.0 + blend * (cube / x.norm() - 1.0));
}

/// Kuhn's six tetrahedra around the diagonal of a cell, so that neighbouring cells fit together.
inline void add_kuhn_tetrahedra(const CubeGrid& grid, std::array<int, 3> cell,
                                std::vector<Index>& cells) {
  constexpr std::array<std::array<std::size_t, 3>, 6> orders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (std::size_t o = 0; o < orders.size(); ++o) {
    std::array<int, 3> c = cell;
    std::array<Index, 4> t = {grid.node(c[0], c[1], c[2])};
    for (std::size_t s = 0; s < 3; ++s) {
      ++c[orders[o][s]];
      t[s + 1] = grid.node(c[0], c[1], c[2]);
    }
    if (o >= 3) std::swap(t[2], t[3]);  // odd permutations run the other way
    cells.insert(cells.end(), t.begin(), t.end());
  }
}

/// Two triangles for each square of the sides of the cube of cells [lo, hi)^3, outward.
inline std::vector<Index> cube_sides(const CubeGrid& grid, int lo, int hi) {
  std::vector<Index> faces;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int level : {lo, hi})
      for (int v = lo; v < hi; ++v)
        for (int u = lo; u < hi; ++u) {
          const auto corner = [&](int du, int dv) {
            std::array<int, 3> c{};
            c[axis] = level;
            c[(axis + 1) % 3] = u + du;
            c[(axis + 2) % 3] = v + dv;
            return grid.node(c[0], c[1], c[2]);
          };
          const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (level == hi)
            faces.insert(faces.end(), {a, b, c, a, c, d});
          else
            faces.insert(faces.end(), {a, c, b, a, d, c});
        }
  return faces;
}

/// Ball of radius 1/2 ("inside", volume 1) in the box [-1, 1]^3 ("outside", volume 2), of
/// tetrahedra; `divisions` cells along each side, a multiple of 4. The sphere between them is group
/// "surface" (1), the six sides of the box are group "outer" (2). Both oriented outward. Tetrahedra
/// at the edges of the former cube become flat as the divisions grow.
inline Mesh ball_in_box(int divisions) {
  const CubeGrid grid{divisions};
  const int lo = divisions / 4, hi = divisions - divisions / 4;
  Mesh mesh;
  std::vector<Index> inside, outside;
  for (int k = 0; k <= divisions; ++k)
    for (int j = 0; j <= divisions; ++j)
      for (int i = 0; i <= divisions; ++i) {
        mesh.nodes.push_back(round_off(grid.position(i, j, k)));
        if (std::max({i, j, k}) == divisions) continue;
        const bool is_inside = std::min({i, j, k}) >= lo && std::max({i, j, k}) < hi;
        add_kuhn_tetrahedra(grid, {i, j, k}, is_inside ? inside : outside);
      }
  Tag next = 1;
  const auto add = [&](ElementType type, Tag entity, std::vector<Index> nodes) {
    mesh.blocks.push_back(make_block(type, entity, {entity}, std::move(nodes), next));
    next += mesh.blocks.back().size();
  };
  add(triangle_type, 1, cube_sides(grid, lo, hi));
  add(triangle_type, 2, cube_sides(grid, 0, divisions));
  add(tetrahedron_type, 1, std::move(inside));
  add(tetrahedron_type, 2, std::move(outside));
  mesh.groups = {{2, 1, "surface"}, {2, 2, "outer"}, {3, 1, "inside"}, {3, 2, "outside"}};
  number_nodes(mesh);
  return mesh;
}

}  // namespace roughmesh::test
