// SPDX-License-Identifier: BSD-3-Clause
// Each factorization multiplies back to its matrix and keeps to its law.
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "roughmesh/error.hpp"
#include "roughmesh/white_noise.hpp"

#include "factorize.hpp"

namespace roughmesh::detail {
namespace {

using Eigen::MatrixXd;

// Several panels of either factorization and a part of one.
constexpr int n_points = 600;

MatrixXd random_matrix(int n_rows, int n_columns) {
  const std::vector<double> z =
      white_noise_sequence({11, 0}, static_cast<std::size_t>(n_rows * n_columns));
  return Eigen::Map<const MatrixXd>(z.data(), n_rows, n_columns);
}

/// Positive semidefinite of the given rank, plus `shift` on the diagonal; entries of order 1.
MatrixXd random_symmetric(int n, int rank, double shift) {
  const MatrixXd b = random_matrix(n, rank) / std::sqrt(rank);
  return b * b.transpose() + shift * MatrixXd::Identity(n, n);
}

/// Only the lower triangle; the upper one holds what no factorization may read.
DenseMatrix lower_triangle(const MatrixXd& matrix) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  DenseMatrix lower(n, n);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      lower(i, j) = i >= j ? matrix(static_cast<int>(i), static_cast<int>(j))
                           : std::numeric_limits<double>::quiet_NaN();
  return lower;
}

MatrixXd trapezoid(const DenseMatrix& a, std::size_t rank) {
  MatrixXd l = MatrixXd::Zero(static_cast<int>(a.n_rows()), static_cast<int>(rank));
  for (std::size_t j = 0; j < rank; ++j)
    for (std::size_t i = j; i < a.n_rows(); ++i)
      l(static_cast<int>(i), static_cast<int>(j)) = a(i, j);
  return l;
}

// Backward stable: |L L^T - R| <= c n eps max R_ii (Higham 2002, theorem 10.3); 600 eps = 1.3e-13.
TEST(Cholesky, MultipliesBackToTheMatrix) {
  const MatrixXd r = random_symmetric(n_points, n_points, 1.0);
  DenseMatrix a = lower_triangle(r);
  ASSERT_TRUE(cholesky(a, 1e-5));
  const MatrixXd l = trapezoid(a, a.n_columns());
  EXPECT_LT((l * l.transpose() - r).cwiseAbs().maxCoeff(), 1e-12);
}

// Correlation 1 - d of two points at rows i < j leaves the second pivot 1 - (1 - d)^2 = 2 d - d^2,
// wherever in a panel it lies.
TEST(Cholesky, IsGivenUpAtTheFirstPivotBelowTheLimit) {
  for (const int row : {1, 255, 256, 599}) {
    const auto accepts = [&](double d) {
      MatrixXd r = MatrixXd::Identity(n_points, n_points);
      r(row, 0) = r(0, row) = 1 - d;
      DenseMatrix a = lower_triangle(r);
      return cholesky(a, 1e-5);
    };
    EXPECT_TRUE(accepts(0.51e-5)) << row;
    EXPECT_FALSE(accepts(0.49e-5)) << row;
    EXPECT_FALSE(accepts(-1)) << row;  // indefinite
  }
}

// Rank 250 (not a multiple of the panel) is found, and L L^T is R in every entry: the remainder is
// semidefinite, so |S_ij| <= max S_ii <= 1e-8.
TEST(PivotedCholesky, FindsTheRankAndMultipliesBackToTheMatrix) {
  const MatrixXd r = random_symmetric(n_points, 250, 0.0);
  DenseMatrix a = lower_triangle(r);
  const PivotedCholesky result = pivoted_cholesky(a, 1e-8);
  EXPECT_EQ(result.rank, 250u);
  EXPECT_LT(result.largest_off_diagonal, 1e-12);
  EXPECT_GT(result.smallest_diagonal, -1e-12);
  const MatrixXd l = trapezoid(a, result.rank);
  const MatrixXd product = l * l.transpose();
  double error = 0;
  for (int i = 0; i < n_points; ++i)
    for (int j = 0; j < n_points; ++j)
      error = std::max(error, std::abs(product(i, j) - r(result.order[i], result.order[j])));
  EXPECT_LT(error, 1e-12);
}

// The law of the pivots: each is the largest remaining diagonal, so L_kk^2 falls, and no entry to
// the left of a row sums to more: sum_{k >= j} L_ik^2 <= L_jj^2.
TEST(PivotedCholesky, TakesTheLargestRemainingDiagonal) {
  DenseMatrix a = lower_triangle(random_symmetric(n_points, n_points, 0.01));
  const PivotedCholesky result = pivoted_cholesky(a, 1e-8);
  ASSERT_EQ(result.rank, static_cast<std::size_t>(n_points));
  EXPECT_EQ(result.smallest_diagonal, 0);
  EXPECT_EQ(result.largest_off_diagonal, 0);
  const MatrixXd l = trapezoid(a, result.rank);
  for (int j = 0; j < n_points; ++j)
    for (int i = j; i < n_points; ++i)
      ASSERT_LE(l.row(i).segment(j, i - j + 1).squaredNorm(), l(j, j) * l(j, j) + 1e-12);
}

// Hilbert-like decay: eigenvalues fall through the tolerance. The remainder that is reported is the
// one that is there.
TEST(PivotedCholesky, ReportsTheRemainderThatIsThere) {
  MatrixXd r(n_points, n_points);
  for (int i = 0; i < n_points; ++i)
    for (int j = 0; j < n_points; ++j) r(i, j) = std::exp(-0.5 * std::pow((i - j) / 4.0, 2));
  r(100, 400) = r(400, 100) = r(100, 400) + 3e-6;  // no longer semidefinite
  DenseMatrix a = lower_triangle(r);
  const PivotedCholesky result = pivoted_cholesky(a, 1e-4);
  ASSERT_LT(result.rank, static_cast<std::size_t>(n_points));
  const MatrixXd l = trapezoid(a, result.rank);
  const MatrixXd product = l * l.transpose();
  double diagonal = 0, off_diagonal = 0;
  for (int i = static_cast<int>(result.rank); i < n_points; ++i)
    for (int j = static_cast<int>(result.rank); j < n_points; ++j) {
      const double s = r(result.order[i], result.order[j]) - product(i, j);
      if (i == j)
        diagonal = std::min(diagonal, s);
      else
        off_diagonal = std::max(off_diagonal, std::abs(s));
    }
  EXPECT_NEAR(result.smallest_diagonal, diagonal, 1e-12);
  EXPECT_NEAR(result.largest_off_diagonal, off_diagonal, 1e-12);
}

// f^2 = lambda+^2 / (lambda+ + s) on the eigenvectors: compared with Eigen's decomposition.
TEST(SpectralRoot, SquaresToTheClippedMatrix) {
  const int n = 200;
  MatrixXd r = random_symmetric(n, n, 0.0);
  r -= 0.3 * MatrixXd::Identity(n, n);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> reference(r);
  DenseMatrix a = lower_triangle(r);
  const std::vector<double> eigenvalues = spectral_root(a, 1e-10);
  MatrixXd f2 = MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k) {
    const double lambda = reference.eigenvalues()[k];
    EXPECT_NEAR(eigenvalues[static_cast<std::size_t>(k)], lambda, 1e-12);
    if (lambda > 0) f2(k, k) = lambda * lambda / (lambda + 1e-10);
  }
  const MatrixXd& q = reference.eigenvectors();
  const Eigen::Map<const MatrixXd> root(a.column(0), n, n);
  EXPECT_EQ(root, root.transpose());
  EXPECT_LT((root * root - q * f2 * q.transpose()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SpectralRoot, RefusesNumbersThatAreNone) {
  MatrixXd r = MatrixXd::Identity(5, 5);
  r(3, 1) = std::numeric_limits<double>::quiet_NaN();
  DenseMatrix a = lower_triangle(r);
  EXPECT_THROW(spectral_root(a, 1e-10), NumericalError);
}

TEST(DenseMatrix, KeepsItsFirstColumns) {
  DenseMatrix a(1000, 1000);
  for (std::size_t j = 0; j < 1000; ++j) a(7, j) = static_cast<double>(j);
  a.keep_columns(10);
  EXPECT_EQ(a.n_columns(), 10u);
  EXPECT_EQ(a(7, 9), 9.0);
  EXPECT_THROW(DenseMatrix(std::size_t{1} << 40, std::size_t{1} << 40), std::bad_alloc);
}

}  // namespace
}  // namespace roughmesh::detail
