// SPDX-License-Identifier: BSD-3-Clause
// Fields by every kind of distance and by tables have the covariance that was asked for.
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "roughmesh/curve.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/periodic.hpp"

#include "support/curves.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh {
namespace {

/// The method that takes any of them.
const FieldOptions by_cholesky{.method = Method::cholesky};

/// n points of the unit square, spread by the roots of x^3 = x + 1.
std::vector<Vec3> spread_points(int n) {
  const double g = 1.32471795724474602596;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(std::fmod(i / g, 1.0), std::fmod(i / g / g, 1.0),
                        0.1 * std::sin(2 * std::numbers::pi * std::fmod(i / g, 1.0)));
  return test::sorted(std::move(points));
}

Eigen::MatrixXd matrix_of(const Correlation& correlation) {
  const Index n = correlation.n_points();
  Eigen::MatrixXd matrix(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) matrix(i, j) = correlation(i, j);
  return matrix;
}

/// The law of eq. 22: eigenvalues below 0 set to 0.
Eigen::MatrixXd clipped(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
         solver.eigenvectors().transpose();
}

// Isserlis: Var[d_i d_j] = c_ii c_jj + c_ij^2, so the sample covariance of n realizations has the
// standard error sqrt((c_ii c_jj + c_ij^2) / n). Six of them: p < 2e-9 for each of 20,100 pairs.
void expect_sample_covariance(const FieldSampler& sampler, const Eigen::MatrixXd& expected) {
  constexpr int n_realizations = 4000;
  const auto n = static_cast<int>(expected.rows());
  Eigen::MatrixXd heights(n, n_realizations);
  for (int realization = 0; realization < n_realizations; ++realization) {
    const std::vector<double> d = sampler.heights(2021, static_cast<std::uint64_t>(realization));
    heights.col(realization) = Eigen::Map<const Eigen::VectorXd>(d.data(), n);
  }
  const Eigen::MatrixXd covariance = heights * heights.transpose() / n_realizations;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      const double c = expected(i, j);
      const double error = std::sqrt((expected(i, i) * expected(j, j) + c * c) / n_realizations);
      ASSERT_NEAR(covariance(i, j), c, 6 * error) << i << ", " << j;
    }
}

void expect_exact_field(const Correlation& correlation) {
  const FieldSampler sampler(correlation, by_cholesky);
  EXPECT_NE(sampler.summary().cholesky->factorization, Factorization::eigenvalue);
  EXPECT_LT(sampler.audit().covariance_error, 2e-8);
  expect_sample_covariance(sampler, matrix_of(correlation));
}

TEST(FieldByDistance, PeriodicHasTheSumOverImages) {
  const std::vector<Vec3> points = spread_points(200);
  const Vec3 period(1, 1, 0);
  expect_exact_field({points, Autocorrelation({.family = Family::exponential, .length = 0.3}),
                      Distance::periodic(period)});
  expect_exact_field({points, Autocorrelation({.length = 0.3}), Distance::periodic(period)});
}

TEST(FieldByDistance, AnisotropicHasItsLengths) {
  const std::vector<Vec3> points = spread_points(200);
  Anisotropy anisotropy{.lengths = {0.5, 0.1, 0.3}};
  const Autocorrelation exponential({.family = Family::exponential, .length = 0.5});
  expect_exact_field({points, exponential, Distance::periodic(Vec3(1, 1, 0), anisotropy)});
  anisotropy.axes = Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix();
  expect_exact_field({points, exponential, Distance::stretched(anisotropy)});
}

// Of the nearest image alone a Gaussian of half the period is far from positive definite. The
// smoothing of eq. 22 changes the law by less than 1e-10.
TEST(FieldByDistance, MinimumImageHasTheClippedLaw) {
  const std::vector<Vec3> points = spread_points(200);
  const Correlation wide(points, Autocorrelation({.length = 0.4}),
                         Distance::minimum_image(Vec3(1, 1, 0)));
  const FieldSampler sampler(wide, by_cholesky);
  EXPECT_EQ(sampler.summary().cholesky->factorization, Factorization::eigenvalue);
  EXPECT_GT(sampler.summary().cholesky->negative_eigenvalues, 0);
  const Eigen::MatrixXd law = clipped(matrix_of(wide));
  for (Index i = 0; i < 200; i += 7)
    for (Index j = 0; j < 200; j += 3) EXPECT_NEAR(sampler.covariance(i, j), law(i, j), 1e-9);
  expect_sample_covariance(sampler, law);
  EXPECT_NEAR(sampler.audit().covariance_error, (law - matrix_of(wide)).cwiseAbs().maxCoeff(),
              2e-2 * sampler.audit().covariance_error);

  // A short exponential is definite on the torus too.
  expect_exact_field({points, Autocorrelation({.family = Family::exponential, .length = 0.1}),
                      Distance::minimum_image(Vec3(1, 1, 0))});
}

