// SPDX-License-Identifier: BSD-3-Clause
// Realizations of the method `lattice` are Gaussian with the covariance asked for, as those of
// `cholesky` are, and independent of each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "lattice_level.hpp"
#include "support/lattice_cases.hpp"
#include "support/lattice_rows.hpp"

namespace roughmesh {
namespace {

using test::lattice_sampler;

constexpr int n_realizations = 4000;
constexpr double tolerance = 1e-3;

/// n points of a disk of radius 1 in the plane z = 0, spread by the golden angle.
std::vector<Vec3> disk_points(int n) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double r = std::sqrt((i + 0.5) / n), angle = 2 * std::numbers::pi * i / std::numbers::phi;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  return test::sorted(std::move(points));
}

/// Realizations as columns.
Eigen::MatrixXd realizations(const FieldSampler& sampler, int n_points) {
  Eigen::MatrixXd heights(n_points, n_realizations);
  for (int k = 0; k < n_realizations; ++k) {
    const std::vector<double> d = sampler.heights(2020, static_cast<std::uint64_t>(k));
    heights.col(k) = Eigen::Map<const Eigen::VectorXd>(d.data(), n_points);
  }
  return heights;
}

// Isserlis: Var[d_i d_j] = C_ii C_jj + C_ij^2, so the mean product of n realizations has the
// standard error sqrt((C_ii C_jj + C_ij^2) / n). Six of them: p < 2e-9 for each of 20,100 pairs.
void expect_sample_covariance(const FieldSampler& sampler, const Eigen::MatrixXd& heights) {
  const Eigen::MatrixXd mean_product = heights * heights.transpose() / n_realizations;
  for (Index i = 0; i < heights.rows(); ++i)
    for (Index j = 0; j <= i; ++j) {
      const double c = sampler.target(i, j), product = sampler.target(i, i) * sampler.target(j, j);
      const double error = std::sqrt((product + c * c) / n_realizations);
      ASSERT_NEAR(mean_product(i, j), c, 6 * error + tolerance) << i << ", " << j;
    }
}

// Of a standard normal number: mean of d^3 is 0 with variance 15, of d^4 is 3 with variance 96.
// Of 800,000 numbers none is above 6.5 (p < 7e-5), but at every place one of 4,000 is above 2.8 (p
// < 4e-9 that none is).
void expect_normal_numbers(const Eigen::MatrixXd& heights) {
  for (int i = 0; i < heights.rows(); ++i) {
    const auto d = heights.row(i).array();
    EXPECT_NEAR(d.mean(), 0, 6 / std::sqrt(n_realizations)) << i;
    EXPECT_NEAR(d.cube().mean(), 0, 6 * std::sqrt(15.0 / n_realizations)) << i;
    EXPECT_NEAR(d.square().square().mean(), 3, 6 * std::sqrt(96.0 / n_realizations) + 6 * tolerance)
        << i;
    EXPECT_LT(d.abs().maxCoeff(), 6.5) << i;
    EXPECT_GT(d.maxCoeff(), 2.8) << i;
    EXPECT_LT(d.minCoeff(), -2.8) << i;
  }
}

/// Mean and its standard error of a number for each realization.
struct Mean {
  double value = 0, error = 0;
};

Mean mean_of(const Eigen::ArrayXd& numbers) {
  const double mean = numbers.mean();
  return {mean, std::sqrt((numbers - mean).square().mean() / static_cast<double>(numbers.size()))};
}

// Functions of all places at once, which a covariance does not tell: the highest place, the fourth
// moment over the places, the share of places above 1.
std::array<Mean, 3> joint_statistics(const Eigen::MatrixXd& heights) {
  const auto columns = heights.array();
  return {mean_of(heights.colwise().maxCoeff().transpose().array()),
          mean_of(columns.square().square().colwise().mean().transpose()),
          mean_of((columns > 1).cast<double>().colwise().mean().transpose())};
}

void expect_one_law(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto x = joint_statistics(a), y = joint_statistics(b);
  for (std::size_t k = 0; k < x.size(); ++k)
    EXPECT_NEAR(x[k].value, y[k].value, 5 * std::hypot(x[k].error, y[k].error)) << k;
}

TEST(LatticeLaw, IsThatOfCholesky) {
  const std::vector<Vec3> points = disk_points(200);
  for (const Family family : {Family::gaussian, Family::exponential}) {
    const Autocorrelation rho({.family = family, .length = 0.3});
    const FieldSampler lattice = lattice_sampler(points, rho, Distance::euclidean(),
                                                 {.tolerance = tolerance, .dimension = 2});
    const Eigen::MatrixXd heights = realizations(lattice, 200);
    expect_sample_covariance(lattice, heights);
    expect_normal_numbers(heights);
    const FieldSampler cholesky(Correlation(points, rho, Distance::euclidean()),
                                {.method = Method::cholesky});
    expect_one_law(heights, realizations(cholesky, 200));
  }
}

// Places near enough to each other that long scales are summed over cells.
TEST(LatticeLaw, IsThatOfCholeskyWhereLevelsAreCoarse) {
  const std::vector<Vec3> points = disk_points(200);
  for (const AutocorrelationOptions& family :
       {AutocorrelationOptions{.family = Family::exponential, .length = 1.5},
        AutocorrelationOptions{
            .family = Family::rational_quadratic, .length = 0.5, .alpha = 0.5}}) {
    const Autocorrelation rho(family);
    const FieldOptions options{.method = Method::lattice, .tolerance = tolerance, .dimension = 2};
    const Correlation correlation(points, rho, Distance::euclidean());
    EXPECT_GE(test::n_coarse_levels(correlation, options), 2U);
    const FieldSampler lattice(correlation, options);
    const Eigen::MatrixXd heights = realizations(lattice, 200);
    expect_sample_covariance(lattice, heights);
    const FieldSampler cholesky(correlation, {.method = Method::cholesky});
    expect_one_law(heights, realizations(cholesky, 200));
  }
}

TEST(LatticeLaw, HoldsInSpaceAndUnderACutoff) {
  std::vector<Vec3> points = test::icosphere(1).nodes;
  const Autocorrelation rho({.family = Family::exponential, .length = 0.3});
  for (const std::optional<double> cutoff : {std::optional<double>(), std::optional(0.25)}) {
    const FieldSampler sampler = lattice_sampler(points, rho, Distance::euclidean(),
                                                 {.tolerance = tolerance, .cutoff = cutoff});
    expect_sample_covariance(sampler, realizations(sampler, 42));
  }
}

/// 2,500 places so far apart that their heights are independent.
std::vector<Vec3> distant_places(double length) {
  std::vector<Vec3> places;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j) places.emplace_back(9 * length * i, 9 * length * j, 0);
  return places;
}

