// SPDX-License-Identifier: BSD-3-Clause
// The method `lattice` in a plane, under unequal lengths along turned axes, and in streaks.
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "support/errors.hpp"
#include "support/lattice_cases.hpp"
#include "support/planar.hpp"

namespace roughmesh {
namespace {

using test::lattice_sampler;

constexpr double inf = std::numeric_limits<double>::infinity();

void expect_tolerance_kept(const std::vector<Vec3>& places, const Distance& distance, double length,
                           int dimension) {
  double tolerance = 1e-6;
  for (const auto& [name, autocorrelation] : test::some_autocorrelations(length)) {
    SCOPED_TRACE(name);
    tolerance *= 10;
    const FieldSampler sampler = lattice_sampler(places, Autocorrelation(autocorrelation), distance,
                                                 {.tolerance = tolerance, .dimension = dimension});
    EXPECT_LE(sampler.audit().covariance_error, tolerance);
    for (const double height : sampler.heights(1, 2)) ASSERT_LT(std::abs(height), 7);
  }
}

Eigen::Matrix3d turned(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Half a sphere of about 90 nodes.
std::vector<Vec3> hemisphere() {
  std::vector<Vec3> nodes = test::icosphere(2).nodes;
  std::erase_if(nodes, [](const Vec3& x) { return x.x() + 0.1 * x.y() > 0.1; });
  return nodes;
}

TEST(LatticeFieldSpaces, PlaneOfDimensionTwo) {
  const std::vector<Vec3> circle = test::circle_points(test::uneven_angles(120), 2);
  for (const double z : {0.0, -17.5}) {
    const std::vector<Vec3> places = test::moved(circle, {3, -1, z});
    expect_tolerance_kept(places, Distance::euclidean(), 0.3, 2);
    const Distance ellipse =
        Distance::stretched({.lengths = {0.3, 0.9, 1}, .axes = turned(0.4, Vec3::UnitZ())});
    expect_tolerance_kept(places, ellipse, 0.3, 2);
  }
}

// The third coordinate of a plane is the same for all, whatever it is: no bit of a height changes.
TEST(LatticeFieldSpaces, PlaneHasNoHeightAboveTheOrigin) {
  const std::vector<Vec3> circle = test::circle_points(test::uneven_angles(200), 2);
  for (const auto& [name, autocorrelation] : test::some_autocorrelations(0.3)) {
    const Autocorrelation rho(autocorrelation);
    const auto heights = [&](double z) {
      return lattice_sampler(test::moved(circle, {0, 0, z}), rho, Distance::euclidean(),
                             {.dimension = 2})
          .heights(0, 0);
    };
    EXPECT_EQ(heights(0), heights(1e3)) << name;
  }
}

// A plane is summed over lattices of two axes, and of three if nobody says that it is one. Both are
// the field that was asked for, but not the same realization.
TEST(LatticeFieldSpaces, PlaneOfDimensionThreeIsAnotherRealizationOfTheSameField) {
  const std::vector<Vec3> plate = test::plate(15).nodes;
  const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.2});
  const FieldSampler two =
      lattice_sampler(plate, gaussian, Distance::euclidean(), {.dimension = 2});
  const FieldSampler three = lattice_sampler(plate, gaussian, Distance::euclidean());
  EXPECT_NE(two.heights(0, 0), three.heights(0, 0));
  for (const Index j : {0, 1, 40, 255})
    EXPECT_NEAR(two.covariance(17, j), three.covariance(17, j), 2e-4);
}

TEST(LatticeFieldSpaces, UnequalLengthsAlongTurnedAxes) {
  const std::vector<Vec3> sphere = hemisphere();
  const std::array<Eigen::Matrix3d, 3> frames = {Eigen::Matrix3d::Identity(),
                                                 turned(0.7, {1, 2, 3}),
                                                 Eigen::Matrix3d(Vec3(-1, 1, -1).asDiagonal())};
  for (const Eigen::Matrix3d& axes : frames)
    expect_tolerance_kept(sphere, Distance::stretched({.lengths = {0.3, 1, 0.5}, .axes = axes}),
                          0.3, 3);
}

TEST(LatticeFieldSpaces, Streaks) {
  const std::vector<Vec3> sphere = hemisphere();
  for (const auto& lengths :
       {std::array{0.3, inf, 1.0}, std::array{inf, 0.3, 0.5}, std::array{inf, inf, 0.3}}) {
    SCOPED_TRACE(testing::PrintToString(lengths));
    expect_tolerance_kept(sphere, Distance::stretched({.lengths = lengths}), 0.3, 3);
    expect_tolerance_kept(
        sphere, Distance::stretched({.lengths = lengths, .axes = turned(0.5, {1, 1, 0})}), 0.3, 3);
  }
  const std::vector<Vec3> plate = test::plate(10).nodes;
  expect_tolerance_kept(plate, Distance::stretched({.lengths = {0.15, inf, 1.0}}), 0.15, 2);
  expect_tolerance_kept(plate, Distance::stretched({.lengths = {inf, 0.15, 1.0}}), 0.15, 2);
}

// Nodes of a column differ along the streaks only: one height, bit by bit, whatever the family.
TEST(LatticeFieldSpaces, PlacesOnOneStreakShareTheirHeight) {
  const std::vector<Vec3> plate = test::plate(15).nodes;
  const Distance streaks = Distance::stretched({.lengths = {0.1, inf, 1.0}});
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.1)) {
    const FieldSampler sampler =
        lattice_sampler(plate, Autocorrelation(autocorrelation), streaks, {.dimension = 2});
    const std::vector<double> d = sampler.heights(3, 1);
    for (std::size_t i = 16; i < plate.size(); ++i) ASSERT_EQ(d[i], d[i - 16]) << name;
    EXPECT_NE(d[0], d[1]);
    EXPECT_NEAR(sampler.covariance(3, 3 + 16 * 5), 1, 1e-4);
  }
}

