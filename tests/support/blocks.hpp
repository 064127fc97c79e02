// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces with sharp edges.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"
#include "planar.hpp"

namespace roughmesh::test {

/// Boundary of the cells of an n^3 grid in [0, 1]^3 that are in the body, two triangles for each
/// square, outward; each of the six directions is a group, named by axis and sign.
inline Mesh block(int n, const std::function<bool(int, int, int)>& is_body) {
  Mesh mesh;
  std::map<std::array<int, 3>, Index> numbers;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = numbers.try_emplace(at, mesh.n_nodes());
    if (is_new) mesh.nodes.push_back(Vec3(at[0], at[1], at[2]) / n);
    return found->second;
  };
  const auto has = [&](const std::array<int, 3>& c) {
    return *std::min_element(c.begin(), c.end()) >= 0 &&
           *std::max_element(c.begin(), c.end()) < n && is_body(c[0], c[1], c[2]);
  };
  std::array<std::vector<Index>, 6> sides;
  for (int cell = 0; cell < n * n * n; ++cell)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int sign : {0, 1}) {
        const std::array<int, 3> c = {cell % n, cell / n % n, cell / n / n};
        std::array<int, 3> beside = c;
        beside[axis] += 2 * sign - 1;
        if (!has(c) || has(beside)) continue;
        const auto corner = [&](int du, int dv) {
          std::array<int, 3> at = c;
          at[axis] += sign;
          at[(axis + 1) % 3] += du;
          at[(axis + 2) % 3] += dv;
          return node(at);
        };
        const Index p = corner(0, 0), q = corner(1, 0), r = corner(1, 1), s = corner(0, 1);
        auto& side = sides[2 * axis + static_cast<std::size_t>(sign)];
        if (sign == 1)
          side.insert(side.end(), {p, q, r, p, r, s});
        else
          side.insert(side.end(), {p, r, q, p, s, r});
      }
  Tag first = 1;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto entity = static_cast<Tag>(k + 1);
    mesh.blocks.push_back(make_block(triangle_type, entity, {entity}, sides[k], first));
    first += mesh.blocks.back().size();
    mesh.groups.push_back({2, entity, std::string(1, "xyz"[k / 2]) + (k % 2 == 1 ? "+" : "-")});
  }
  number_nodes(mesh);
  return mesh;
}

inline Mesh cube(int n) {
  return block(n, [](int, int, int) { return true; });
}

/// With an edge that is concave.
inline Mesh l_block(int n) {
  return block(n, [n](int i, int j, int) { return i < n / 2 || j < n / 2; });
}

inline Mesh mapped(Mesh mesh, const Eigen::Matrix3d& map) {
  for (Vec3& x : mesh.nodes) x = map * x;
  return mesh;
}

/// A cube whose side leans until an edge has this angle, its neighbour 180 degrees minus that.
inline Mesh leaning(int n, double angle) {
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(0, 1) = std::cos(angle) / std::sin(angle);
  return mapped(cube(n), map);
}

/// Closed cylinder about z, of radius 1 and height 1: n by m squares around and up, whose diagonals
/// alternate without a rule, and two fans.
inline Mesh cylinder(int n, int m) {
  std::vector<Vec3> nodes = {{0, 0, 0}, {0, 0, 1}};
  std::vector<Index> faces;
  for (int j = 0; j <= m; ++j)
    for (const Vec3& x : circle_points(uneven_angles(n), 1))
      nodes.emplace_back(x.x(), x.y(), static_cast<double>(j) / m);
  const auto node = [&](int i, int j) { return static_cast<Index>(2 + j * n + i % n); };
  for (int i = 0; i < n; ++i) {
    faces.insert(faces.end(), {0, node(i + 1, 0), node(i, 0), 1, node(i, m), node(i + 1, m)});
    for (int j = 0; j < m; ++j) {
      const Index p = node(i, j), q = node(i + 1, j), r = node(i + 1, j + 1), s = node(i, j + 1);
      if ((i * i + j) % 3 == 0)
        faces.insert(faces.end(), {p, q, r, p, r, s});
      else
        faces.insert(faces.end(), {p, q, s, q, r, s});
    }
  }
  return surface_mesh(std::move(nodes), std::move(faces));
}

}  // namespace roughmesh::test
