// SPDX-License-Identifier: BSD-3-Clause
// Nonnegative least squares against the conditions of Karush, Kuhn and Tucker.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "nnls.hpp"

namespace roughmesh::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(int m, int n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  MatrixXd a(m, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) a(i, j) = normal(engine);
  return a;
}

// x >= 0; the gradient A^T (b - A x) is 0 where x > 0 and not positive elsewhere. Together they are
// necessary and sufficient, the problem being convex. Round-off: m eps |a| |b|, times the
// condition.
void expect_optimal(const MatrixXd& a, const VectorXd& b, const VectorXd& x, double condition) {
  const VectorXd gradient = a.transpose() * (b - a * x);
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const double tolerance =
        1e-15 * static_cast<double>(a.rows()) * a.col(j).norm() * b.norm() * condition;
    EXPECT_GE(x[j], 0) << j;
    EXPECT_LE(gradient[j], tolerance) << j;
    if (x[j] > 0) {
      EXPECT_NEAR(gradient[j], 0, tolerance) << j;
    }
  }
}

TEST(NonnegativeLeastSquares, MeetsTheOptimalityConditions) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const int m = 5 + static_cast<int>(seed), n = 1 + static_cast<int>(seed * 7 % 60);
    const MatrixXd a = random_matrix(m, n, seed);
    const VectorXd b = random_matrix(m, 1, seed + 100);
    expect_optimal(a, b, nonnegative_least_squares(a, b), 100);
  }
}

TEST(NonnegativeLeastSquares, MeetsThemWithNearlyDependentColumns) {
  const int m = 80, n = 60;
  MatrixXd a(m, n);
  VectorXd b(m);
  for (int i = 0; i < m; ++i) {
    const double r = 0.05 * i;
    b[i] = std::exp(-r);
    for (int k = 0; k < n; ++k) a(i, k) = std::exp(-r * r / 2 * std::pow(1.3, k - 30));
  }
  const VectorXd x = nonnegative_least_squares(a, b);
  expect_optimal(a, b, x, 1e4);
  EXPECT_LT((a * x - b).norm(), 1e-3);
}

TEST(NonnegativeLeastSquares, FindsANonnegativeSolutionExactly) {
  const MatrixXd a = random_matrix(30, 12, 3);
  VectorXd x = VectorXd::Zero(12);
  x[1] = 0.3;
  x[7] = 2;
  x[11] = 1e-3;
  EXPECT_LT((nonnegative_least_squares(a, a * x) - x).norm(), 1e-13);
}

// The nearest nonnegative vector to b is b with its negative entries set to 0.
TEST(NonnegativeLeastSquares, OfTheIdentityCutsOffNegativeEntries) {
  const VectorXd b = random_matrix(50, 1, 4);
  const VectorXd x = nonnegative_least_squares(MatrixXd::Identity(50, 50), b);
  EXPECT_LT((x - b.cwiseMax(0)).norm(), 1e-14);
}

TEST(NonnegativeLeastSquares, BearsEqualAndZeroColumns) {
  MatrixXd a = random_matrix(20, 6, 5);
  a.col(1) = a.col(0);
  a.col(2).setZero();
  const VectorXd b = a.col(0) * 3 - a.col(4);
  expect_optimal(a, b, nonnegative_least_squares(a, b), 100);
  EXPECT_EQ(nonnegative_least_squares(a, VectorXd::Zero(20)).norm(), 0);
  EXPECT_EQ(nonnegative_least_squares(a, -a.rowwise().sum()).size(), 6);
}

// Leaving a column out, from whatever solution was found before, is the problem without it.
TEST(NonnegativeLeastSquares, GoesOnWithoutAColumn) {
  const int n = 15;
  const MatrixXd a = random_matrix(30, n, 6);
  const VectorXd b = a.cwiseAbs().rowwise().sum() + random_matrix(30, 1, 7);
  NonnegativeLeastSquares all(a, b);
  all.solve();
  for (int column = 0; column < n; ++column) {
    NonnegativeLeastSquares problem = all;
    problem.leave_out(column);
    problem.leave_out((column + 4) % n);
    problem.solve();
    MatrixXd rest = a;
    rest.col(column).setZero();
    rest.col((column + 4) % n).setZero();
    EXPECT_EQ(problem.solution()[column], 0);
    EXPECT_LT((problem.solution() - nonnegative_least_squares(rest, b)).norm(), 1e-12) << column;
  }
  EXPECT_LT((all.solution() - nonnegative_least_squares(a, b)).norm(), 1e-15);
}

}  // namespace
}  // namespace roughmesh::detail
