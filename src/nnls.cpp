// SPDX-License-Identifier: BSD-3-Clause
#include "nnls.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Householder>
#include <Eigen/Jacobi>
#include <Eigen/QR>
#include <fmt/format.h>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {
namespace {

using Eigen::Index;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// A column that sticks out of the span of the passive ones by less, relative to its length, is as
// good as in it: its coefficient would be round-off.
constexpr double least_height = 1e-11;

// (A | b) or, where it has more rows than columns, its triangular factor: the same problem.
Eigen::MatrixXd reduced(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd both(a.rows(), a.cols() + 1);
  both << a, b;
  if (both.rows() <= both.cols()) return both;
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> factors(both);
  return both.topRows(both.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

NonnegativeLeastSquares::NonnegativeLeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b)
    : work_(reduced(a, b)),
      x_(Eigen::VectorXd::Zero(a.cols())),
      norms_(a.colwise().norm().transpose()),
      tolerance_(8 * epsilon * b.norm() * norms_),
      is_passive_(a.cols(), 0),
      is_barred_(a.cols(), 0),
      is_left_out_(a.cols(), 0) {}

void NonnegativeLeastSquares::solve() {
  const Index most_steps = 30 * std::max<Index>(x_.size(), 1);
  for (Index step = 0; step < most_steps; ++step)
    if (!improve()) return;
  throw NumericalError(
      fmt::format("nonnegative least squares in {} unknowns did not end after {} steps; give fewer "
                  "pairs, or a larger tolerance",
                  x_.size(), most_steps));
}

void NonnegativeLeastSquares::leave_out(Index column) {
  is_left_out_[column] = 1;
  const auto place = std::find(passive_.begin(), passive_.end(), column);
  if (place == passive_.end()) return;
  remove(place - passive_.begin());
  approach();
}

// Takes in the column along which |A x - b| falls fastest; false if there is none. A column whose
// coefficient would not become positive owes its gradient to round-off, and is barred until x
// changes.
bool NonnegativeLeastSquares::improve() {
  for (Index column = steepest(); column >= 0; column = steepest()) {
    if (enter(column)) {
      approach();
      std::fill(is_barred_.begin(), is_barred_.end(), 0);
      return true;
    }
    is_barred_[column] = 1;
  }
  return false;
}

Index NonnegativeLeastSquares::steepest() const {
  const auto n_rest = work_.rows() - static_cast<Index>(passive_.size());
  const auto rest = work_.col(x_.size()).tail(n_rest);  // of b, and so of the residual
  Index best = -1;
  double largest = 0;
  for (Index j = 0; j < x_.size(); ++j) {
    if (is_passive_[j] || is_barred_[j] || is_left_out_[j]) continue;
    const double gradient = work_.col(j).tail(n_rest).dot(rest);
    if (!(gradient > tolerance_[j] && gradient > largest)) continue;
    largest = gradient;
    best = j;
  }
  return best;
}

// False, and nothing done, where the new coefficient would not be positive.
bool NonnegativeLeastSquares::enter(Index column) {
  const auto k = static_cast<Index>(passive_.size());
  const double height = work_.col(column).tail(work_.rows() - k).norm();
  if (!(height > least_height * norms_[column])) return false;
  reflect(column);
  passive_.push_back(column);
  is_passive_[column] = 1;
  if (passive_solution()[k] > 0) return true;
  remove(passive_.size() - 1);
  return false;
}

// The reflection that makes `column` the next one of the triangular factor.
void NonnegativeLeastSquares::reflect(Index column) {
  const auto k = static_cast<Index>(passive_.size()), n_rest = work_.rows() - k;
  Eigen::VectorXd essential(n_rest - 1);
  double tau = 0, beta = 0;
  work_.col(column).tail(n_rest).makeHouseholder(essential, tau, beta);
  work_.col(column).tail(n_rest).setZero();
  work_(k, column) = beta;
  for (Index j = 0; j < work_.cols(); ++j) {
    if (j == column || (j < x_.size() && (is_passive_[j] || is_left_out_[j]))) continue;
    const double projection = tau * (work_(k, j) + essential.dot(work_.col(j).tail(n_rest - 1)));
    work_(k, j) -= projection;
    work_.col(j).tail(n_rest - 1) -= projection * essential;
  }
}

// Rotations make the columns behind triangular again.
void NonnegativeLeastSquares::remove(std::size_t place) {
  const Index removed = passive_[place];
  passive_.erase(passive_.begin() + static_cast<std::ptrdiff_t>(place));
  is_passive_[removed] = 0;
  x_[removed] = 0;
  for (std::size_t next = place; next < passive_.size(); ++next) {
    const auto i = static_cast<Index>(next);
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(work_(i, passive_[next]), work_(i + 1, passive_[next]));
    work_.applyOnTheLeft(i, i + 1, rotation.adjoint());
    work_(i + 1, passive_[next]) = 0;
  }
}

Eigen::VectorXd NonnegativeLeastSquares::passive_solution() const {
  const auto k = static_cast<Index>(passive_.size());
  Eigen::VectorXd y = work_.col(x_.size()).head(k);
  for (Index i = k - 1; i >= 0; --i) {
    const auto column = work_.col(passive_[i]);
    y[i] /= column[i];
    y.head(i) -= y[i] * column.head(i);
  }
  return y;
}

// Goes to the solution in the passive columns, or towards it until coefficients vanish, which then
// leave.
void NonnegativeLeastSquares::approach() {
  while (!passive_.empty()) {
    const Eigen::VectorXd target = passive_solution();
    double step = 1;
    for (std::size_t k = 0; k < passive_.size(); ++k) {
      const double x = x_[passive_[k]], y = target[static_cast<Index>(k)];
      if (y <= 0) step = std::min(step, x > 0 ? x / (x - y) : 0.0);
    }
    std::vector<std::size_t> leaving;
    for (std::size_t k = 0; k < passive_.size(); ++k) {
      double& x = x_[passive_[k]];
      const double y = target[static_cast<Index>(k)];
      if (y <= 0 && (x <= 0 || x / (x - y) <= step)) leaving.push_back(k);
      x = step < 1 ? x + step * (y - x) : y;
    }
    if (leaving.empty()) return;
    for (auto place = leaving.rbegin(); place != leaving.rend(); ++place) remove(*place);
  }
}

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  NonnegativeLeastSquares problem(a, b);
  problem.solve();
  return problem.solution();
}

}  // namespace roughmesh::detail
