// SPDX-License-Identifier: BSD-3-Clause
// Periodic fields of the method `lattice`: the sum over images, heights that repeat.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "support/lattice_cases.hpp"

namespace roughmesh {
namespace {

using test::lattice_sampler;

constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_places(int n, const Vec3& size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-0.25, 1.5);  // not in one period
  std::vector<Vec3> places;
  for (int i = 0; i < n; ++i)
    places.emplace_back(Vec3(part(random), part(random), part(random)).cwiseProduct(size));
  return places;
}

/// Families whose sum over images exists along three axes.
std::vector<test::NamedAutocorrelation> summable(double length) {
  using enum Family;
  return {{"gaussian", {.family = gaussian, .length = length}},
          {"exponential", {.family = exponential, .length = length}},
          {"matern 2.5", {.family = matern, .length = length, .nu = 2.5}},
          {"rational-quadratic 5", {.family = rational_quadratic, .length = length, .alpha = 5.0}},
          {"table", {.family = table, .table = test::table_of_two_gaussians(length)}}};
}

void expect_tolerance_kept(const std::vector<Vec3>& places, const Distance& distance, double length,
                           FieldOptions options) {
  for (const auto& [name, autocorrelation] : summable(length)) {
    SCOPED_TRACE(name + ", length " + std::to_string(length));
    const Correlation correlation(places, Autocorrelation(autocorrelation), distance);
    options.method = Method::lattice;
    const FieldSampler sampler(correlation, options);
    EXPECT_LE(sampler.audit().covariance_error, options.tolerance);
    for (Index j = 0; j < correlation.n_points(); j += 17)
      EXPECT_NEAR(sampler.covariance(5, j), correlation(5, j), options.tolerance);
  }
}

TEST(PeriodicLatticeField, HasTheCovarianceOfAllImages) {
  for (const Vec3& period : {Vec3(1, 0, 0), Vec3(0, 1.2, 1), Vec3(1, 1.3, 0.8)}) {
    const std::vector<Vec3> places = random_places(70, {1, 1.3, 0.8});
    for (const double length : {2.0, 1.1, 0.6, 0.35, 0.2, 0.11, 0.05}) {
      SCOPED_TRACE(testing::PrintToString(std::array{period.x(), period.y(), period.z()}));
      expect_tolerance_kept(places, Distance::periodic(period), length, {.tolerance = 1e-4});
    }
    expect_tolerance_kept(places, Distance::periodic(period), 0.3, {.tolerance = 1e-6});
  }
}

TEST(PeriodicLatticeField, HasItInAPlaneUnderUnequalLengthsAndInStreaks) {
  std::vector<Vec3> places = random_places(70, {1, 1.3, 0});
  const auto expect_kept = [&](const Vec3& period, const Anisotropy& anisotropy, int dimension) {
    expect_tolerance_kept(places, Distance::periodic(period, anisotropy), 0.2,
                          {.tolerance = 1e-4, .dimension = dimension});
  };
  expect_kept({1, 0, 0}, {.lengths = {1, 1, 1}}, 2);
  expect_kept({1, 1.3, 0}, {.lengths = {1, 2.5, 1}}, 2);
  expect_kept({0, 1.3, 0}, {.lengths = {inf, 2.5, 1}}, 2);
  expect_kept({1, 1.3, 0}, {.lengths = {1, inf, 1}}, 2);
  expect_kept({1, 1.3, 5}, {.lengths = {1, 0.3, 2}}, 3);
}

// A place and its images are reduced to one place, but for rounding of 1e-16 periods, which moves
// heights by that over the smallest scale, some 1e-3 periods: so 1e-12 times their size.
TEST(PeriodicLatticeField, RepeatsItsHeights) {
  const Vec3 period(1, 1.3, 0.8);
  const std::vector<Vec3> places = random_places(200, period);
  for (const auto& [name, autocorrelation] : summable(0.2)) {
    const Autocorrelation rho(autocorrelation);
    const auto heights = [&](const Vec3& shift) {
      return lattice_sampler(test::moved(places, shift), rho, Distance::periodic(period))
          .heights(8, 1);
    };
    const std::vector<double> d = heights(Vec3::Zero());
    for (const Vec3& shift : {Vec3(1, 0, 0), Vec3(0, -2.6, 0), Vec3(5, 1.3, -0.8)})
      EXPECT_LT(test::largest_difference(d, heights(shift)), 1e-11) << name;
    EXPECT_GT(test::largest_difference(d, heights({0.5, 0, 0})), 0.1) << name;
  }
}

// In one field, too: whole numbers of sixteenths make images equal, bit by bit.
TEST(PeriodicLatticeField, GivesPlacesAndTheirImagesOneHeight) {
  std::vector<Vec3> places = test::plate(16).nodes;  // both ends of the period among them
  for (const auto& [name, autocorrelation] : summable(0.1)) {
    const FieldSampler sampler = lattice_sampler(places, Autocorrelation(autocorrelation),
                                                 Distance::periodic({1, 0.5, 0}), {.dimension = 2});
    const std::vector<double> d = sampler.heights(0, 0);
    for (std::size_t row = 0; row < 17; ++row) {
      EXPECT_EQ(d[17 * row], d[17 * row + 16]) << name;
      for (std::size_t i = 0; row >= 8 && i < 17; ++i)
        EXPECT_EQ(d[17 * row + i], d[17 * (row - 8) + i]) << name;
    }
    EXPECT_LE(sampler.audit().covariance_error, 1e-4) << name;
  }
}

// Two places half a cell apart along every axis have eight nearest images of each other: what is
// left out for such a distance counts eight times.
TEST(PeriodicLatticeField, CountsEveryImageOfWhatItLeavesOut) {
  const std::vector<Vec3> places = {{0.2, 0.3, 0.4}, {0.7, 0.8, 0.9}};
  for (double length = 0.05; length < 2; length *= 1.05)
    for (const double tolerance : {1e-2, 1e-4}) {
      const FieldSampler sampler = lattice_sampler(
          places, Autocorrelation({.family = Family::exponential, .length = length}),
          Distance::periodic({1, 1, 1}), {.tolerance = tolerance});
      EXPECT_LE(sampler.audit().covariance_error, tolerance) << length;
    }
}

// Where the length is above all periods the field is one number.
TEST(PeriodicLatticeField, IsConstantWhereThePeriodIsShort) {
  const std::vector<Vec3> places = random_places(50, {1, 1, 1});
  const Autocorrelation gaussian({.family = Family::gaussian, .length = 3});
  const FieldSampler sampler =
      lattice_sampler(places, gaussian, Distance::periodic({1, 1, 1}), {.tolerance = 1e-8});
  const std::vector<double> d = sampler.heights(0, 0);
  for (const double height : d) EXPECT_EQ(height, d[0]);
  EXPECT_LE(sampler.audit().covariance_error, 1e-8);
}

// The tolerance holds up to where a Gaussian is taken for a constant, and beyond.
TEST(PeriodicLatticeField, KeepsASmallToleranceWhereThePeriodIsAlmostShort) {
  const std::vector<Vec3> places = random_places(40, {1, 1, 1});
  for (const double length : {0.8, 0.9, 0.99, 1.0, 1.1, 1.19, 1.2, 1.3}) {
    const Autocorrelation gaussian({.family = Family::gaussian, .length = length});
    for (const double tolerance : {1e-8, 1e-6})
      EXPECT_LE(
          lattice_sampler(places, gaussian, Distance::periodic({1, 1, 1}), {.tolerance = tolerance})
              .audit()
              .covariance_error,
          tolerance)
          << length;
  }
}

}  // namespace
}  // namespace roughmesh
