// SPDX-License-Identifier: BSD-3-Clause
// The only source that sees CGAL: its kernel, under the LGPL. Nearly all signs are settled by
// bounds on round-off, the rest by exact arithmetic.
#include "exact_predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace roughmesh::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Kernel::Point_2 seen_along(const Vec3& x, int axis) {
  return {x[(axis + 1) % 3], x[(axis + 2) % 3]};
}

}  // namespace

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return CGAL::orientation(point(a), point(b), point(c), point(d));
}

int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  return CGAL::orientation(seen_along(a, axis), seen_along(b, axis), seen_along(c, axis));
}

}  // namespace roughmesh::detail
