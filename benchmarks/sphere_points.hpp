// SPDX-License-Identifier: BSD-3-Clause
// The points of the comparisons: a unit sphere, evenly covered, any number of points.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::bench {

/// Fibonacci's spiral around the x axis, by ascending x: that is the canonical order of points.
inline std::vector<Vec3> sphere_points(Index n) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    const double x = (2.0 * i + 1) / n - 1, angle = golden_angle * i;
    const double radius = std::sqrt((1 - x) * (1 + x));
    points.emplace_back(x, radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

/// Mean spacing h: each point has h^2 of the sphere.
inline double sphere_spacing(Index n) { return std::sqrt(4 * std::numbers::pi / n); }

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace roughmesh::bench
