// SPDX-License-Identifier: BSD-3-Clause
// What the audit of the method `lattice` looks at are the rows of its heights, and it sees a
// mistake in any of them.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "audit.hpp"
#include "field_method.hpp"
#include "support/lattice_cases.hpp"
#include "support/lattice_rows.hpp"

namespace roughmesh {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.3});
const Autocorrelation exponential({.family = Family::exponential, .length = 0.3});
const Autocorrelation short_exponential({.family = Family::exponential, .length = 0.05});

/// About 500 nodes of a sphere, no end of the mesh at a special place.
std::vector<Vec3> nodes_of_sphere() {
  std::vector<Vec3> nodes = test::moved(test::icosphere(3).nodes, {0.123, -4.56, 0.789});
  nodes.resize(500);
  return nodes;
}

/// Heights are rows times noise, and covariances products of the same rows: sums of some thousand
/// terms of order 1 at most, in another order. Returns the rows.
test::LatticeRows expect_rows(const std::vector<Vec3>& places,
                              const Autocorrelation& autocorrelation, const Distance& distance,
                              FieldOptions options) {
  constexpr double rounding = 1e-12;
  options.method = Method::lattice;
  const Correlation correlation(places, autocorrelation, distance);
  const FieldSampler sampler(correlation, options);
  test::LatticeRows rows(correlation, options);
  EXPECT_EQ(sampler.summary().lattice->terms.size(), rows.n_levels());
  for (const std::uint64_t realization : {0, 1})
    EXPECT_LT(
        test::largest_difference(sampler.heights(17, realization), rows.heights({17, realization})),
        rounding);
  const Eigen::MatrixXd covariance = rows.covariance();
  double largest = 0, largest_error = 0;
  for (Index i = 0; i < correlation.n_points(); ++i)
    for (Index j = 0; j <= i; ++j) {
      const double c = sampler.covariance(i, j);
      largest = std::max(largest, std::abs(c - covariance(i, j)));
      largest_error = std::max(largest_error, std::abs(c - sampler.target(i, j)));
    }
  EXPECT_LT(largest, rounding);
  EXPECT_LE(largest_error, options.tolerance);  // of all pairs, not of those audited alone
  return rows;
}

TEST(LatticeRows, OfOneGaussian) {
  expect_rows(nodes_of_sphere(), gaussian, Distance::euclidean(), {.tolerance = 1e-3});
}

TEST(LatticeRows, OfAMixtureWithNuggets) {
  expect_rows(nodes_of_sphere(), exponential, Distance::euclidean(), {.tolerance = 1e-2});
}

// Edges from 0.01 to 1 of the largest: places with any number of terms left to the nugget.
TEST(LatticeRows, OfAGradedMesh) {
  const std::vector<Vec3> places = test::graded_plate();
  const Autocorrelation rough({.family = Family::self_affine, .length = 0.03, .hurst = 0.7});
  const FieldOptions options{.method = Method::lattice, .tolerance = 1e-2, .dimension = 2};
  const test::LatticeRows rows = expect_rows(places, rough, Distance::euclidean(), options);
  EXPECT_GT(rows.n_partly_skipped(), 100U);
}

TEST(LatticeRows, UnderACutoff) {
  expect_rows(nodes_of_sphere(), exponential, Distance::euclidean(),
              {.tolerance = 1e-2, .cutoff = 0.2});
}

TEST(LatticeRows, OfStretchedSpaces) {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).matrix();
  const Distance unequal = Distance::stretched({.lengths = {0.3, 1, 0.5}, .axes = turned});
  expect_rows(nodes_of_sphere(), gaussian, unequal, {.tolerance = 1e-2});
  const Distance streaks = Distance::stretched({.lengths = {0.3, inf, 0.5}, .axes = turned});
  expect_rows(nodes_of_sphere(), gaussian, streaks, {.tolerance = 1e-3});
  expect_rows(nodes_of_sphere(), short_exponential, streaks, {.tolerance = 1e-2});
}

TEST(LatticeRows, OfPeriodicSpaces) {
  std::vector<Vec3> places = nodes_of_sphere();
  places.resize(200);
  for (const Vec3& period : {Vec3(2.2, 0, 0), Vec3(0.7, 2.1, 3), Vec3(0, 0.3, 0.25)}) {
    expect_rows(places, gaussian, Distance::periodic(period), {.tolerance = 1e-2});
    expect_rows(places, short_exponential, Distance::periodic(period), {.tolerance = 1e-2});
  }
  for (Vec3& x : places) x.z() = -0.7;
  const Distance plane = Distance::periodic({2.2, 2, 0}, {.lengths = {0.3, 0.9, 1}});
  expect_rows(places, gaussian, plane, {.tolerance = 1e-3, .dimension = 2});
}

/// Fine and coarse levels, places without some of the fine ones, and so nuggets, in one field.
void expect_rows_of_every_kind(const std::vector<Vec3>& places,
                               const AutocorrelationOptions& autocorrelation,
                               const Distance& distance, const FieldOptions& options) {
  const test::LatticeRows rows =
      expect_rows(places, Autocorrelation(autocorrelation), distance, options);
  EXPECT_GE(rows.n_coarse(), 2U);
  EXPECT_GE(rows.n_levels(), rows.n_coarse() + 2);
  EXPECT_GT(rows.n_partly_skipped(), 10U);
}

