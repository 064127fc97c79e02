// SPDX-License-Identifier: BSD-3-Clause
#include "convex_fit.hpp"

namespace roughmesh::detail {
namespace {

// With sum x = 1, A x - target = (A - target 1^T) x. The smallest |(A - target 1^T) x|^2 + (sum x -
// 1)^2 is taken where x / sum x is the best of all vectors of sum 1: for each direction the factor
// that is best leaves a monotone function of the first norm.
Eigen::MatrixXd with_row_of_ones(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  Eigen::MatrixXd a(columns.rows() + 1, columns.cols());
  a.topRows(columns.rows()) = columns.colwise() - target;
  a.bottomRows(1).setOnes();
  return a;
}

}  // namespace

ConvexFit::ConvexFit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target)
    : problem_(with_row_of_ones(columns, target),
               Eigen::VectorXd::Unit(columns.rows() + 1, columns.rows())) {}

Eigen::VectorXd ConvexFit::weights() const {
  const Eigen::VectorXd& x = problem_.solution();
  const double sum = x.sum();
  if (!(sum > 0)) return Eigen::VectorXd::Zero(x.size());
  return x / sum;
}

}  // namespace roughmesh::detail
