// SPDX-License-Identifier: BSD-3-Clause
#include "polygon.hpp"

namespace roughmesh {
namespace detail {
namespace {

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).norm() / 2;
}

double tetrahedron_volume(const Vec3& apex, const Vec3& a, const Vec3& b, const Vec3& c) {
  return (a - apex).cross(b - apex).dot(c - apex) / 6;
}

// Applies `measure` to the triangles of a face: once to a triangle, averaged over both splittings
// of a quadrangle, so that no diagonal is preferred.
template <class Measure>
double over_triangles(std::span<const Vec3> p, Measure&& measure) {
  if (p.size() == 3) return measure(p[0], p[1], p[2]);
  return ((measure(p[0], p[1], p[2]) + measure(p[0], p[2], p[3])) +
          (measure(p[0], p[1], p[3]) + measure(p[1], p[2], p[3]))) /
         2;
}

}  // namespace

Vec3 face_vector(std::span<const Vec3> corners, const Vec3& plane_normal) {
  if (corners.size() == 2) return (corners[1] - corners[0]).cross(plane_normal);
  return area_vector(corners);
}

double face_area(std::span<const Vec3> corners) {
  if (corners.size() == 2) return (corners[1] - corners[0]).norm();
  return over_triangles(corners, triangle_area);
}

double cone_volume(std::span<const Vec3> corners, const Vec3& apex, const Vec3& plane_normal) {
  if (corners.size() == 2)
    return (corners[0] - apex).cross(corners[1] - apex).dot(plane_normal) / 2;
  return over_triangles(corners, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return tetrahedron_volume(apex, a, b, c);
  });
}

}  // namespace detail

Vec3 area_vector(std::span<const Vec3> corners) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
  return sum / 2;
}

}  // namespace roughmesh
