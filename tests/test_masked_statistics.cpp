// SPDX-License-Identifier: BSD-3-Clause
// Height parameters over a part of a surface, and the law of Sq of a masked field.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "roughmesh/mask.hpp"
#include "roughmesh/statistics.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

Correlation correlation_of(const Surface& surface, const Autocorrelation& acf) {
  return {surface.points, acf, Distance::euclidean()};
}

// Plate whose squares grow along x: node areas differ by a factor of 20.
struct GradedPlate {
  Mesh mesh;
  Surface surface;

  explicit GradedPlate(int divisions) : mesh(test::plate(divisions)) {
    for (Vec3& x : mesh.nodes) x.x() *= x.x();
    surface = select_surface(mesh);
  }
  std::vector<double> faded(double width) const {
    return mask_weights(mesh, surface, {.fade = {{.width = width}}});
  }
};

Eigen::MatrixXd correlations(const Surface& surface, const Autocorrelation& acf) {
  const Index n = surface.n_points();
  Eigen::MatrixXd matrix(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      matrix(i, j) = acf.rho((surface.points[i] - surface.points[j]).norm());
  return matrix;
}

// Box's form of mean m and variance v (docs/math.md, eq. 19 and 20), by the gamma function itself.
ExpectedSq by_box(double m, double v) {
  const double half = m * m / v;
  const double mean = std::sqrt(m / half) * std::exp(std::lgamma(half + 0.5) - std::lgamma(half));
  return {mean, std::sqrt(m - mean * mean)};
}

// m = tr(W M), v = 2 tr(W M W M) with the centred covariance M of the masked field.
ExpectedSq by_traces(const Surface& surface, const Autocorrelation& acf,
                     const std::vector<double>& weights, const std::vector<double>& areas) {
  const auto as_vector = [](const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  const Eigen::VectorXd mask = as_vector(weights),
                        share = as_vector(areas) / as_vector(areas).sum();
  const Eigen::MatrixXd covariance =
      mask.asDiagonal() * correlations(surface, acf) * mask.asDiagonal();
  const Eigen::VectorXd column_means = covariance * share;
  const double mean = share.dot(column_means);
  Eigen::MatrixXd weighted = covariance;
  weighted.colwise() -= column_means;
  weighted.rowwise() -= column_means.transpose();
  weighted.array() += mean;
  weighted = (share.asDiagonal() * weighted).eval();
  return by_box(weighted.trace(), 2 * weighted.cwiseProduct(weighted.transpose()).sum());
}

class DenseSampler {
 public:
  DenseSampler(const Surface& surface, const Autocorrelation& acf) {
    Eigen::MatrixXd matrix = correlations(surface, acf);
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

// 4.5 standard errors of the mean, s / sqrt(n), and of the spread, s / sqrt(2 n) times 1.2 for the
// kurtosis of Sq; and 2 % of the spread granted to the chi-square form.
void expect_law_of_sq(const GradedPlate& plate, const std::vector<double>& weights,
                      const std::vector<double>& areas) {
  constexpr int n = 4000;
  const Autocorrelation acf({.length = 0.12});
  DenseSampler sampler(plate.surface, acf);
  double sum = 0, squares = 0;
  for (int k = 0; k < n; ++k) {
    std::vector<double> z = sampler.heights();
    for (std::size_t i = 0; i < z.size(); ++i) z[i] *= weights[i];
    const double sq = height_statistics(plate.surface, z, areas).sq;
    sum += sq;
    squares += sq * sq;
  }
  const double mean = sum / n, spread = std::sqrt(squares / n - mean * mean);
  const ExpectedSq expected = expected_sq(plate.surface, correlation_of(plate.surface, acf),
                                          {.weights = weights, .areas = areas});
  EXPECT_NEAR(expected.mean, mean, (4.5 / std::sqrt(n) + 0.02) * spread);
  EXPECT_NEAR(expected.standard_deviation, spread,
              (4.5 * 1.2 / std::sqrt(2.0 * n) + 0.02) * spread);
}

}  // namespace

TEST(MaskedStatistics, LawOfSqOfAFadedField) {
  const GradedPlate plate(12);
  expect_law_of_sq(plate, plate.faded(0.3), {});
}

TEST(MaskedStatistics, LawOfSqOutsideTheFadedBand) {
  const GradedPlate plate(12);
  const std::vector<double> weights = plate.faded(0.15);
  expect_law_of_sq(plate, weights, full_weight_areas(plate.surface, weights));
}

TEST(MaskedStatistics, MomentsAreTracesOfTheCentredCovariance) {
  const GradedPlate plate(12);
  const std::vector<double> weights = plate.faded(0.25);
  const std::vector<double> areas = full_weight_areas(plate.surface, weights);
  for (const double length : {0.05, 0.4}) {
    const Autocorrelation acf({.length = length});
    const ExpectedSq all = by_traces(plate.surface, acf, weights, plate.surface.areas);
    const ExpectedSq inner = by_traces(plate.surface, acf, weights, areas);
    const ExpectedSq of_all =
        expected_sq(plate.surface, correlation_of(plate.surface, acf), {.weights = weights});
    const ExpectedSq of_inner = expected_sq(plate.surface, correlation_of(plate.surface, acf),
                                            {.weights = weights, .areas = areas});
    EXPECT_NEAR(of_all.mean, all.mean, 1e-12);
    EXPECT_NEAR(of_all.standard_deviation, all.standard_deviation, 1e-11);
    EXPECT_NEAR(of_inner.mean, inner.mean, 1e-12);
    EXPECT_NEAR(of_inner.standard_deviation, inner.standard_deviation, 1e-11);
  }
}

// 2,562 points, above the limit of exact sums. Strata of equal weight leave 1 % of the spread, also
// where 159 or 12 points move at all, where only some do, and where no two weights are equal.
TEST(MaskedStatistics, SampledSumsAgreeWithExactOnes) {
  const Mesh mesh = test::icosphere(4);
  const Surface surface = select_surface(mesh);
  const std::vector<double>& areas = surface.areas;
  struct Spot {
    double radius, fade, length;
  };
  for (const auto& [radius, fade, length] :
       std::vector<Spot>{{0.3, 0.2, 0.1}, {0.1, 0.05, 1.0}, {1, 0.5, 0.1}, {0.01, 2.1, 0.1}}) {
    const std::vector<double> weights =
        mask_weights(mesh, surface, {.spheres = {{{0.6, 0, 0.8}, radius, fade}}});
    const Autocorrelation acf({.length = length});
    const ExpectedSq exact = by_traces(surface, acf, weights, areas);
    const ExpectedSq sampled =
        expected_sq(surface, correlation_of(surface, acf), {.weights = weights});
    const double tolerance = 0.01 * exact.standard_deviation;
    EXPECT_NEAR(sampled.mean, exact.mean, tolerance) << radius;
    EXPECT_NEAR(sampled.standard_deviation, exact.standard_deviation, tolerance) << radius;
  }
}

TEST(MaskedStatistics, WeightsOfOneAndAllAreasChangeNothing) {
  const GradedPlate plate(10);
  const std::vector<double> ones(plate.surface.points.size(), 1.0);
  const Autocorrelation acf({.length = 0.2});
  const ExpectedSq plain = expected_sq(plate.surface, correlation_of(plate.surface, acf));
  const ExpectedSq masked = expected_sq(plate.surface, correlation_of(plate.surface, acf),
                                        {.weights = ones, .areas = plate.surface.areas});
  EXPECT_NEAR(masked.mean, plain.mean, 1e-14);
  EXPECT_NEAR(masked.standard_deviation, plain.standard_deviation, 1e-14);
  const std::vector<double> zeros(ones.size(), 0.0);
  EXPECT_EQ(expected_sq(plate.surface, correlation_of(plate.surface, acf), {.weights = zeros}).mean,
            0);
}

// Heights that are wild where the area is 0 leave no trace.
TEST(MaskedStatistics, PointsWithoutAreaDoNotCount) {
  const GradedPlate plate(8);
  std::vector<double> areas = plate.surface.areas, heights(areas.size());
  double a = 0, b = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (i % 5 == 0) areas[i] = 0;
    heights[i] = i % 5 == 0 ? 1e9 : i % 2 == 0 ? 1 : -1;
    (i % 2 == 0 ? a : b) += areas[i];
  }
  const HeightStatistics statistics = height_statistics(plate.surface, heights, areas);
  const double p = a / (a + b);  // a two-point law
  EXPECT_NEAR(statistics.mean, 2 * p - 1, 1e-14);
  EXPECT_NEAR(statistics.sq, 2 * std::sqrt(p * (1 - p)), 1e-14);
  EXPECT_NEAR(statistics.ssk, (1 - 2 * p) / std::sqrt(p * (1 - p)), 1e-13);
  EXPECT_EQ(statistics.sz, 2);
}

TEST(MaskedStatistics, AreasAndWeightsOutOfRangeAreRefused) {
  const GradedPlate plate(4);
  const std::size_t n = plate.surface.points.size();
  const std::vector<double> heights(n, 1.0);
  const Autocorrelation acf({.length = 0.2});
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, infinity, std::nan("")}) {
    std::vector<double> values(n, 0.5);
    values[3] = bad;
    EXPECT_THROW(height_statistics(plate.surface, heights, values), InputError);
    EXPECT_THROW(
        expected_sq(plate.surface, correlation_of(plate.surface, acf), {.weights = values}),
        InputError);
  }
  for (const std::vector<double>& areas : {std::vector<double>(n, 0.0), std::vector<double>(3, 1.)})
    EXPECT_THROW(height_statistics(plate.surface, heights, areas), InputError);
}
