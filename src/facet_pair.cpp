// SPDX-License-Identifier: BSD-3-Clause
#include "facet_pair.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "exact_predicates.hpp"

namespace roughmesh::detail {
namespace {

using Triangle = std::array<Vec3, 3>;

// ---- What round-off cannot spoil: most pairs are settled here ----

// Is along . x > 0 for certain? x is a difference of coordinates, rounded once, so that the error
// is below four units in the last place of the sum of the moduli; underflow adds a few denormals.
bool surely_positive(const Vec3& along, const Vec3& x) {
  constexpr double round_off = 1e-14;
  return along.dot(x) >
         round_off * along.cwiseAbs().dot(x.cwiseAbs()) + std::numeric_limits<double>::min();
}

// Do a plane through the corner that both share, and the rest of either on its own side, part them?
bool surely_parted_at(const Vec3& corner, const Vec3& a1, const Vec3& a2, const Vec3& b1,
                      const Vec3& b2) {
  const Vec3 a1_from = a1 - corner, a2_from = a2 - corner, b1_from = b1 - corner,
             b2_from = b2 - corner;
  const Vec3 along = (a1_from + a2_from) - (b1_from + b2_from);
  return surely_positive(along, a1_from) && surely_positive(along, a2_from) &&
         surely_positive(-along, b1_from) && surely_positive(-along, b2_from);
}

// Does a plane across the line between their middles part them? Every corner of one against every
// one of the other.
bool surely_parted(const Triangle& a, const Triangle& b) {
  const Vec3 along = (a[0] - b[0]) + (a[1] - b[1]) + (a[2] - b[2]);
  for (const Vec3& p : a)
    for (const Vec3& q : b)
      if (!surely_positive(along, p - q)) return false;
  return true;
}

// ---- In a plane, seen along an axis ----

// An axis along which the triangle has an area.
std::optional<int> axis_of_view(const Triangle& t) {
  for (const int axis : {0, 1, 2})
    if (turn(t[0], t[1], t[2], axis) != 0) return axis;
  return std::nullopt;
}

// Is r, on the line of p and q as they are seen, between them?
bool is_between(const Vec3& p, const Vec3& q, const Vec3& r, int axis) {
  for (const int i : {(axis + 1) % 3, (axis + 2) % 3})
    if (r[i] < std::min(p[i], q[i]) || r[i] > std::max(p[i], q[i])) return false;
  return true;
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, int axis) {
  const int of_r = turn(p, q, r, axis), of_s = turn(p, q, s, axis);
  const int of_p = turn(r, s, p, axis), of_q = turn(r, s, q, axis);
  if (of_r * of_s < 0 && of_p * of_q < 0) return true;
  return (of_r == 0 && is_between(p, q, r, axis)) || (of_s == 0 && is_between(p, q, s, axis)) ||
         (of_p == 0 && is_between(r, s, p, axis)) || (of_q == 0 && is_between(r, s, q, axis));
}

bool contains(const Triangle& t, const Vec3& p, int axis) {
  const int first = turn(t[0], t[1], p, axis), second = turn(t[1], t[2], p, axis),
            third = turn(t[2], t[0], p, axis);
  return std::min({first, second, third}) * std::max({first, second, third}) >= 0;
}

bool meets_in_plane(const Vec3& p, const Vec3& q, const Triangle& t) {
  const std::optional<int> axis = axis_of_view(t);
  if (!axis) return false;
  return contains(t, p, *axis) || contains(t, q, *axis) || segments_meet(p, q, t[0], t[1], *axis) ||
         segments_meet(p, q, t[1], t[2], *axis) || segments_meet(p, q, t[2], t[0], *axis);
}

// ---- In space ----

struct Sides {
  std::array<int, 3> of;

