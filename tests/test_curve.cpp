// SPDX-License-Identifier: BSD-3-Clause
// Arc length along open, closed and several curves.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/correlation.hpp"
#include "roughmesh/curve.hpp"

#include "support/curves.hpp"
#include "support/errors.hpp"

namespace roughmesh {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Points 0 1 2 3 stand along x, the chain runs 2-0-3-1, so its ends are 1 and 2 and it starts at 1.
TEST(CurvePlaces, OfAnOpenChainStartAtItsFirstEnd) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 5, 0}, {2, 0, 0}, {4, 1, 0}};
  const Surface surface = test::curve_of(points, {{2, 0}, {3, 1}, {0, 3}});
  const CurvePlaces curve = curve_places(surface);
  const double a = std::hypot(3, 4), b = std::hypot(4, 1), c = 2;  // 1-3, 3-0, 0-2
  const std::vector<double> s = {a + b, 0, a + b + c, a};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR((curve.places[i] - Vec3(s[i], 0, 0)).norm(), 0, 1e-14);
  ASSERT_EQ(curve.lengths.size(), 1u);
  EXPECT_NEAR(curve.lengths[0], a + b + c, 1e-14);
  EXPECT_EQ(curve.closed_lengths, std::vector<double>{infinite});
}

TEST(CurvePlaces, DoNotDependOnTheOrderOrDirectionOfTheLines) {
  const auto circle = test::circle(20, 3.0);
  const CurvePlaces expected = curve_places(circle);
  Surface turned = circle;
  for (Index line = 0; line < turned.n_faces(); line += 3)
    std::swap(turned.face_points[2 * line], turned.face_points[2 * line + 1]);
  std::swap(turned.face_points[0], turned.face_points[8]);
  std::swap(turned.face_points[1], turned.face_points[9]);
  const CurvePlaces places = curve_places(turned);
  EXPECT_EQ(places.places, expected.places);
}

// The shorter way round a regular polygon of n sides is the number of sides between two corners
// times a side.
TEST(CurveDistance, OnAClosedCurveIsTheShorterWayRound) {
  const int n = 15;
  const double radius = 2, side = 2 * radius * std::sin(std::numbers::pi / n);
  const Surface surface = test::circle(n, radius);
  const CurvePlaces curve = curve_places(surface);
  EXPECT_NEAR(curve.closed_lengths[0], n * side, 1e-12);
  const Distance distance = Distance::curve(curve.closed_lengths);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double angle = std::acos(
          std::clamp(surface.points[i].dot(surface.points[j]) / (radius * radius), -1.0, 1.0));
      const double sides = std::round(angle / (2 * std::numbers::pi / n));
      EXPECT_NEAR(distance(curve.places[i], curve.places[j]), sides * side, 1e-12);
    }
}

TEST(CurveDistance, SeparatesPieces) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}};
  const Surface surface = test::curve_of(points, {{0, 1}, {4, 2}, {2, 3}, {3, 4}});
  const CurvePlaces curve = curve_places(surface);
  ASSERT_EQ(curve.lengths.size(), 2u);
  EXPECT_EQ(curve.closed_lengths[0], infinite);
  EXPECT_NEAR(curve.closed_lengths[1], 2 + std::sqrt(2.0), 1e-15);
  for (const Family family : {Family::gaussian, Family::exponential}) {
    const Correlation correlation(curve.places, Autocorrelation({.family = family, .length = 1e9}),
                                  Distance::curve(curve.closed_lengths));
    EXPECT_EQ(correlation(0, 2), 0);
    EXPECT_EQ(correlation(4, 1), 0);
    EXPECT_NEAR(correlation(0, 1), 1, 1e-8);
    EXPECT_NEAR(correlation(2, 4), 1, 1e-8);
  }
}

TEST(CurvePlaces, RefuseBranchesAndFacesAndLostPoints) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 7, 0}};
  const std::string branch = test::message_of([&] {
    curve_places(test::curve_of(points, {{0, 1}, {1, 2}, {1, 3}}));
  });
  EXPECT_NE(branch.find("(1, 0, 0)"), std::string::npos) << branch;
  const std::string lost = test::message_of([&] {
    curve_places(test::curve_of(points, {{0, 1}, {1, 2}}));
  });
  EXPECT_NE(lost.find("(1, 7, 0)"), std::string::npos) << lost;
  Surface triangle = test::curve_of(points, {{0, 1}});
  triangle.face_points = {0, 1, 2};
  triangle.face_offsets = {0, 3};
  EXPECT_THROW(curve_places(triangle), InputError);
  EXPECT_THROW(Distance::curve({}), InputError);
  EXPECT_THROW(Distance::curve({1, 0}), InputError);
}

TEST(CurvePlaces, TakeLinearTime) {
  const int n = 300'000;  // a walk or search that restarts at each point would take minutes
  const CurvePlaces curve = curve_places(test::circle(n, 1.0));
  EXPECT_NEAR(curve.lengths[0], 2 * std::numbers::pi, 1e-9);
}

}  // namespace
}  // namespace roughmesh
