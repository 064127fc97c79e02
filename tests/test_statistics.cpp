// SPDX-License-Identifier: BSD-3-Clause
// Height parameters by their definitions, and the law of Sq against Monte Carlo.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "roughmesh/statistics.hpp"

#include "parallel.hpp"
#include "support/meshes.hpp"
#include "support/surfaces.hpp"

using namespace roughmesh;

namespace {

ExpectedSq expected_sq_of(const Surface& surface, const Autocorrelation& acf,
                          const Distance& distance) {
  return expected_sq(surface, Correlation(surface.points, acf, distance));
}

// Plate whose squares grow along x: node areas differ by a factor of 20.
Surface graded_plate(int divisions) {
  Mesh mesh = test::plate(divisions);
  for (Vec3& x : mesh.nodes) x.x() *= x.x();
  return test::surface_of(mesh);
}

// A dense sampler of its own: Cholesky factor of R, normal numbers by Box-Muller.
class DenseSampler {
 public:
  DenseSampler(const Surface& surface, const Autocorrelation& acf, const Distance& distance) {
    const Index n = surface.n_points();
    Eigen::MatrixXd matrix(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        matrix(i, j) = acf.rho(distance(surface.points[i], surface.points[j]));
    matrix.diagonal().array() += 1e-10;
    factor_ = matrix.llt().matrixL();
  }

  std::vector<double> heights() {
    Eigen::VectorXd noise(factor_.rows());
    for (double& w : noise) w = normal();
    const Eigen::VectorXd z = factor_ * noise;
    return {z.begin(), z.end()};
  }

 private:
  double normal() {
    const double u = (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53;
    const double v = (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

  Eigen::MatrixXd factor_;
  std::mt19937_64 engine_{5};
};

struct MonteCarlo {
  double mean = 0, standard_deviation = 0;
};

constexpr int n_realizations = 4000;

MonteCarlo sq_by_monte_carlo(const Surface& surface, const Autocorrelation& acf,
                             const Distance& distance) {
  DenseSampler sampler(surface, acf, distance);
  double sum = 0, squares = 0;
  for (int k = 0; k < n_realizations; ++k) {
    const double sq = height_statistics(surface, sampler.heights()).sq;
    sum += sq;
    squares += sq * sq;
  }
  const double mean = sum / n_realizations;
  return {mean, std::sqrt(squares / n_realizations - mean * mean)};
}

// Both estimates within 4.5 standard errors (s / sqrt(n), s / sqrt(2 n) times 1.2 for the kurtosis
// of Sq); `model` is the relative error granted to the chi-square form, times the spread.
void expect_law_of_sq(const Surface& surface, const Autocorrelation& acf, const Distance& distance,
                      double model) {
  const ExpectedSq expected = expected_sq_of(surface, acf, distance);
  const MonteCarlo measured = sq_by_monte_carlo(surface, acf, distance);
  const double spread = measured.standard_deviation;
  EXPECT_NEAR(expected.mean, measured.mean, (4.5 / std::sqrt(n_realizations) + model) * spread);
  EXPECT_NEAR(expected.standard_deviation, spread,
              (4.5 * 1.2 / std::sqrt(2.0 * n_realizations) + model) * spread);
}

}  // namespace

// 1 and -1 on areas A and B have mean (A - B), variance 1 - mean^2 = 4 A B, and the third and
// fourth moments of a two-point law: skewness (B - A)/sqrt(A B), kurtosis 1/(A B) - 3.
TEST(Statistics, TwoValuesHaveTheMomentsOfATwoPointLaw) {
  const Surface surface = graded_plate(6);
  std::vector<double> heights(surface.points.size());
  double a = 0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[i] = i % 3 == 0 ? 1 : -1;
    if (i % 3 == 0) a += surface.areas[i] / surface.area;
  }
  const double b = 1 - a;
  const HeightStatistics statistics = height_statistics(surface, heights);
  EXPECT_NEAR(statistics.mean, a - b, 1e-14);
  EXPECT_NEAR(statistics.sq, 2 * std::sqrt(a * b), 1e-14);
  EXPECT_NEAR(statistics.ssk, (b - a) / std::sqrt(a * b), 1e-13);
  EXPECT_NEAR(statistics.sku, 1 / (a * b) - 3, 1e-13);
  EXPECT_EQ(statistics.sz, 2);
}

TEST(Statistics, ScaleWithTheUnitAndIgnoreAnOffset) {
  const Surface surface = graded_plate(8);
  std::vector<double> heights, scaled;
  for (const Vec3& x : surface.points) heights.push_back(std::sin(7 * x.x()) + x.y() * x.y());
  const HeightStatistics one = height_statistics(surface, heights);
  for (const double unit : {1e-200, 1e-9, 1e9, 1e150}) {
    scaled.clear();
    for (const double z : heights) scaled.push_back(unit * (z + 3));
    const HeightStatistics other = height_statistics(surface, scaled);
    EXPECT_NEAR(other.mean / unit, one.mean + 3, 1e-13);
    EXPECT_NEAR(other.sq / unit, one.sq, 1e-13);
    EXPECT_NEAR(other.sz / unit, one.sz, 1e-13);
    EXPECT_NEAR(other.ssk, one.ssk, 1e-12);
    EXPECT_NEAR(other.sku, one.sku, 1e-12);
  }
}

TEST(Statistics, EqualHeightsHaveNoShape) {
  const Surface surface = test::surface_of(test::plate(2));
  const HeightStatistics statistics =
      height_statistics(surface, std::vector<double>(surface.points.size(), 0.1));
  EXPECT_NEAR(statistics.mean, 0.1, 1e-16);
  EXPECT_EQ(statistics.sq, 0);
  EXPECT_EQ(statistics.ssk, 0);
  EXPECT_EQ(statistics.sku, 0);
}

TEST(Statistics, RefuseHeightsOfAnotherSurface) {
  EXPECT_THROW(height_statistics(test::surface_of(test::plate(2)), std::vector<double>(3)),
               InputError);
}

TEST(Statistics, LawOfSqOnAPlate) {
  expect_law_of_sq(graded_plate(10), Autocorrelation({.length = 0.15}), Distance::euclidean(),
                   0.02);
}

TEST(Statistics, LawOfSqOnASphereByGreatCircleDistance) {
  const Mesh mesh = test::icosphere(2, 3);
  expect_law_of_sq(test::surface_of(mesh),
                   Autocorrelation({.family = Family::exponential, .length = 1.0}),
                   Distance::great_circle(mesh.nodes), 0.02);
}

// m and v as traces of the centred covariance M = (1 - 1 w^T) R (1 - w 1^T) with the weights w: m =
// tr(W M), v = 2 tr(W M W M). On a graded plate with long correlation, where rows differ most.
TEST(Statistics, MomentsAreTracesOfTheCentredCovariance) {
  const Surface surface = graded_plate(12);
  const Autocorrelation acf({.length = 0.4});
  const Index n = surface.n_points();
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd weights(n);
  for (Index i = 0; i < n; ++i) {
    weights[i] = surface.areas[i] / surface.area;
    for (Index j = 0; j < n; ++j)
      matrix(i, j) = acf.rho((surface.points[i] - surface.points[j]).norm());
  }
  const Eigen::MatrixXd centring =
      Eigen::MatrixXd::Identity(n, n) - Eigen::VectorXd::Ones(n) * weights.transpose();
  const Eigen::MatrixXd weighted =
      weights.asDiagonal() * (centring * matrix * centring.transpose()).eval();
  const double m = weighted.trace();
  const double half = m * m / (2 * (weighted * weighted).trace());
  const double mean = std::sqrt(m / half) * std::tgamma(half + 0.5) / std::tgamma(half);
  const ExpectedSq expected = expected_sq_of(surface, acf, Distance::euclidean());
  EXPECT_NEAR(expected.mean, mean, 1e-12);
  EXPECT_NEAR(expected.standard_deviation, std::sqrt(m - mean * mean), 1e-11);
}

// Two to three effective degrees of freedom: here the chi-square form is what an expansion in 1/m
// is not. Granted 5 % of the spread.
TEST(Statistics, LawOfSqUnderStrongCorrelation) {
  const Surface surface = test::surface_of(test::icosphere(2));
  expect_law_of_sq(surface, Autocorrelation({.family = Family::matern, .length = 2, .nu = 1.5}),
                   Distance::euclidean(), 0.05);
}

// White noise on n points of equal area: (n - 1) degrees of freedom. On an octahedron-like even
// sphere areas are equal by symmetry: the 12 points of the icosahedron, chi with 11 degrees.
TEST(Statistics, LawOfSqOfWhiteNoiseIsChi) {
  const Surface surface = test::surface_of(test::icosphere(0));
  const ExpectedSq expected =
      expected_sq_of(surface, Autocorrelation({.length = 1e-6}), Distance::euclidean());
  const double mean_chi = std::sqrt(2.0) * std::tgamma(6.0) / std::tgamma(5.5);
  EXPECT_NEAR(expected.mean, mean_chi / std::sqrt(12), 1e-13);
  EXPECT_NEAR(expected.standard_deviation, std::sqrt((11 - mean_chi * mean_chi) / 12), 1e-13);
}

// 1 - rho keeps its digits: with rho = 1 - r^2/(2 l^2) both figures fall as 1/l.
TEST(Statistics, LawOfSqKeepsItsDigitsWhenAllPointsMoveTogether) {
  const Surface surface = test::surface_of(test::icosphere(1));
  const auto at = [&](double length) {
    return expected_sq_of(surface, Autocorrelation({.length = length}), Distance::euclidean());
  };
  EXPECT_NEAR(at(1e3).mean / at(1e2).mean, 0.1, 1e-4);
  EXPECT_NEAR(at(1e3).standard_deviation / at(1e2).standard_deviation, 0.1, 1e-4);
}

// A sphere above and below the limit of exact sums (2562 and 642 points): the same field on the
// same body, up to h^2/l^2 = 0.02 of the deviation from 1 and to 1/16, the error of 256 samples of
// a quantity that is constant on a sphere but for the mesh.
TEST(Statistics, SampledSumsAgreeWithExactOnes) {
  const Autocorrelation acf({.length = 0.5});
  const ExpectedSq exact =
      expected_sq_of(test::surface_of(test::icosphere(3)), acf, Distance::euclidean());
  const ExpectedSq sampled =
      expected_sq_of(test::surface_of(test::icosphere(4)), acf, Distance::euclidean());
  EXPECT_NEAR(sampled.mean, exact.mean, 0.01 * exact.standard_deviation);
  EXPECT_NEAR(sampled.standard_deviation, exact.standard_deviation,
              0.01 * exact.standard_deviation);
}

// On an open, graded plate rows differ between the middle and the border.
TEST(Statistics, SampledSumsAgreeOnAGradedPlate) {
  const Autocorrelation acf({.family = Family::exponential, .length = 0.2});
  const ExpectedSq exact = expected_sq_of(graded_plate(40), acf, Distance::euclidean());
  const ExpectedSq sampled = expected_sq_of(graded_plate(80), acf, Distance::euclidean());
  EXPECT_NEAR(sampled.mean, exact.mean, 0.1 * exact.standard_deviation);
  EXPECT_NEAR(sampled.standard_deviation, exact.standard_deviation,
              0.05 * exact.standard_deviation);
}

// m and v by all pairs (docs/math.md, eq. 19), for the mean and the spread of Sq.
ExpectedSq by_all_pairs(const Surface& surface, const Correlation& correlation) {
  double mean = 0, squares = 0, square_of_means = 0;
  for (Index i = 0; i < surface.n_points(); ++i) {
    double row = 0, row_of_squares = 0;
    for (Index j = 0; j < surface.n_points(); ++j) {
      const double lost = 1 - correlation(i, j);
      row += surface.areas[j] / surface.area * lost;
      row_of_squares += surface.areas[j] / surface.area * lost * lost;
    }
    mean += surface.areas[i] / surface.area * row;
    squares += surface.areas[i] / surface.area * row_of_squares;
    square_of_means += surface.areas[i] / surface.area * row * row;
  }
  const double half = mean * mean / (2 * (squares - 2 * square_of_means + mean * mean));
  const double ratio = std::exp(std::lgamma(half + 0.5) - std::lgamma(half)) / std::sqrt(half);
  return {std::sqrt(mean) * ratio, std::sqrt(mean * (1 - ratio * ratio))};
}

void expect_all_pairs(const Surface& surface, const AutocorrelationOptions& family,
                      const Distance& distance) {
  const Correlation correlation(surface.points, Autocorrelation(family), distance);
  const ExpectedSq exact = by_all_pairs(surface, correlation);
  const ExpectedSq sampled = expected_sq(surface, correlation);
  const double tolerance = 0.01 * exact.standard_deviation;
  EXPECT_NEAR(sampled.mean, exact.mean, tolerance);
  EXPECT_NEAR(sampled.standard_deviation, exact.standard_deviation, tolerance);
}

// 256 sources, and far points in groups, leave 1 % of the spread: for families with and without
// heavy tails, lengths from the mesh size to the size of the surface, other distances, and a plate
// of 64 x 64 nodes, on which strata of equal area are columns or squares.
TEST(Statistics, SourcesAndGroupsOfFarPointsStandForAllPairs) {
  for (const Surface& surface : {test::surface_of(test::plate(45)), graded_plate(45)})
    for (const double length : {0.05, 1.0}) {
      const Distance distance = Distance::euclidean();
      expect_all_pairs(surface, {.length = length}, distance);
      expect_all_pairs(surface, {.family = Family::exponential, .length = length}, distance);
      expect_all_pairs(surface, {.family = Family::stretched, .length = length, .power = 0.5},
                       distance);
      expect_all_pairs(surface,
                       {.family = Family::rational_quadratic, .length = length, .alpha = 0.6},
                       distance);
    }
  const Surface surface = graded_plate(45);
  expect_all_pairs(surface, {.length = 0.1}, Distance::stretched({.lengths = {0.1, 0.03, 0.2}}));
  expect_all_pairs(surface, {.length = 0.1}, Distance::periodic({1, 1, 0}));
  expect_all_pairs(test::surface_of(test::plate(63)), {.length = 0.05}, Distance::euclidean());
}

TEST(Statistics, LawOfSqIsTheSameOnAnyNumberOfThreads) {
  const Surface surface = test::surface_of(test::icosphere(4));
  const Autocorrelation acf({.length = 0.3});
  const auto with_threads = [&](int n) {
    const detail::ThreadLimit limit(n);
    return expected_sq_of(surface, acf, Distance::euclidean());
  };
  EXPECT_EQ(with_threads(1).mean, with_threads(2).mean);
  EXPECT_EQ(with_threads(1).standard_deviation, with_threads(2).standard_deviation);
}
