// SPDX-License-Identifier: BSD-3-Clause
// Heights are L w with the noise of the pivots, and covariances are (L L^T)_ij, in point order.
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "factor.hpp"

namespace roughmesh::detail {
namespace {

// More rows than one range of the product.
constexpr std::size_t n_points = 1500;

/// Row k is point 7 k modulo n, which visits each once, since 7 does not divide 1,500.
std::vector<Index> scrambled_order() {
  std::vector<Index> order(n_points);
  for (std::size_t k = 0; k < n_points; ++k) order[k] = static_cast<Index>(7 * k % n_points);
  return order;
}

/// Entries of a factor that can be recomputed: 1 on the diagonal, 1/(i + k + 1) below it, nothing
/// that is a number above.
double entry(std::size_t i, std::size_t k) {
  if (i < k) return std::numeric_limits<double>::quiet_NaN();
  return i == k ? 1.0 : 1.0 / static_cast<double>(i + k + 1);
}

Factor make_factor(std::size_t rank) {
  DenseMatrix columns(n_points, rank);
  for (std::size_t k = 0; k < rank; ++k)
    for (std::size_t i = 0; i < n_points; ++i) columns(i, k) = entry(i, k);
  return {std::move(columns), scrambled_order(), FactorShape::trapezoid};
}

// The sums have 40 terms of at most 1 * 8.6, so that another order of summation differs by less
// than 40 * 8.6 * 1.1e-16 * 40.
TEST(Factor, HeightsAreTheProductWithTheNoiseOfThePivots) {
  const std::size_t rank = 40;
  const Factor factor = make_factor(rank);
  const std::vector<Index> order = scrambled_order();
  const NoiseStream stream{3, 9};
  const std::vector<double> heights = factor.heights(stream);
  for (std::size_t row = 0; row < n_points; ++row) {
    double expected = 0;
    for (std::size_t k = 0; k <= std::min(row, rank - 1); ++k)
      expected += entry(row, k) * white_noise(stream, static_cast<std::uint64_t>(order[k]));
    ASSERT_NEAR(heights[order[row]], expected, 2e-12) << row;
  }
}

TEST(Factor, CovariancesAreProductsOfRowsAloneAndAmongOthers) {
  const std::size_t rank = 40;
  const Factor factor = make_factor(rank);
  const std::vector<Index> order = scrambled_order();
  std::vector<PointPair> pairs;
  for (std::size_t a = 0; a < n_points; a += 10)
    for (std::size_t b = 0; b < n_points; b += 37) pairs.emplace_back(order[a], order[b]);
  const std::vector<double> covariances = factor.covariances(pairs);
  std::size_t p = 0;
  for (std::size_t a = 0; a < n_points; a += 10)
    for (std::size_t b = 0; b < n_points; b += 37) {
      double expected = 0;
      for (std::size_t k = 0; k <= std::min({a, b, rank - 1}); ++k)
        expected += entry(a, k) * entry(b, k);
      ASSERT_NEAR(covariances[p], expected, 1e-13);
      ASSERT_EQ(factor.covariances({&pairs[p], 1}).front(), covariances[p]);
      ++p;
    }
}

}  // namespace
}  // namespace roughmesh::detail
