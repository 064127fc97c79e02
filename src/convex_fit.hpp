// SPDX-License-Identifier: BSD-3-Clause
// Least squares with weights that are shares.
#pragma once

#include <Eigen/Core>

#include "nnls.hpp"

namespace roughmesh::detail {

/// The weights a >= 0 of sum 1 with the smallest |A a - target| (docs/math.md, eq. 29): every
/// mixture of Gaussians is fitted by them. Copies are independent.
class ConvexFit {
 public:
  /// @param columns  A, m by n
  /// @param target   length m
  ConvexFit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

  /// Weight 0 from now on; no effect before solve().
  void leave_out(Eigen::Index column) { problem_.leave_out(column); }

  /// @throws NumericalError  no end of the search
  void solve() { problem_.solve(); }

  /// Length n, after solve(). All zero where every column is left out.
  Eigen::VectorXd weights() const;

 private:
  NonnegativeLeastSquares problem_;
};

}  // namespace roughmesh::detail
