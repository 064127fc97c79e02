// SPDX-License-Identifier: BSD-3-Clause
// L L^T is R for every family and distance; the factorization is chosen by R, not by round-off.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "audit.hpp"
#include "field_cholesky.hpp"
#include "parallel.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh::detail {
namespace {

using test::largest_difference;
using test::mesh_size_of_sphere;

std::vector<Vec3> sphere_points(int subdivisions) {
  return test::sorted(test::icosphere(subdivisions).nodes);
}

AutocorrelationOptions options(Family family, double length, double shape = 0) {
  AutocorrelationOptions result{.family = family, .length = length};
  if (family == Family::matern) result.nu = shape;
  if (family == Family::self_affine) result.hurst = shape;
  if (family == Family::stretched) result.power = shape;
  if (family == Family::rational_quadratic) result.alpha = shape;
  return result;
}

/// Largest |L L^T - R| over all pairs and the diagonal.
double largest_error(const Factor& factor, const std::vector<Vec3>& points,
                     const Autocorrelation& autocorrelation, const Distance& distance) {
  std::vector<PointPair> pairs;
  for (Index i = 0; i < static_cast<Index>(points.size()); ++i)
    for (Index j = 0; j <= i; ++j) pairs.emplace_back(i, j);
  const std::vector<double> covariances = factor.covariances(pairs);
  double largest = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const auto [i, j] = pairs[p];
    const double rho = autocorrelation.rho(distance(points[i], points[j]));
    largest = std::max(largest, std::abs(covariances[p] - rho));
  }
  return largest;
}

/// The same matrix with every entry moved to a neighbouring number, or left, at random: relative
/// noise of at most 2.2e-16.
AutocorrelationMatrix with_round_off(const AutocorrelationMatrix& matrix, std::uint64_t seed) {
  return {matrix.n, [=](std::size_t j, std::span<double> below) {
            matrix.write_below_diagonal(j, below);
            for (std::size_t i = 0; i < below.size(); ++i) {
              const std::uint64_t word = random_words({seed, j}, {i, 0, 0, 0})[0] % 3;
              if (word > 0) below[i] = std::nextafter(below[i], word == 1 ? 0.0 : 1.0);
            }
          }};
}

CholeskyField prepared(const std::vector<Vec3>& points, const Autocorrelation& autocorrelation,
                       const Distance& distance) {
  const Correlation correlation(points, autocorrelation, distance);
  return factorize_correlation(autocorrelation_matrix(correlation));
}

struct Case {
  std::string name;
  AutocorrelationOptions autocorrelation;
  DistanceKind distance;
  Factorization factorization;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class EveryFamily : public testing::TestWithParam<Case> {};

// Semidefinite: 1e-8 from where the factorization stops, 1e-10 from the separation of ties, and
// 1e-13 of round-off, so 2e-8 bounds it with room; definite: round-off alone, n eps = 1.4e-13.
TEST_P(EveryFamily, FactorMultipliesBackToTheAutocorrelation) {
  const std::vector<Vec3> points = sphere_points(3);
  const Autocorrelation autocorrelation(GetParam().autocorrelation);
  const Distance distance = GetParam().distance == DistanceKind::euclidean
                                ? Distance::euclidean()
                                : Distance::great_circle(points);
  const CholeskyField field = prepared(points, autocorrelation, distance);
  EXPECT_EQ(field.summary.factorization, GetParam().factorization)
      << name(field.summary.factorization);
  EXPECT_EQ(field.summary.rank, static_cast<Index>(field.factor.rank()));
  EXPECT_EQ(field.summary.negative_eigenvalues, 0);
  EXPECT_EQ(field.summary.variance_change, 0);
  EXPECT_FALSE(field.summary.smallest_eigenvalue);
  const bool is_definite = field.summary.factorization == Factorization::cholesky;
  EXPECT_LT(largest_error(field.factor, points, autocorrelation, distance),
            is_definite ? 1e-12 : 2e-8);
}

std::vector<Case> every_family() {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, Family family, double shape, double length,
                       DistanceKind distance, Factorization factorization) {
    cases.push_back({name + (distance == DistanceKind::euclidean ? "_euclidean" : "_great_circle") +
                         (factorization == Factorization::cholesky ? "_definite" : "_semidefinite"),
                     options(family, length, shape), distance, factorization});
  };
  constexpr auto plain = Factorization::cholesky, pivoted = Factorization::pivoted_cholesky;
  for (const DistanceKind distance : {DistanceKind::euclidean, DistanceKind::great_circle}) {
    add("gaussian", Family::gaussian, 0, 0.15, distance, plain);
    add("gaussian", Family::gaussian, 0, 0.4, distance, pivoted);
    add("exponential", Family::exponential, 0, 0.4, distance, plain);
    add("matern_0_8", Family::matern, 0.8, 0.4, distance, plain);
    add("matern_2_5", Family::matern, 2.5, 0.2, distance, plain);
    add("self_affine", Family::self_affine, 0.8, 0.4, distance, plain);
    add("stretched", Family::stretched, 1.4, 0.4, distance, plain);
    add("rational_quadratic", Family::rational_quadratic, 1.5, 0.1, distance, plain);
  }
  add("matern_2_5", Family::matern, 2.5, 2.0, DistanceKind::euclidean, pivoted);
  add("rational_quadratic", Family::rational_quadratic, 1.5, 0.6, DistanceKind::euclidean, pivoted);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Sphere, EveryFamily, testing::ValuesIn(every_family()),
                         [](const auto& each) { return each.param.name; });

