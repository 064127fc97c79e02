// SPDX-License-Identifier: BSD-3-Clause
// Geometry of one face of three or four corners.
#pragma once

#include <array>
#include <span>

#include "roughmesh/surface.hpp"

namespace roughmesh::detail {

/// Corner positions of a face, without allocation.
struct Corners {
  std::array<Vec3, 4> positions;
  std::size_t n = 0;

  std::span<const Vec3> span() const { return {positions.data(), n}; }
};

inline Corners gather(std::span<const Index> face, std::span<const Vec3> positions) {
  Corners corners;
  for (const Index point : face) corners.positions[corners.n++] = positions[point];
  return corners;
}

/// Area of a triangle; of a quadrangle, mean over its two splittings into triangles.
double polygon_area(std::span<const Vec3> corners);

/// Signed volume of the cone from the apex, positive if the face looks away from it; of a
/// quadrangle, mean over its two splittings.
double cone_volume(std::span<const Vec3> corners, const Vec3& apex);

}  // namespace roughmesh::detail
