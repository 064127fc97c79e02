// SPDX-License-Identifier: BSD-3-Clause
// Levels that are summed over cells have the covariance of their Gaussians, and heights that are
// the products of the audited rows with the noise.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lattice_coarse.hpp"

namespace roughmesh::detail {
namespace {

constexpr double error = 1e-5;

/// Places in a box that holds several cells of edge 1 on either side of 0.
std::vector<Vec3> random_places(std::size_t n, double size) {
  std::mt19937_64 generator(1);  // NOLINT(cert-msc51-cpp): the same places in every run
  std::uniform_real_distribution<double> coordinate(-size, size);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < n; ++i)
    places.emplace_back(coordinate(generator), coordinate(generator), coordinate(generator));
  return places;
}

CoarseLevels levels_of(const std::vector<MixtureTerm>& terms, const LatticeSpace& space) {
  return {make_levels(terms, space, error, 0), space, 1.0, 10, error};
}

class CoarseScale : public ::testing::TestWithParam<double> {};

TEST_P(CoarseScale, HasTheCovarianceOfItsGaussian) {
  const double scale = GetParam();
  const LatticeSpace space(Distance::euclidean(), 3);
  const CoarseLevels levels = levels_of({{0, scale, 1.0}}, space);
  const std::vector<Vec3> x = random_places(200, 5);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 y = x[i] + 0.3 * scale * x[(7 * i + 1) % x.size()];
    const double r = (x[i] - y).norm() / scale;
    // Kernels and polynomials add at most `error` each.
    EXPECT_NEAR(levels.covariance(x[i], y), std::exp(-r * r / 2), 2 * error);
    EXPECT_NEAR(levels.covariance(x[i], x[i]), 1, 2 * error);
  }
}

// Edges of cells are powers of 2: scales at, just below and between them, and beyond all stages.
INSTANTIATE_TEST_SUITE_P(Scales, CoarseScale, ::testing::Values(1.0, 1.9999, 2.5, 8.0, 5000.0));

// Heights are linear in the noise, so that the mean product of two over R realizations is their
// covariance within sqrt((1 + C^2) / R) standard errors.
TEST(CoarseLevels, DrawsWhatIsAudited) {
  constexpr int n_realizations = 2000;
  const LatticeSpace space(Distance::euclidean(), 3);
  const CoarseLevels levels = levels_of({{0, 1.5, 0.5}, {1, 3.0, 0.3}, {2, 20.0, 0.2}}, space);
  const std::vector<Vec3> points = random_places(12, 3);
  const SortedPlaces places(points, 1.0);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(12, 12);
  for (std::uint64_t k = 0; k < n_realizations; ++k) {
    Eigen::VectorXd heights = Eigen::VectorXd::Zero(12);
    levels.add({3, k}, places, {heights.data(), 12});
    sum += heights * heights.transpose();
  }
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j <= i; ++j) {
      const double c = levels.covariance(points[static_cast<std::size_t>(i)],
                                         points[static_cast<std::size_t>(j)]);
      EXPECT_NEAR(sum(i, j) / n_realizations, c, 5 * std::sqrt((1 + c * c) / n_realizations));
    }
}

TEST(CoarseLevels, AreAFunctionOfThePlaceAlone) {
  const LatticeSpace space(Distance::euclidean(), 3);
  const CoarseLevels levels = levels_of({{0, 1.5, 0.5}, {1, 4.0, 0.5}}, space);
  const std::vector<Vec3> all = random_places(300, 4);
  const auto heights = [&](const std::vector<Vec3>& some) {
    const SortedPlaces places(some, 1.0);
    std::vector<double> result(some.size(), 0.0);
    levels.add({1, 2}, places, result);
    return result;
  };
  const std::vector<double> whole = heights(all);
  const std::vector<double> part = heights({all.begin() + 40, all.begin() + 60});
  for (std::size_t i = 0; i < part.size(); ++i) EXPECT_EQ(part[i], whole[i + 40]);
}

TEST(CoarseLevels, WorkInThePlaneAndRoundAPeriod) {
  const Distance periodic = Distance::periodic(Vec3(8, 0, 0));
  const LatticeSpace space(periodic, 2);
  const CoarseLevels levels = levels_of({{0, 2.0, 1.0}}, space);
  for (double x = 0; x < 8; x += 0.37)
    for (double y = 0; y < 8; y += 0.61) {
      const double along = std::remainder(x - y, 8.0) / 2;
      double images = 0, images_at_0 = 0;
      for (int n = -4; n <= 4; ++n) {
        images += std::exp(-(along + 4 * n) * (along + 4 * n) / 2);
        images_at_0 += std::exp(-16.0 * n * n / 2);
      }
      EXPECT_NEAR(levels.covariance(space(Vec3(x, 1, 5)), space(Vec3(y, 2, 5))),
                  images / images_at_0 * std::exp(-1.0 / 8), 2 * error);
    }
}

}  // namespace
}  // namespace roughmesh::detail
