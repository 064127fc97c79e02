// SPDX-License-Identifier: BSD-3-Clause
// Levels that are summed over cells are polynomials between the nodes of their cells: heights and
// covariances are those of rows written out, and polynomials keep the error that was allowed.
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "lattice_coarse.hpp"
#include "support/lattice_rows.hpp"
#include "support/points.hpp"

namespace roughmesh::detail {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

LatticeLevel accurate_level(double scale, const LatticeSpace& space) {
  const std::vector<MixtureTerm> term = {{0, scale, 1.0}};
  return make_levels(term, space, 3.0 * kernel_widths().back().error, 0).front();
}

/// Largest |covariance - Gaussian| over places in two cells, of a scale that is the edge of a cell,
/// on a space of one axis.
double polynomial_error(double allowed) {
  const LatticeSpace space(Distance::stretched({.lengths = {1, inf, inf}}), 3);
  const CoarseLevels levels({accurate_level(1, space)}, space, 1, 1, allowed);
  double largest = 0;
  for (int i = 0; i <= 60; ++i)
    for (int j = 0; j <= 120; ++j) {
      const double x = i / 60.0, y = j / 60.0 - 1e-12;
      const double r = y - x;
      largest = std::max(largest,
                         std::abs(levels.covariance({0, 0, x}, {0, 0, y}) - std::exp(-r * r / 2)));
    }
  return largest;
}

// The number of nodes follows from what is allowed; where one node less was enough, or a table were
// too low by a fifth, a limit just below the error of a number of nodes would show it.
TEST(CoarsePolynomials, KeepWhatIsAllowed) {
  double best = 1;
  for (double allowed = 0.03; allowed > 2e-9; allowed *= 0.8) {
    const double error = polynomial_error(allowed);
    EXPECT_LE(error, allowed + kernel_widths().back().error);
    best = std::min(best, error);
  }
  EXPECT_LT(best, 2e-9);
}

struct CoarseCase {
  Distance distance;
  int dimension;
  double cell;
  int n_stages;
};

std::vector<Vec3> random_places(std::size_t n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-3, 3);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < n; ++i) places.emplace_back(part(random), part(random), part(random));
  return places;
}

// Five nodes for an allowed error of 2e-4 along each axis, as in the table of the source. Sums of
// some thousand terms of order 1 at most, in another order.
void expect_rows(const CoarseCase& c) {
  constexpr int n_nodes = 5;
  constexpr double rounding = 1e-12;
  const LatticeSpace space(c.distance, c.dimension);
  const std::vector<MixtureTerm> terms = {
      {-3, 1.1, 0.4}, {2, 1.9999, 0.2}, {4, 2.0, 0.1}, {5, 9.0, 0.2}, {7, 500.0, 0.1}};
  const std::vector<LatticeLevel> levels = make_levels(terms, space, 1e-2, 0);
  const CoarseLevels coarse(levels, space, c.cell, c.n_stages, 2e-4 * space.n_varying());

  std::vector<Vec3> places;
  for (const Vec3& x : random_places(50)) places.push_back(space(x));
  const SortedPlaces sorted(places, c.cell);
  test::NoiseRows rows(levels, places.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const double edge = test::coarse_edge(levels[k].scale, c.cell, c.n_stages);
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::array<AxisRow, 3> along;
      for (std::size_t a = 0; a < 3; ++a)
        along[a] =
            test::polynomial_row(levels[k].axes[a], n_nodes, edge, places[i][static_cast<int>(a)]);
      rows.add_level(i, k, along);
    }
  }

  std::vector<double> heights(places.size(), 0.25);
  coarse.add({7, 8}, sorted, heights);
  for (double& height : heights) height -= 0.25;
  EXPECT_LT(test::largest_difference(heights, rows.heights({7, 8})), rounding);
  const Eigen::MatrixXd covariance = rows.covariance();
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      ASSERT_NEAR(coarse.covariance(places[i], places[j]),
                  covariance(static_cast<int>(i), static_cast<int>(j)), rounding);
}

TEST(CoarseRows, OfSpace) { expect_rows({Distance::euclidean(), 3, 1, 12}); }

TEST(CoarseRows, OfFewStages) {
  for (const int n_stages : {1, 2, 3}) expect_rows({Distance::euclidean(), 3, 0.7, n_stages});
}

TEST(CoarseRows, OfPlanesAndStreaks) {
  expect_rows({Distance::euclidean(), 2, 0.5, 12});
  expect_rows({Distance::stretched({.lengths = {1, inf, 2}}), 3, 1, 12});
  expect_rows({Distance::stretched({.lengths = {inf, 1, inf}}), 3, 1, 12});
}

TEST(CoarseRows, OfPeriodicSpaces) {
  for (const Vec3& period : {Vec3(8, 0, 0), Vec3(1.3, 7, 0), Vec3(2, 3, 4), Vec3(0.5, 0.5, 30)})
    expect_rows({Distance::periodic(period), 3, 0.9, 12});
}

}  // namespace
}  // namespace roughmesh::detail
