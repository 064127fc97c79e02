// SPDX-License-Identifier: BSD-3-Clause
// Nonnegative least squares.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace roughmesh::detail {

/// The x >= 0 of smallest |A x - b|, by the active-set method of C. L. Lawson and R. J. Hanson
/// (1974), Solving least squares problems, chapter 23, doi:10.1137/1.9781611971217 (docs/math.md,
/// eq. 29). One triangular factor is kept up to date by reflections and rotations as columns come
/// and go, so that columns may be nearly dependent and a step costs no new factorization. Copies
/// are independent: try a change on one.
class NonnegativeLeastSquares {
 public:
  /// @param a  m by n, finite
  /// @param b  length m, finite
  NonnegativeLeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

  /// x[column] = 0 from now on. solve() goes on from the columns that are left.
  void leave_out(Eigen::Index column);

  /// @throws NumericalError  no end after 30 n steps
  void solve();

  const Eigen::VectorXd& solution() const { return x_; }  ///< length n; before solve() zero

 private:
  bool improve();
  Eigen::Index steepest() const;
  bool enter(Eigen::Index column);
  void reflect(Eigen::Index column);
  void remove(std::size_t place);
  void approach();
  Eigen::VectorXd passive_solution() const;

  Eigen::MatrixXd work_;  ///< Q^T (A | b), Q orthogonal; upper triangular in the passive columns
  Eigen::VectorXd x_;
  Eigen::VectorXd norms_;              ///< of the columns of A
  Eigen::VectorXd tolerance_;          ///< what round-off leaves of a gradient that is 0
  std::vector<Eigen::Index> passive_;  ///< columns of the factor, in its order
  std::vector<char> is_passive_, is_barred_, is_left_out_;  ///< one per column
};

/// @return   length n
/// @throws NumericalError  as solve()
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace roughmesh::detail
