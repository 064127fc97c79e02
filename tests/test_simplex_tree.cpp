// SPDX-License-Identifier: BSD-3-Clause
// Exact distances to points, segments and triangles, one by one and to the nearest of many.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "simplex_tree.hpp"

using namespace roughmesh;
using detail::PlacedSimplex;
using detail::SimplexTree;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  Vec3 in_cube() { return {uniform(), uniform(), uniform()}; }
  Vec3 direction() { return (in_cube() - Vec3(0.5, 0.5, 0.5)).normalized(); }
  std::vector<Vec3> vertices(int n) {
    std::vector<Vec3> x;
    for (int k = 0; k < n; ++k) x.push_back(in_cube());
    return x;
  }
  PlacedSimplex simplex() {
    const int n = 1 + static_cast<int>(3 * uniform());
    std::vector<Vec3> x = vertices(n);
    for (int k = 1; k < n; ++k) x[k] = x[0] + 0.2 * (x[k] - x[0]);
    return PlacedSimplex(x);
  }
  std::vector<PlacedSimplex> simplices(int n) {
    std::vector<PlacedSimplex> all;
    for (int k = 0; k < n; ++k) all.push_back(simplex());
    return all;
  }

 private:
  std::mt19937_64 engine_;
};

double distance(const std::vector<Vec3>& vertices, const Vec3& x) {
  return std::sqrt(detail::squared_distance(PlacedSimplex(vertices), x));
}

// Round-off of coordinates of size 1, and of a normal that a thin triangle makes worse.
constexpr double exact = 1e-11;

double thickness(const std::vector<Vec3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm(); }

}  // namespace

// From q on a convex body, x = q + s v has the distance s if v makes no acute angle with any
// direction into the body: the three cases are the inside, a side and a corner of a triangle.
TEST(SimplexTree, DistanceToATriangleIsTheOffsetAlongItsNormalCone) {
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const std::vector<Vec3> t = random.vertices(3);
    if (thickness(t) < 0.02) continue;
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    const double s = 2 * random.uniform(), u = random.uniform(), v = random.uniform();
    const Vec3 inside = t[0] + (1 - u) * (t[1] - t[0]) + u * v * (t[2] - t[0]);
    EXPECT_NEAR(distance(t, inside + s * n), s, exact);
    EXPECT_NEAR(distance(t, inside - s * n), s, exact);

    const Vec3 side = t[0] + u * (t[1] - t[0]);
    const Vec3 outward = (t[1] - t[0]).cross(n).normalized();
    EXPECT_NEAR(distance(t, side + s * (v * outward + (1 - v) * n).normalized()), s, exact);

    const Vec3 away = random.direction();
    if (away.dot(t[1] - t[0]) > 0 || away.dot(t[2] - t[0]) > 0) continue;
    EXPECT_NEAR(distance(t, t[0] + s * away), s, exact);
  }
}

TEST(SimplexTree, DistanceToASegmentIsTheOffsetAlongItsNormalCone) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const std::vector<Vec3> ends = random.vertices(2);
    const Vec3 along = (ends[1] - ends[0]).normalized();
    const Vec3 across = along.cross(random.direction()).normalized();
    const double s = random.uniform(), u = random.uniform();
    EXPECT_NEAR(distance(ends, ends[0] + u * (ends[1] - ends[0]) + s * across), s, exact);
    EXPECT_NEAR(distance(ends, ends[1] + s * (u * along + (1 - u) * across).normalized()), s,
                exact);
  }
}

TEST(SimplexTree, VerticesAreAtDistanceZeroExactly) {
  Random random(3);
  for (int k = 0; k < 1000; ++k)
    for (const int n : {1, 2, 3}) {
      const std::vector<Vec3> x = random.vertices(n);
      for (const Vec3& vertex : x) EXPECT_EQ(distance(x, vertex), 0);
    }
}

TEST(SimplexTree, ATriangleWithoutAreaIsItsSegments) {
  const Vec3 a(0.1, 0.2, 0.3), b(0.7, 0.1, 0.5), x(0.2, 0.9, 0.4);
  EXPECT_EQ(distance({a, b, b}, x), distance({a, b}, x));
  EXPECT_EQ(distance({a, a, a}, x), (x - a).norm());
  EXPECT_NEAR(distance({a, (a + b) / 2, b}, x), distance({a, b}, x), exact);
}

// Not close: the same bits, since a tree only leaves out what cannot be nearest.
TEST(SimplexTree, NearestOfManyIsTheSmallestDistance) {
  Random random(4);
  for (const int n : {1, 4, 5, 100, 1000}) {
    const std::vector<PlacedSimplex> all = random.simplices(n);
    const SimplexTree tree(all);
    for (int k = 0; k < 300; ++k) {
      const Vec3 x = 2 * random.in_cube() - Vec3(0.5, 0.5, 0.5);
      double smallest = infinity;
      for (const PlacedSimplex& s : all)
        smallest = std::min(smallest, detail::squared_distance(s, x));
      EXPECT_EQ(tree.distance_within(x, 10), std::sqrt(smallest)) << n << " simplices";
    }
  }
}

TEST(SimplexTree, BeyondTheLimitThereIsNothing) {
  const SimplexTree tree({PlacedSimplex(std::vector<Vec3>{{0, 0, 0}})});
  EXPECT_EQ(tree.distance_within({0, 3, 4}, 5), 5);
  EXPECT_EQ(tree.distance_within({0, 3, 4}, 4.999), infinity);
  EXPECT_EQ(tree.distance_within({0, 0, 0}, 1e-300), 0);
  EXPECT_EQ(tree.distance_within({0, 0, 1e-3}, 1e-300), infinity);
  EXPECT_EQ(SimplexTree({}).distance_within({0, 0, 0}, 1), infinity);
}

TEST(SimplexTree, OrderAndRepetitionChangeNoBit) {
  Random random(5);
  const std::vector<PlacedSimplex> all = random.simplices(500);
  std::vector<PlacedSimplex> other;
  for (const PlacedSimplex& s : all) {
    std::vector<Vec3> turned(s.vertices.begin(), s.vertices.begin() + s.n_vertices);
    std::reverse(turned.begin(), turned.end());
    other.insert(other.begin() + static_cast<std::ptrdiff_t>(other.size() / 3),
                 PlacedSimplex(turned));
    if (other.size() % 7 == 0) other.push_back(s);
  }
  const SimplexTree tree(all), reordered(other);
  for (int k = 0; k < 500; ++k) {
    const Vec3 x = random.in_cube();
    EXPECT_EQ(tree.distance_within(x, 1), reordered.distance_within(x, 1));
  }
}

// One place for all boxes: splitting must go on by number, not by position.
TEST(SimplexTree, ManySimplicesInOnePlaceAreSplitAllTheSame) {
  Random random(6);
  std::vector<PlacedSimplex> star;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 arm = random.direction();
    star.emplace_back(std::vector<Vec3>{arm, -arm});
  }
  const SimplexTree tree(std::move(star));
  EXPECT_LT(tree.distance_within({0, 0, 1e-3}, 1), 1e-3);
  EXPECT_NEAR(tree.distance_within({0, 0, 3}, 3), 2, 1e-2);
}