// Correlations across the whole sphere that a function of the great-circle distance cannot have:
// exp(-theta^2 / 2) has Legendre coefficients below zero.
TEST(CholeskyMethod, IndefiniteMatrixTakesTheEigenvalues) {
  const std::vector<Vec3> points = sphere_points(3);
  const Autocorrelation autocorrelation(options(Family::gaussian, 1.0));
  const Distance distance = Distance::great_circle(points);
  const CholeskyField field = prepared(points, autocorrelation, distance);
  const CholeskySummary& summary = field.summary;
  EXPECT_EQ(summary.factorization, Factorization::eigenvalue);
  EXPECT_GT(summary.negative_eigenvalues, 0);
  EXPECT_GT(summary.rank, 0);
  EXPECT_LE(summary.rank + summary.negative_eigenvalues, static_cast<Index>(points.size()));
  ASSERT_TRUE(summary.smallest_eigenvalue);
  EXPECT_LT(*summary.smallest_eigenvalue, -1e-8);
  // Opposite points are pi apart.
  EXPECT_NEAR(summary.smallest_correlation, std::exp(-0.5 * std::numbers::pi * std::numbers::pi),
              1e-12);
  // Clipping adds to each variance; together the variances grow by the sum of what was clipped,
  // which n_negative * |smallest| bounds.
  EXPECT_GT(summary.variance_change, 0);
  EXPECT_LT(summary.variance_change, summary.negative_eigenvalues * -*summary.smallest_eigenvalue);
  // |A A^T - R| is at most its spectral norm: the largest clipped eigenvalue, or the smoothing.
  EXPECT_LT(largest_error(field.factor, points, autocorrelation, distance),
            -*summary.smallest_eigenvalue + 1e-9);
  EXPECT_GE(largest_error(field.factor, points, autocorrelation, distance),
            summary.variance_change - 1e-12);
}

// Around the ratio at which the great-circle matrix turns indefinite, whichever way the decision
// falls: a Cholesky factor is R to 2e-8, or the eigenvalues say by how much it is not.
TEST(CholeskyMethod, NothingIsHalfWayNearTheIndefinite) {
  const std::vector<Vec3> points = sphere_points(2);
  const Distance distance = Distance::great_circle(points);
  int n_eigenvalue = 0, n_pivoted = 0;
  for (double length = 0.3; length < 1.0; length += 0.02) {
    const Autocorrelation autocorrelation(options(Family::gaussian, length));
    const Correlation correlation(points, autocorrelation, distance);
    const AutocorrelationMatrix matrix = autocorrelation_matrix(correlation);
    const CholeskyField field = factorize_correlation(matrix);
    const double error = largest_error(field.factor, points, autocorrelation, distance);
    if (field.summary.factorization == Factorization::eigenvalue) {
      ++n_eigenvalue;
      EXPECT_LT(error, -*field.summary.smallest_eigenvalue + 1e-9) << length;
    } else {
      ++n_pivoted;
      EXPECT_LT(error, 2e-8) << length;
    }
    const CholeskyField again = factorize_correlation(with_round_off(matrix, 1));
    EXPECT_EQ(again.summary.factorization, field.summary.factorization) << length;
    EXPECT_EQ(again.summary.rank, field.summary.rank) << length;
    EXPECT_LT(largest_difference(field.factor.heights({0, 0}), again.factor.heights({0, 0})), 1e-8)
        << length;
  }
  EXPECT_GT(n_eigenvalue, 3);
  EXPECT_GT(n_pivoted, 3);
}

/// Largest change of a height by round-off in R, over some realizations.
double sensitivity(const AutocorrelationMatrix& matrix, Factorization expected) {
  const CholeskyField field = factorize_correlation(matrix);
  EXPECT_EQ(field.summary.factorization, expected) << name(field.summary.factorization);
  double largest = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const CholeskyField other = factorize_correlation(with_round_off(matrix, seed));
    EXPECT_EQ(other.summary.factorization, expected);
    for (std::uint64_t realization = 0; realization < 3; ++realization)
      largest = std::max(largest, largest_difference(field.factor.heights({0, realization}),
                                                     other.factor.heights({0, realization})));
  }
  return largest;
}

