// SPDX-License-Identifier: BSD-3-Clause
// Geometry of one face: a polygon of three or four corners, or a line in a plane.
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

/// Direction in which a face looks, as long as its area: area_vector of a polygon; of a line with
/// two corners, its normal in the plane, to the right of the line as seen from the tip of
/// `plane_normal` (docs/math.md, eq. 35), as long as the line.
Vec3 face_vector(std::span<const Vec3> corners, const Vec3& plane_normal);

/// Area of a triangle; of a quadrangle, mean over its two splittings into triangles; length of a
/// line.
double face_area(std::span<const Vec3> corners);

/// Signed volume of the cone from the apex, positive if the face looks away from it; of a
/// quadrangle, mean over its two splittings; of a line, area of the triangle in the plane.
double cone_volume(std::span<const Vec3> corners, const Vec3& apex, const Vec3& plane_normal);

}  // namespace roughmesh::detail
