// SPDX-License-Identifier: BSD-3-Clause
#include "opposite_sheet.hpp"

#include <algorithm>
#include <cmath>

namespace roughmesh::detail {
namespace {

constexpr double least_cosine = 0.5;  // of the angle between ray and normal
constexpr double slack = 1e-9;        // so that no ray slips through between two facets
constexpr int most_facets = 10'000;   // of one ray; where more lie upon each other, these will do

struct Ray {
  Vec3 from, direction;
};

bool is_across(const Vec3& normal, const Vec3& direction) {
  return std::abs(normal.dot(direction)) >= least_cosine * normal.norm() && normal.norm() > 0;
}

// T. Moller and B. Trumbore (1997), doi:10.1080/10867651.1997.10487468.
std::optional<SheetHit> hit_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, to_ray = ray.from - a;
  if (!is_across(ab.cross(ac), ray.direction)) return std::nullopt;
  const Vec3 p = ray.direction.cross(ac), q = to_ray.cross(ab);
  const double determinant = ab.dot(p);
  const double u = to_ray.dot(p) / determinant, v = ray.direction.dot(q) / determinant;
  if (!(u >= -slack && v >= -slack && u + v <= 1 + slack)) return std::nullopt;
  return SheetHit{ac.dot(q) / determinant, 0, {1 - u - v, u, v}};
}

std::optional<SheetHit> hit_segment(const Ray& ray, const Vec3& a, const Vec3& b,
                                    const Vec3& plane_normal) {
  const Vec3 ab = b - a, to_a = a - ray.from;
  if (!is_across(ab.cross(plane_normal), ray.direction)) return std::nullopt;
  const double determinant = ray.direction.cross(ab).dot(plane_normal);
  const double u = to_a.cross(ray.direction).dot(plane_normal) / determinant;
  if (!(u >= -slack && u <= 1 + slack)) return std::nullopt;
  return SheetHit{to_a.cross(ab).dot(plane_normal) / determinant, 0, {1 - u, u, 0}};
}

}  // namespace

std::optional<SheetHit> opposite_sheet(const CheckedFaces& faces, const TriangleTree& tree,
                                       Index point, const Vec3& direction, double reach,
                                       const Vec3& plane_normal) {
  const Ray ray{faces.before[point], direction};
  std::optional<SheetHit> nearest;
  int n_facets = 0;
  tree.for_each_along(ray.from, direction, reach, [&](std::size_t f, double within) {
    if (++n_facets > most_facets) return -1.0;
    const auto [a, b, c] = faces.facets[f];
    const Index self = faces.joined[point];
    if (faces.joined[a] == self || faces.joined[b] == self || faces.joined[c] == self)
      return within;
    const auto& x = faces.before;
    auto hit = faces.dimension == 1 ? hit_segment(ray, x[a], x[b], plane_normal)
                                    : hit_triangle(ray, x[a], x[b], x[c]);
    const double touching = slack * (x[a] - x[b]).norm();
    if (!hit || !(hit->distance > touching) || hit->distance > within) return within;
    if (nearest && hit->distance == nearest->distance && nearest->facet < f) return within;
    hit->facet = f;
    nearest = hit;
    return hit->distance;
  });
  return nearest;
}

}  // namespace roughmesh::detail