// Promise: heights move by less than 1e-8 under round-off of 1e-16. The icosphere has 120
// symmetries, so nearly every pivot is tied.
TEST(CholeskyMethod, RoundOffDoesNotMoveTheHeights) {
  const std::vector<Vec3> points = sphere_points(3);
  const double h = mesh_size_of_sphere(points.size(), 1.0);
  for (const double ratio : {2.5, 3.0, 3.5, 4.0, 5.0}) {
    const Autocorrelation autocorrelation(options(Family::gaussian, ratio * h));
    const Distance distance = Distance::euclidean();
    EXPECT_LT(sensitivity(autocorrelation_matrix(Correlation(points, autocorrelation, distance)),
                          Factorization::pivoted_cholesky),
              1e-8)
        << "l/h = " << ratio;
  }
}

TEST(CholeskyMethod, RoundOffDoesNotMoveTheHeightsOfALargerSphere) {
  const std::vector<Vec3> points = sphere_points(4);
  const double h = mesh_size_of_sphere(points.size(), 1.0);
  const Autocorrelation autocorrelation(options(Family::gaussian, 3.4 * h));
  const Distance distance = Distance::euclidean();
  EXPECT_LT(sensitivity(autocorrelation_matrix(Correlation(points, autocorrelation, distance)),
                        Factorization::pivoted_cholesky),
            1e-8);
}

TEST(CholeskyMethod, RoundOffDoesNotMoveTheHeightsOfADefiniteMatrix) {
  const std::vector<Vec3> points = sphere_points(3);
  const Autocorrelation autocorrelation(options(Family::exponential, 0.4));
  const Distance distance = Distance::euclidean();
  EXPECT_LT(sensitivity(autocorrelation_matrix(Correlation(points, autocorrelation, distance)),
                        Factorization::cholesky),
            1e-8);
}

// Spherical harmonics of one degree share one eigenvalue, split only by the mesh; the eigenvectors
// are arbitrary within such a group, the heights are not.
TEST(CholeskyMethod, MultipleEigenvaluesDoNotMoveTheHeights) {
  const std::vector<Vec3> points = sphere_points(3);
  const Autocorrelation autocorrelation(options(Family::gaussian, 1.0));
  const Distance distance = Distance::great_circle(points);
  EXPECT_LT(sensitivity(autocorrelation_matrix(Correlation(points, autocorrelation, distance)),
                        Factorization::eigenvalue),
            1e-8);
}

// Four copies of each point make three quarters of the eigenvalues 0, which round-off moves by
// 1e-15. Their square roots would move by 3e-8; f, whose slope is at most 1e5, moves by 1e-10.
TEST(CholeskyMethod, VanishingEigenvaluesDoNotMoveTheHeights) {
  const std::vector<Vec3> points = sphere_points(2);
  const Autocorrelation autocorrelation(options(Family::gaussian, 1.0));
  const Distance distance = Distance::great_circle(points);
  const std::size_t n = points.size();
  const AutocorrelationMatrix copies{
      4 * n, [&](std::size_t j, std::span<double> below) {
        for (std::size_t i = 0; i < below.size(); ++i)
          below[i] = autocorrelation.rho(distance(points[(j + 1 + i) % n], points[j % n]));
      }};
  EXPECT_LT(sensitivity(copies, Factorization::eigenvalue), 1e-8);
}

// The same points turned: R is the same but for round-off, and so are the heights.
TEST(CholeskyMethod, ARotationMovesTheHeightsByRoundOffOnly) {
  const std::vector<Vec3> points = sphere_points(3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> turned = points;
  for (Vec3& x : turned) x = turn * x;
  const Distance distance = Distance::great_circle(Sphere{Vec3::Zero(), 1.0, 0.0});
  for (const double length : {0.15, 0.45, 1.0}) {
    const Autocorrelation autocorrelation(options(Family::gaussian, length));
    const auto heights = [&](const std::vector<Vec3>& x) {
      return prepared(x, autocorrelation, distance).factor.heights({1, 2});
    };
    EXPECT_LT(largest_difference(heights(points), heights(turned)), 1e-8) << length;
  }
}

// Duplicate rows leave a matrix of rank 10 whatever its size: the factor keeps ten columns.
TEST(CholeskyMethod, KeepsOnlyTheRank) {
  const AutocorrelationMatrix matrix{300, [](std::size_t, std::span<double> below) {
                                       for (std::size_t i = 0; i < below.size(); ++i)
                                         below[i] = (i + 1) % 10 == 0 ? 1.0 : 0.0;
                                     }};
  const CholeskyField field = factorize_correlation(matrix);
  EXPECT_EQ(field.summary.rank, 10);
  const std::vector<double> heights = field.factor.heights({0, 0});
  // Points that correlate fully get one height, to the separation of ties of 1e-10.
  for (std::size_t i = 10; i < heights.size(); ++i)
    EXPECT_NEAR(heights[i], heights[i % 10], 1e-9 * 6);
}

TEST(CholeskyMethod, AMatrixThatIsNotOneIsANumericalError) {
  const AutocorrelationMatrix matrix{20, [](std::size_t, std::span<double> below) {
                                       for (double& r : below)
                                         r = std::numeric_limits<double>::quiet_NaN();
                                     }};
  EXPECT_THROW(factorize_correlation(matrix), NumericalError);
}

}  // namespace
}  // namespace roughmesh::detail