TEST(LatticeRows, OfEveryKindOfLevel) {
  const std::vector<Vec3> plate = test::graded_plate(12);
  std::vector<Vec3> saddle = plate;
  for (Vec3& x : saddle) x.z() = 0.3 * x.x() * x.y();
  const AutocorrelationOptions rough{.family = Family::exponential, .length = 0.2};
  const AutocorrelationOptions heavy_tailed{
      .family = Family::rational_quadratic, .length = 0.05, .alpha = 0.4};
  for (const AutocorrelationOptions& rho : {rough, heavy_tailed}) {
    expect_rows_of_every_kind(plate, rho, Distance::euclidean(),
                              {.tolerance = 1e-4, .dimension = 2});
    expect_rows_of_every_kind(saddle, rho, Distance::euclidean(), {.tolerance = 1e-2});
  }
  expect_rows_of_every_kind(plate, rough, Distance::periodic({2, 3, 0}),
                            {.tolerance = 1e-3, .dimension = 2});
  expect_rows_of_every_kind(saddle, rough, Distance::stretched({.lengths = {0.3, 0.2, inf}}),
                            {.tolerance = 1e-3});
}

/// A field of some levels, as the audit sees it.
class LevelsField final : public detail::FieldMethod {
 public:
  LevelsField(const Correlation& correlation, std::vector<detail::LatticeLevel> levels)
      : FieldMethod(correlation), levels_(std::move(levels)) {}

  std::vector<double> heights(const NoiseStream& /*stream*/) const override { return {}; }
  std::vector<double> covariances(std::span<const detail::PointPair> pairs) const override {
    const std::span<const Vec3> places = correlation().places();
    std::vector<double> result;
    for (const auto& [i, j] : pairs) {
      double sum = 0;
      for (const detail::LatticeLevel& level : levels_)
        sum += detail::level_covariance(level, places[i], places[j]);
      result.push_back(sum);
    }
    return result;
  }

 private:
  std::vector<detail::LatticeLevel> levels_;
};

class PlantedMistake : public ::testing::Test {
 protected:
  double audited_error(const std::vector<detail::LatticeLevel>& levels) const {
    return detail::audit_covariance(LevelsField(correlation_, levels)).covariance_error;
  }
  static detail::LatticeAxis axis(double scale, std::size_t width = 7) {
    return {scale, detail::kernel_widths()[width]};
  }

  // rho of this table is 0.7 exp(-r^2 / 2) + 0.3 exp(-r^2 / (2 * 0.3^2)), r in units of 0.4.
  Autocorrelation table_{{.family = Family::table, .table = test::table_of_two_gaussians(0.4)}};
  std::vector<Vec3> places_ = nodes_of_sphere();
  Correlation correlation_{places_, table_, Distance::euclidean()};
  detail::LatticeSpace space_{Distance::euclidean(), 3};
  std::vector<detail::LatticeLevel> levels_ = levels_of_table();

 private:
  std::vector<detail::LatticeLevel> levels_of_table() const {
    std::vector<detail::MixtureTerm> terms;
    for (const GaussianTerm& term : table_.gaussian_terms())
      terms.push_back({static_cast<int>(terms.size()), term.scale, term.weight});
    return detail::make_levels(terms, space_, 1e-4, 0);
  }
};

TEST_F(PlantedMistake, IsNotSeenWhereThereIsNone) {
  EXPECT_LE(audited_error(levels_), 1e-4);
  EXPECT_GE(levels_.size(), 2U);
}

TEST_F(PlantedMistake, InAWeightIsSeen) {
  for (detail::LatticeLevel& level : levels_) {
    const double right = level.weight;
    level.weight += 1e-3;
    EXPECT_GT(audited_error(levels_), 0.9e-3);
    level.weight = right;
  }
}

TEST_F(PlantedMistake, InAScaleIsSeen) {
  for (detail::LatticeLevel& level : levels_) {
    if (level.weight < 0.1) continue;
    const detail::LatticeAxis right = level.axes[1];
    level.axes[1] = axis(1.05 * level.scale);
    EXPECT_GT(audited_error(levels_), 1e-3);
    level.axes[1] = right;
  }
}

TEST_F(PlantedMistake, InAnAxisThatDoesNotVaryIsSeen) {
  levels_.back().axes[2] = {};
  EXPECT_GT(audited_error(levels_), 0.1);
}

// Points that wrap where they should not: a wrong index.
TEST_F(PlantedMistake, InAnIndexIsSeen) {
  detail::LatticeLevel& level = levels_.back();
  level.axes[0] = detail::LatticeAxis(level.scale, detail::kernel_widths()[7], 1.9);
  EXPECT_GT(audited_error(levels_), 1e-2);
}

TEST_F(PlantedMistake, OfAMissingTermIsSeen) {
  const double lost = levels_.front().weight;
  levels_.erase(levels_.begin());
  EXPECT_GT(audited_error(levels_), 0.9 * lost);
}

TEST_F(PlantedMistake, OfAKernelThatIsTooNarrowIsSeen) {
  detail::LatticeLevel& level = levels_.back();
  level.axes.fill(axis(level.scale, 3));
  EXPECT_GT(audited_error(levels_), 1e-3);
}

}  // namespace
}  // namespace roughmesh