double correlation_of(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / static_cast<double>(a.size());
}

// Products of independent standard normal numbers have variance 1.
void expect_uncorrelated(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_LT(std::abs(correlation_of(a, b)), 5 / std::sqrt(static_cast<double>(a.size())));
}

TEST(LatticeLaw, SeedsAndRealizationsAreIndependent) {
  const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.3});
  const FieldSampler sampler = lattice_sampler(distant_places(0.3), gaussian, Distance::euclidean(),
                                               {.tolerance = 1e-2, .dimension = 2});
  const std::vector<double> first = sampler.heights(0, 0);
  EXPECT_NEAR(correlation_of(first, first), 1, 5 * std::sqrt(2.0 / 2500));
  std::vector<double> before = first;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<double> d = sampler.heights(seed, 0);
    expect_uncorrelated(d, before);
    expect_uncorrelated(d, first);
    expect_uncorrelated(sampler.heights(0, seed), sampler.heights(0, seed - 1));
    expect_uncorrelated(sampler.heights(0, seed), d);  // not a sum of seed and realization
    before = d;
  }
}

// Nuggets and the lattices of levels with neighbouring keys, on the same points.
TEST(LatticeLaw, LevelsAreIndependent) {
  const detail::LatticeSpace space(Distance::euclidean(), 2);
  std::vector<Vec3> places = distant_places(1);
  for (Vec3& x : places) x = space(x);
  const detail::SortedPlaces sorted(places, 1);
  const auto heights = [&](std::int32_t key) {
    const std::vector<detail::MixtureTerm> term = {{key, 1.0, 1.0}};
    std::vector<double> d(places.size(), 0.0);
    detail::add_level(detail::make_levels(term, space, 1e-2, 0).front(), {5, 6}, sorted, {}, 0, d);
    return d;
  };
  for (std::int32_t key = -20; key < 20; ++key)
    for (const std::int32_t step : {1, 2, 7, 256, 65536}) {
      SCOPED_TRACE(key);
      expect_uncorrelated(heights(key), heights(key + step));
    }
}

// Realizations 0 and 1 of a rough family, nuggets among them.
TEST(LatticeLaw, NuggetsAreIndependent) {
  const Autocorrelation rough({.family = Family::stretched, .length = 0.01, .power = 0.5});
  const FieldSampler sampler = lattice_sampler(distant_places(0.3), rough, Distance::euclidean(),
                                               {.tolerance = 1e-2, .dimension = 2});
  EXPECT_GT(sampler.summary().lattice->nugget, 0.5);
  std::vector<double> before = sampler.heights(0, 0);
  for (std::uint64_t k = 1; k < 50; ++k) {
    const std::vector<double> d = sampler.heights(0, k), e = sampler.heights(k, 0);
    expect_uncorrelated(d, before);
    expect_uncorrelated(d, e);
    EXPECT_NEAR(correlation_of(d, d), 1, 5 * std::sqrt(2.0 / 2500));
    std::vector<double> neighbour(d.begin() + 1, d.end());
    neighbour.push_back(d.front());
    expect_uncorrelated(d, neighbour);
    before = d;
  }
}

}  // namespace
}  // namespace roughmesh
