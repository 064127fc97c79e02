// SPDX-License-Identifier: BSD-3-Clause
// Two triangles or segments: compared with intersections that exact rational numbers construct.
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <variant>

#include <CGAL/MP_Float.h>
#include <CGAL/Quotient.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include "facet_pair.hpp"

using namespace roughmesh;
using detail::PlacedFacet;

namespace {

using Exact = CGAL::Simple_cartesian<CGAL::Quotient<CGAL::MP_Float>>;

Exact::Point_3 exact(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Exact::Triangle_3 triangle(const PlacedFacet& f) {
  return {exact(f.x[0]), exact(f.x[1]), exact(f.x[2])};
}

std::size_t n_shared(const PlacedFacet& a, const PlacedFacet& b) {
  std::size_t n = 0;
  for (const Index i : std::set<Index>(a.points.begin(), a.points.end()))
    n += std::count(b.points.begin(), b.points.end(), i) > 0;
  return n;
}

// A whole number from 0 to n - 1.
int below(int n, std::mt19937& random) {
  return std::uniform_int_distribution<int>(0, n - 1)(random);
}

// What both have in common is a point, a segment or an area. Beyond one shared corner lies anything
// but a point, beyond a shared edge an area, unless the common place is none of what is shared.
bool expected(const PlacedFacet& a, const PlacedFacet& b) {
  const auto common = CGAL::intersection(triangle(a), triangle(b));
  if (!common) return false;
  const std::size_t shared = n_shared(a, b);
  if (shared == 0 || shared == 3) return true;
  const bool is_point = boost::get<Exact::Point_3>(&*common) != nullptr;
  const bool is_segment = boost::get<Exact::Segment_3>(&*common) != nullptr;
  return shared == 1 ? !is_point : !is_point && !is_segment;
}

// Corners 0 to 2, and those of the second after the ones it shares.
struct Pair {
  PlacedFacet a, b;
};

Pair pair_of(const std::array<Vec3, 6>& x, std::size_t n_shared) {
  Pair pair{{{0, 1, 2}, {x[0], x[1], x[2]}}, {{3, 4, 5}, {x[3], x[4], x[5]}}};
  for (std::size_t k = 0; k < n_shared; ++k) {
    pair.b.points[k] = pair.a.points[k];
    pair.b.x[k] = pair.a.x[k];
  }
  return pair;
}

void turn_corners(PlacedFacet& f, int times, bool mirror) {
  std::rotate(f.points.begin(), f.points.begin() + times, f.points.end());
  std::rotate(f.x.begin(), f.x.begin() + times, f.x.end());
  if (!mirror) return;
  std::swap(f.points[0], f.points[1]);
  std::swap(f.x[0], f.x[1]);
}

bool has_area(const PlacedFacet& f) { return !triangle(f).is_degenerate(); }

struct Counts {
  int n_pairs = 0, n_intersecting = 0;
};

template <class MakePlace>
Counts compare(std::size_t shared, int n, MakePlace&& make_place) {
  std::mt19937 random(7);
  Counts counts;
  for (int i = 0; i < n; ++i) {
    std::array<Vec3, 6> x;
    for (Vec3& place : x) place = make_place(random);
    Pair pair = pair_of(x, shared);
    if (!has_area(pair.a) || !has_area(pair.b)) continue;
    turn_corners(pair.a, below(3, random), below(2, random) == 0);
    turn_corners(pair.b, below(3, random), below(2, random) == 0);
    const bool intersect = detail::triangles_intersect(pair.a, pair.b);
    EXPECT_EQ(intersect, expected(pair.a, pair.b)) << "shared " << shared << ", pair " << i;
    EXPECT_EQ(intersect, detail::triangles_intersect(pair.b, pair.a));
    ++counts.n_pairs;
    counts.n_intersecting += intersect;
  }
  return counts;
}

Vec3 on_grid(std::mt19937& random, int n) {
  return Vec3(below(n, random), below(n, random), below(n, random));
}

PlacedFacet segment(Index i, const Vec3& p, Index j, const Vec3& q) {
  return {{i, j, j}, {p, q, q}};
}

}  // namespace

// Few places: corners on corners, on edges, inside, coplanar pairs, folded pairs.
TEST(FacetPair, TrianglesOnASmallGrid) {
  for (const std::size_t shared : {0U, 1U, 2U})
    for (const int n : {2, 3, 5}) {
      const Counts counts = compare(shared, 4000, [&](auto& r) { return on_grid(r, n); });
      EXPECT_GT(counts.n_pairs, 100);
      EXPECT_GT(counts.n_intersecting, 10);
      EXPECT_LT(counts.n_intersecting, counts.n_pairs);
    }
}

TEST(FacetPair, TrianglesOfOnePlane) {
  for (const std::size_t shared : {0U, 1U, 2U})
    for (const int axis : {0, 1, 2})
      compare(shared, 1500, [&](auto& r) {
        Vec3 x = on_grid(r, 4);
        x[axis] = 1;
        return x;
      });
}

// Tenths are no numbers of a double, so that planes, edges and corners are missed by round-off; far
// from the origin by more of it. Only exact signs get these right.
TEST(FacetPair, NearlyDegenerateTriangles) {
  for (const std::size_t shared : {0U, 1U, 2U})
    for (const double far : {0.0, 1000.0}) {
      const Vec3 u(0.8, 0.1, 0.3), v(-0.3, 0.7, 0.1);  // a plane that is askew
      const Counts counts = compare(shared, 1500, [&](auto& r) -> Vec3 {
        const double i = below(4, r), j = below(4, r);
        return Vec3(far, far, far) + 0.1 * i * u + 0.1 * j * v;
      });
      EXPECT_GT(counts.n_intersecting, 10);
      EXPECT_LT(counts.n_intersecting, counts.n_pairs);
    }
}

// Thin as a hair, and slivers a few units in the last place wide.
TEST(FacetPair, Slivers) {
  for (const std::size_t shared : {0U, 1U, 2U})
    for (const double width : {1e-6, 1e-12, 4e-16})
      compare(shared, 1000, [&](auto& r) -> Vec3 {
        const Vec3 x = on_grid(r, 3);
        return {1 + x.x() / 3, 1 + width * x.y(), 1 + width * x.z()};
      });
}

// Products of three coordinates leave the range of a double in both directions.
TEST(FacetPair, AnyScale) {
  for (const double scale : {1e-200, 1e-100, 1e100, 1e200})
    for (const std::size_t shared : {0U, 1U, 2U})
      compare(shared, 300, [&](auto& r) -> Vec3 { return scale * on_grid(r, 3); });
}

TEST(FacetPair, TouchingAtSharedCornersAndEdgesIsNone) {
  const std::array<Vec3, 6> x = {Vec3(0, 0, 0),  Vec3(1, 0, 0), Vec3(0, 1, 0),
                                 Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0.5, 0.5, 0)};
  const PlacedFacet a{{0, 1, 2}, {x[0], x[1], x[2]}};
  EXPECT_FALSE(detail::triangles_intersect(a, {{0, 3, 4}, {x[0], x[3], x[4]}}));
  EXPECT_FALSE(detail::triangles_intersect(a, {{1, 0, 3}, {x[1], x[0], x[3]}}));
  // The same places by other numbers touch.
  EXPECT_TRUE(detail::triangles_intersect(a, {{6, 3, 4}, {x[0], x[3], x[4]}}));
  EXPECT_TRUE(detail::triangles_intersect(a, {{7, 6, 3}, {x[1], x[0], x[3]}}));
  // Folded onto its neighbour; the same triangle.
  EXPECT_TRUE(detail::triangles_intersect(a, {{0, 1, 5}, {x[0], x[1], x[5]}}));
  EXPECT_TRUE(detail::triangles_intersect(a, {{2, 0, 1}, {x[2], x[0], x[1]}}));
}

