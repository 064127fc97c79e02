// SPDX-License-Identifier: BSD-3-Clause
// Points seen from one of them: each counts once, and far cells are small for their distance.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "point_tree.hpp"
#include "support/meshes.hpp"

namespace roughmesh::detail {
namespace {

// A plate whose squares grow along x, and a small dense one above its corner.
std::vector<Vec3> graded_points() {
  std::vector<Vec3> points = test::plate(60).nodes;
  for (Vec3& x : points) x.x() *= x.x() * x.x();
  for (const Vec3& x : test::plate(30).nodes) points.push_back(1e-3 * x + Vec3(0, 0, 0.1));
  return points;
}

const std::vector<Distance>& distances() {
  static const std::vector<Distance> all = {
      Distance::euclidean(),
      Distance::stretched({.lengths = {1, 0.2, std::numeric_limits<double>::infinity()}}),
      Distance::periodic({1, 1, 0}), Distance::great_circle(Sphere{{0.5, 0.5, -2}, 2.1, 0})};
  return all;
}

TEST(PointTree, EachPointCountsOnceAndCellsLookSmall) {
  const std::vector<Vec3> points = graded_points();
  for (const Distance& distance : distances()) {
    const PointTree tree(points, distance);
    for (const double angle : {0.0, 0.2, 0.5})
      for (const std::size_t from : {std::size_t{0}, std::size_t{1700}, points.size() - 1}) {
        std::vector<int> times(points.size(), 0);
        const auto on_cell = [&](std::size_t cell, Index centre) {
          const double far = distance(points[from], points[centre]);
          double radius = 0;
          for (const Index i : tree.points(cell)) {
            ++times[i];
            radius = std::max(radius, distance(points[centre], points[i]));
          }
          // 10 % for great circles through points that are on no sphere.
          EXPECT_LE(2 * radius, 1.1 * angle * (far - radius) + 1e-15);
        };
        tree.visit(
            points[from], angle, [&](Index i) { ++times[i]; }, on_cell);
        EXPECT_EQ(times, std::vector<int>(points.size(), 1));
      }
  }
}

TEST(PointTree, AngleZeroTakesPointsSingly) {
  const std::vector<Vec3> points = graded_points();
  const PointTree tree(points, Distance::euclidean());
  std::size_t n = 0;
  tree.visit(
      points[7], 0, [&](Index) { ++n; }, [](std::size_t, Index) { FAIL(); });
  EXPECT_EQ(n, points.size());
}

TEST(PointTree, ManyPointsTakeFewTerms) {
  const std::vector<Vec3> points = test::plate(300).nodes;
  const PointTree tree(points, Distance::euclidean());
  std::size_t n = 0;
  tree.visit(
      points[45'000], 0.2, [&](Index) { ++n; }, [&](std::size_t, Index) { ++n; });
  EXPECT_LT(n, points.size() / 10);
}

// Potential of a unit square of mass 1 at its centre: 4 ln(1 + sqrt 2). A cell seen under the
// angle a as one point near its mean errs by some a^2 / 12 = 0.3 %; the point itself, left out,
// is a square of side h, whose share is h.
TEST(PointTree, PotentialOfASquare) {
  constexpr int divisions = 200;
  const std::vector<Vec3> points = test::plate(divisions).nodes;
  const PointTree tree(points, Distance::euclidean());
  const Vec3 centre(0.5, 0.5, 0);
  const auto weight = [](const Vec3& x) {  // trapezoidal rule
    const auto of_axis = [](double c) { return c < 1e-9 || c > 1 - 1e-9 ? 0.5 : 1.0; };
    return of_axis(x.x()) * of_axis(x.y()) / (divisions * divisions);
  };
  double sum = 4 * std::log(1 + std::numbers::sqrt2) / divisions;
  const auto add = [&](const Vec3& x, double mass) {
    if (const double r = (x - centre).norm(); r > 1e-9) sum += mass / r;
  };
  tree.visit(
      centre, 0.2, [&](Index i) { add(points[i], weight(points[i])); },
      [&](std::size_t cell, Index i) {
        double mass = 0;
        for (const Index j : tree.points(cell)) mass += weight(points[j]);
        add(points[i], mass);
      });
  EXPECT_NEAR(sum, 4 * std::log(1 + std::numbers::sqrt2), 0.01);
}

TEST(PointTree, CoincidentPointsEndInOneLeaf) {
  std::vector<Vec3> points(100, Vec3(1, 2, 3));
  points.emplace_back(4, 5, 6);
  const PointTree tree(points, Distance::euclidean());
  std::size_t n = 0;
  tree.visit(
      points[0], 0.2, [&](Index) { ++n; }, [&](std::size_t, Index) { ++n; });
  EXPECT_EQ(n, 101u);
  EXPECT_EQ(PointTree(std::span<const Vec3>(), Distance::euclidean()).n_cells(), 0u);
}

}  // namespace
}  // namespace roughmesh::detail