// Columns closer to each other than the cells that places are sorted by; each has many places.
TEST(LatticeFieldSpaces, CloseStreaksKeepTheirPlacesTogether) {
  std::vector<Vec3> places;
  for (int row = 0; row < 30; ++row)
    for (const double x : {0.0, 0.3, 0.7, 0.7 + 3e-7, 1.0}) places.emplace_back(x, 0.1 * row, 0);
  const Distance streaks = Distance::stretched({.lengths = {0.2, inf, 1.0}});
  const Autocorrelation exponential({.family = Family::exponential, .length = 0.2});
  const FieldSampler sampler =
      lattice_sampler(places, exponential, streaks, {.tolerance = 1e-3, .dimension = 2});
  EXPECT_LE(sampler.audit().covariance_error, 1e-3);
  const std::vector<double> d = sampler.heights(0, 0);
  for (std::size_t i = 5; i < places.size(); ++i) ASSERT_EQ(d[i], d[i - 5]);
}

TEST(LatticeFieldSpaces, OnePlaceHasUnitVariance) {
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(1, -2, 3), Vec3(-1e5, 1e-9, 7)})
    for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4)) {
      const FieldSampler sampler = lattice_sampler({place}, Autocorrelation(autocorrelation),
                                                   Distance::euclidean(), {.tolerance = 1e-6});
      EXPECT_NEAR(sampler.covariance(0, 0), 1, 1e-12) << name;
      EXPECT_LT(sampler.audit().covariance_error, 1e-12) << name;
      EXPECT_EQ(sampler.audit().n_pairs, 0);
      const std::vector<double> d = sampler.heights(4, 5);
      ASSERT_EQ(d.size(), 1U);
      EXPECT_TRUE(std::isfinite(d[0]) && d[0] != 0 && std::abs(d[0]) < 7) << name;
    }
}

// Bodies much smaller than the scales of the mixture.
TEST(LatticeFieldSpaces, FewClosePlaces) {
  for (const int n : {2, 3, 8})
    for (const double step : {1e-3, 1e-2, 0.1})
      for (const auto& [name, autocorrelation] : test::all_autocorrelations(1)) {
        std::vector<Vec3> places;
        for (int i = 0; i < n; ++i) places.emplace_back(0.3 + i * step, 0.1, -0.2);
        const FieldSampler sampler =
            lattice_sampler(places, Autocorrelation(autocorrelation), Distance::euclidean());
        EXPECT_LE(sampler.audit().covariance_error, 1e-4) << name << ' ' << step;
        for (const double d : sampler.heights(0, 0)) EXPECT_LT(std::abs(d), 7) << name;
      }
}

TEST(LatticeFieldSpaces, EqualPlacesShareTheirHeight) {
  std::vector<Vec3> places = test::icosphere(1).nodes;
  const std::vector<Vec3> once = places;
  for (std::size_t i = 0; i < once.size(); i += 3) places.push_back(once[i]);
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4))
    for (const std::vector<Vec3>& some : {places, std::vector<Vec3>(7, Vec3(1, 2, 3))}) {
      const FieldSampler sampler =
          lattice_sampler(some, Autocorrelation(autocorrelation), Distance::euclidean());
      const std::vector<double> d = sampler.heights(4, 5);
      const std::size_t n = some.size() == 7 ? 1 : once.size();
      for (std::size_t i = n; i < some.size(); ++i) {
        const std::size_t equal = n == 1 ? 0 : 3 * (i - n);
        EXPECT_EQ(d[i], d[equal]) << name;
        EXPECT_NEAR(sampler.covariance(static_cast<Index>(i), static_cast<Index>(equal)), 1, 1e-4);
      }
    }
}

}  // namespace
}  // namespace roughmesh