// A triangle without area stands for its edges.
TEST(FacetPair, WithoutArea) {
  const PlacedFacet a{{0, 1, 2}, {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)}};
  const PlacedFacet needle{{3, 4, 5}, {Vec3(0.5, 0.5, -1), Vec3(0.5, 0.5, 1), Vec3(0.5, 0.5, 0)}};
  EXPECT_TRUE(detail::triangles_intersect(a, needle));
  EXPECT_TRUE(detail::triangles_intersect(needle, a));
  EXPECT_FALSE(detail::triangles_intersect(needle, {{6, 7, 8}, needle.x}));
  const PlacedFacet on_edge{{0, 1, 3}, {a.x[0], a.x[1], Vec3(1, 0, 0)}};
  EXPECT_FALSE(detail::triangles_intersect(a, on_edge));
}

// Of segments on a grid of integers all signs are exact in double as well: the oracle solves for
// the crossing with integers.
TEST(FacetPair, SegmentsOnASmallGrid) {
  std::mt19937 random(3);
  const auto cross = [](const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); };
  for (int i = 0; i < 20000; ++i) {
    std::array<Vec3, 4> x;
    for (Vec3& place : x) place = Vec3(below(4, random), below(4, random), 0.25);
    const bool share = random() % 2 == 0;
    if (share) x[2] = x[0];
    if (x[0] == x[1] || x[2] == x[3]) continue;
    const Vec3 d = x[1] - x[0], e = x[3] - x[2], f = x[2] - x[0];
    const double determinant = cross(d, e);
    bool expected = false;
    if (determinant != 0) {
      const double t = cross(f, e) / determinant, s = cross(f, d) / determinant;
      expected = !share && t >= 0 && t <= 1 && s >= 0 && s <= 1;
    } else if (cross(d, f) == 0) {
      const double low = d.dot(f) / d.dot(d), high = low + d.dot(e) / d.dot(d);
      const auto [first, last] = std::minmax(low, high);
      expected = share ? last > 0 && first < 1 : last >= 0 && first <= 1;
    }
    const PlacedFacet a = segment(0, x[0], 1, x[1]), b = segment(share ? 0 : 2, x[2], 3, x[3]);
    ASSERT_EQ(detail::segments_intersect(a, b, 2), expected) << i;
    ASSERT_EQ(detail::segments_intersect(b, a, 2), expected) << i;
  }
}

TEST(FacetPair, SegmentsOfOnePlaceOrNoLength) {
  const Vec3 p(0, 0, 0), q(1, 0, 0), middle(0.5, 0, 0);
  EXPECT_TRUE(detail::segments_intersect(segment(0, p, 1, q), segment(1, q, 0, p), 2));
  EXPECT_FALSE(detail::segments_intersect(segment(0, p, 1, q), segment(2, middle, 3, middle), 2));
}
