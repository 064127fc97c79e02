// SPDX-License-Identifier: BSD-3-Clause
// Points of a field and realizations of its noise, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::test {

/// Sorted by coordinates, as a field expects its points.
inline std::vector<Vec3> sorted(std::vector<Vec3> points) {
  std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
    return std::tie(a[0], a[1], a[2]) < std::tie(b[0], b[1], b[2]);
  });
  return points;
}

/// Mean distance of neighbours of n points spread evenly on a sphere: edge of the equilateral
/// triangles that 2n of cover its area.
inline double mesh_size_of_sphere(std::size_t n, double radius) {
  const double triangle_area =
      4 * std::numbers::pi * radius * radius / (2.0 * static_cast<double>(n));
  return std::sqrt(4 * triangle_area / std::numbers::sqrt3);
}

/// Infinite where the sizes differ or a difference is no number.
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  if (a.size() != b.size()) return inf;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(a[i] - b[i]);
    largest = std::max(largest, std::isnan(difference) ? inf : difference);
  }
  return largest;
}

}  // namespace roughmesh::test