  bool all_equal() const { return of[0] == of[1] && of[1] == of[2]; }
  bool none_across() const {  // strictly on one side
    return all_equal() && of[0] != 0;
  }
};

Sides sides_of(const Triangle& plane, const Triangle& t) {
  const auto side = [&](const Vec3& x) { return side_of_plane(plane[0], plane[1], plane[2], x); };
  return {{side(t[0]), side(t[1]), side(t[2])}};
}

// Closed segment and closed triangle; side_p and side_q are those of its plane.
bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t, int side_p, int side_q) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return meets_in_plane(p, q, t);
  const int first = side_of_plane(p, q, t[0], t[1]), second = side_of_plane(p, q, t[1], t[2]);
  if (first * second < 0) return false;
  const int third = side_of_plane(p, q, t[2], t[0]);
  return first * third >= 0 && second * third >= 0;
}

bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) {
  const auto side = [&](const Vec3& x) { return side_of_plane(t[0], t[1], t[2], x); };
  return segment_meets(p, q, t, side(p), side(q));
}

bool an_edge_meets(const Triangle& of, const Triangle& t, const Sides& sides) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segment_meets(of[k], of[(k + 1) % 3], t, sides.of[k], sides.of[(k + 1) % 3])) return true;
  return false;
}

bool strangers_intersect(const Triangle& a, const Triangle& b) {
  if (surely_parted(a, b)) return false;
  const Sides a_of_b = sides_of(b, a);
  if (a_of_b.none_across()) return false;
  const Sides b_of_a = sides_of(a, b);
  if (b_of_a.none_across()) return false;
  return an_edge_meets(a, b, a_of_b) || an_edge_meets(b, a, b_of_a);
}

// Both with the shared corner first.
bool neighbours_at_corner_intersect(const Triangle& a, const Triangle& b) {
  if (surely_parted_at(a[0], a[1], a[2], b[1], b[2])) return false;
  return segment_meets(a[1], a[2], b) || segment_meets(b[1], b[2], a);
}

// Both with the shared edge first.
bool neighbours_at_edge_intersect(const Triangle& a, const Triangle& b) {
  if (side_of_plane(a[0], a[1], a[2], b[2]) != 0) return false;
  const std::optional<int> axis = axis_of_view(a);
  return axis && turn(a[0], a[1], a[2], *axis) == turn(a[0], a[1], b[2], *axis);
}

// Brings the shared corners to the front, in one order; returns their number.
std::size_t align(PlacedFacet& a, PlacedFacet& b, std::size_t n_corners) {
  std::size_t n_shared = 0;
  for (std::size_t i = 0; i < n_corners; ++i)
    for (std::size_t j = n_shared; j < n_corners; ++j) {
      if (a.points[i] != b.points[j]) continue;
      std::swap(a.points[i], a.points[n_shared]);
      std::swap(a.x[i], a.x[n_shared]);
      std::swap(b.points[j], b.points[n_shared]);
      std::swap(b.x[j], b.x[n_shared]);
      ++n_shared;
      break;
    }
  return n_shared;
}

bool has_shared_corner(const PlacedFacet& a, const PlacedFacet& b) {
  return std::any_of(a.points.begin(), a.points.end(), [&](Index point) {
    return point == b.points[0] || point == b.points[1] || point == b.points[2];
  });
}

}  // namespace

bool triangles_intersect(const PlacedFacet& a, const PlacedFacet& b) {
  if (!has_shared_corner(a, b)) return strangers_intersect(a.x, b.x);
  PlacedFacet first = a, second = b;
  switch (align(first, second, 3)) {
    case 1:
      return neighbours_at_corner_intersect(first.x, second.x);
    case 2:
      return neighbours_at_edge_intersect(first.x, second.x);
    default:
      return true;
  }
}

bool segments_intersect(const PlacedFacet& a, const PlacedFacet& b, int axis) {
  PlacedFacet first = a, second = b;
  const std::size_t n_shared = align(first, second, 2);
  const Vec3 &p = first.x[0], &q = first.x[1], &r = second.x[0], &s = second.x[1];
  if (p == q || r == s) return false;
  if (n_shared == 0) return segments_meet(p, q, r, s, axis);
  if (n_shared == 2) return true;
  return turn(p, q, s, axis) == 0 && (is_between(p, q, s, axis) || is_between(p, s, q, axis));
}

}  // namespace roughmesh::detail
