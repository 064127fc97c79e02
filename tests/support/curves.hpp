// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of dimension 1 that tests make themselves.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh::test {

/// Lines between points as a surface; areas are half the lengths at each point.
inline Surface curve_of(std::vector<Vec3> points,
                        const std::vector<std::pair<Index, Index>>& lines) {
  Surface surface;
  surface.dimension = 1;
  surface.points = std::move(points);
  surface.areas.assign(surface.points.size(), 0);
  surface.face_offsets = {0};
  for (const auto& [a, b] : lines) {
    surface.face_points.insert(surface.face_points.end(), {a, b});
    surface.face_offsets.push_back(static_cast<Index>(surface.face_points.size()));
    surface.face_tags.push_back(surface.n_faces() + 1);
    const double length = (surface.points[b] - surface.points[a]).norm();
    surface.areas[a] += length / 2;
    surface.areas[b] += length / 2;
    surface.area += length;
  }
  return surface;
}

/// Regular polygon of n corners, its points sorted by coordinates.
inline Surface circle(int n, double radius) {
  std::vector<Vec3> corners;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.25) / n;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  std::vector<Index> order(corners.size()), place(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    return std::lexicographical_compare(corners[i].begin(), corners[i].end(), corners[j].begin(),
                                        corners[j].end());
  });
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = static_cast<Index>(i);
    points.push_back(corners[order[i]]);
  }
  std::vector<std::pair<Index, Index>> lines;
  for (int i = 0; i < n; ++i) lines.emplace_back(place[i], place[(i + 1) % n]);
  return curve_of(std::move(points), lines);
}

}  // namespace roughmesh::test