TEST(FieldByDistance, CurveHasTheArcLength) {
  const Autocorrelation exponential({.family = Family::exponential, .length = 0.8});
  const Surface closed = test::circle(200, 1.0);
  const CurvePlaces around = curve_places(closed);
  expect_exact_field({around.places, exponential, Distance::curve(around.closed_lengths)});

  std::vector<Vec3> points;
  std::vector<std::pair<Index, Index>> lines;
  for (Index i = 0; i < 200; ++i) {
    points.emplace_back(0.03 * i, 0.2 * std::sin(0.3 * i), 0);
    if (i > 0 && i != 120) lines.emplace_back(i - 1, i);  // two open pieces
  }
  const CurvePlaces along = curve_places(test::curve_of(points, lines));
  ASSERT_EQ(along.lengths.size(), 2u);
  expect_exact_field({along.places, exponential, Distance::curve(along.closed_lengths)});
}

// A Gaussian of the shorter way round is indefinite, as the paper's closed line.
TEST(FieldByDistance, GaussianOnAClosedCurveHasTheClippedLaw) {
  const Surface closed = test::circle(200, 1.0);
  const CurvePlaces around = curve_places(closed);
  const Correlation correlation(around.places, Autocorrelation({.length = 1.0}),
                                Distance::curve(around.closed_lengths));
  const FieldSampler sampler(correlation, by_cholesky);
  EXPECT_EQ(sampler.summary().cholesky->factorization, Factorization::eigenvalue);
  expect_sample_covariance(sampler, clipped(matrix_of(correlation)));
}

TEST(FieldByDistance, TableHasItsFitOrItsInterpolant) {
  const std::vector<Vec3> points = spread_points(200);
  std::vector<CorrelationPair> decay, oscillation;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.03 * i;
    decay.push_back({r, std::exp(-r / 0.3)});
    oscillation.push_back({r, std::exp(-r / 0.3) * std::cos(r / 0.1)});
  }
  const Autocorrelation fit({.family = Family::table, .table = decay});
  ASSERT_LE(*fit.fit_residual(), 0.02);
  expect_exact_field({points, fit, Distance::euclidean()});
  expect_exact_field({points, fit, Distance::periodic(Vec3(1, 1, 0))});

  const Autocorrelation interpolant({.family = Family::table, .table = oscillation});
  ASSERT_GT(*interpolant.fit_residual(), 0.02);
  const Correlation correlation(points, interpolant, Distance::euclidean());
  const FieldSampler sampler(correlation, by_cholesky);
  const Eigen::MatrixXd matrix = matrix_of(correlation);
  expect_sample_covariance(sampler,
                           sampler.summary().cholesky->factorization == Factorization::eigenvalue
                               ? clipped(matrix)
                               : matrix);
  EXPECT_THROW(Correlation(points, interpolant, Distance::periodic(Vec3(1, 1, 0))), InputError);
  EXPECT_NO_THROW(Correlation(points, interpolant, Distance::minimum_image(Vec3(1, 1, 0))));
}

// One sampler of the masters gives every point the height of its images.
TEST(FieldByDistance, PartnersHaveOneHeight) {
  const Mesh mesh = test::plate(12);
  const Surface surface = select_surface(mesh);
  const Vec3 period(1, 1, 0);
  const PeriodicPartners partners = periodic_partners(mesh, surface, period);
  const Correlation all(surface.points, Autocorrelation({.length = 0.2}),
                        Distance::periodic(period));
  const FieldSampler sampler(all.among(masters(partners)), by_cholesky);
  ASSERT_TRUE(sampler.summary().minimum_image_difference);
  EXPECT_GT(*sampler.summary().minimum_image_difference, 0);
  const std::vector<double> heights = expand(partners, sampler.heights(1, 0));
  for (std::size_t i = 0; i < heights.size(); ++i)
    for (std::size_t j = 0; j < heights.size(); ++j)
      if (all(static_cast<Index>(i), static_cast<Index>(j)) > 1 - 1e-12) {
        EXPECT_EQ(heights[i], heights[j]);
      }
}

}  // namespace
}  // namespace roughmesh
