// SPDX-License-Identifier: BSD-3-Clause
// Curves and planar domains.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"

namespace roughmesh::test {

/// Lines from each point to the next, and from the last to the first if closed; group "line" (1).
inline Mesh polyline(std::vector<Vec3> points, bool closed) {
  Mesh mesh;
  std::vector<Index> lines;
  const auto n = static_cast<Index>(points.size());
  for (Index i = 0; i + 1 < n; ++i) lines.insert(lines.end(), {i, i + 1});
  if (closed) lines.insert(lines.end(), {n - 1, 0});
  mesh.nodes = std::move(points);
  mesh.blocks = {make_block(line_type, 1, {1}, std::move(lines), 1)};
  mesh.groups = {{1, 1, "line"}};
  number_nodes(mesh);
  return mesh;
}

/// n angles around the circle, neighbours up to four times as far apart as others.
inline std::vector<double> uneven_angles(int n) {
  std::vector<double> angles;
  for (int i = 0; i < n; ++i) {
    const double turn = 2 * std::numbers::pi * i / n;
    angles.push_back(turn + 0.55 * std::sin(turn + 1) + 0.1 * std::cos(3 * turn));
  }
  return angles;
}

inline std::vector<Vec3> circle_points(const std::vector<double>& angles, double radius) {
  std::vector<Vec3> points;
  for (const double angle : angles)
    points.push_back(radius * Vec3(std::cos(angle), std::sin(angle), 0));
  return points;
}

/// Ring between the circles of radius 1/4 and 1 in the plane z = 0, `n` elements around and n/4
/// along the radius (n divisible by 8); within radius 5/8 it is the face 1 ("core"), outside the
/// face 2 ("shell"). Lines: "hole" (1), "interface" (2), "rim" (3), all counter-clockwise.
inline Mesh ring(int n, bool quadrangles = false) {
  const int n_rings = n / 4;
  Mesh mesh;
  for (int j = 0; j <= n_rings; ++j)
    for (const Vec3& x : circle_points(uneven_angles(n), 0.25 + 0.75 * j / n_rings))
      mesh.nodes.push_back(x);
  std::array<std::vector<Index>, 2> cells;
  for (int j = 0; j < n_rings; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * n + i, b = j * n + (i + 1) % n, c = b + n, d = a + n;
      auto& out = cells[2 * j < n_rings ? 0 : 1];
      if (quadrangles)
        out.insert(out.end(), {a, d, c, b});
      else
        out.insert(out.end(), {a, d, c, a, c, b});
    }
  Tag tag = 0;
  for (const int j : {0, n_rings / 2, n_rings}) {
    std::vector<Index> lines;
    for (int i = 0; i < n; ++i) lines.insert(lines.end(), {j * n + i, j * n + (i + 1) % n});
    ++tag;
    mesh.blocks.push_back(make_block(line_type, tag, {tag}, std::move(lines), 1000 * tag));
  }
  const ElementType type =
      quadrangles ? ElementType{ElementShape::quadrangle, 1, 4} : triangle_type;
  mesh.blocks.push_back(make_block(type, 1, {1}, cells[0], 10'001));
  mesh.blocks.push_back(make_block(type, 2, {2}, cells[1], 20'001));
  mesh.groups = {
      {1, 1, "hole"}, {1, 2, "interface"}, {1, 3, "rim"}, {2, 1, "core"}, {2, 2, "shell"}};
  number_nodes(mesh);
  return mesh;
}

/// Rectangle [0, length] x [-1, 1] in n_x by n_y quadrangles, face group "line" (1). Lines: "lower"
/// (1), "upper" (2), "ends" (3: left and right). The left side is the periodic master of the right.
/// `stretch` makes the spacing along x uneven, by up to this share of it.
inline Mesh strip(int n_x, int n_y, double length, double stretch = 0) {
  Mesh mesh;
  const auto node = [&](int i, int j) { return static_cast<Index>(j * (n_x + 1) + i); };
  for (int j = 0; j <= n_y; ++j)
    for (int i = 0; i <= n_x; ++i) {
      const double t = static_cast<double>(i) / n_x;
      const double x = t + stretch / (2 * std::numbers::pi) * std::sin(2 * std::numbers::pi * t);
      mesh.nodes.emplace_back(i == n_x ? length : length * x, -1 + 2.0 * j / n_y, 0);
    }
  std::vector<Index> faces, lower, upper, ends;
  for (int i = 0; i < n_x; ++i) {
    for (int j = 0; j < n_y; ++j)
      faces.insert(faces.end(), {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
    lower.insert(lower.end(), {node(i, 0), node(i + 1, 0)});
    upper.insert(upper.end(), {node(i, n_y), node(i + 1, n_y)});
  }
  PeriodicLink link{1, 4, 3, {}, {}};
  for (int j = 0; j <= n_y; ++j) link.nodes.emplace_back(node(n_x, j), node(0, j));
  for (int j = 0; j < n_y; ++j)
    ends.insert(ends.end(), {node(0, j), node(0, j + 1), node(n_x, j), node(n_x, j + 1)});
  mesh.blocks = {make_block(line_type, 1, {1}, lower, 1),
                 make_block(line_type, 2, {2}, upper, 1001),
                 make_block(line_type, 3, {3}, ends, 2001),
                 make_block({ElementShape::quadrangle, 1, 4}, 1, {1}, faces, 3001)};
  mesh.groups = {{1, 1, "lower"}, {1, 2, "upper"}, {1, 3, "ends"}, {2, 1, "line"}};
  mesh.periodic_links = {link};
  number_nodes(mesh);
  return mesh;
}

}  // namespace roughmesh::test
