// SPDX-License-Identifier: BSD-3-Clause
#include "nnls.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/QR>
#include <fmt/format.h>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {
namespace {

using Columns = std::vector<Eigen::Index>;

class ActiveSet {
 public:
  ActiveSet(const Eigen::MatrixXd& a, const Eigen::VectorXd& b)
      : a_(a), b_(b), x_(Eigen::VectorXd::Zero(a.cols())), is_barred_(a.cols(), 0) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // What round-off leaves of a gradient that is 0.
    tolerance_ = 4 * epsilon * b.norm() * a.colwise().norm().transpose();
  }

  /// Takes in the column along which |A x - b| falls fastest; false if there is none. A column
  /// whose coefficient would not become positive owes its gradient to round-off, and is barred
  /// until x changes.
  bool improve() {
    const Eigen::VectorXd gradient = a_.transpose() * (b_ - a_ * x_);
    for (Eigen::Index column = steepest(gradient); column >= 0; column = steepest(gradient)) {
      Columns tried = passive_;
      tried.push_back(column);
      const Eigen::VectorXd solution = solve(tried);
      if (solution[solution.size() - 1] > 0) {
        passive_ = std::move(tried);
        approach(solution);
        std::fill(is_barred_.begin(), is_barred_.end(), 0);
        return true;
      }
      is_barred_[column] = 1;
    }
    return false;
  }

  const Eigen::VectorXd& solution() const { return x_; }

 private:
  Eigen::Index steepest(const Eigen::VectorXd& gradient) const {
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < gradient.size(); ++j) {
      const bool is_passive = std::find(passive_.begin(), passive_.end(), j) != passive_.end();
      if (is_passive || is_barred_[j] || !(gradient[j] > tolerance_[j])) continue;
      if (best < 0 || gradient[j] > gradient[best]) best = j;
    }
    return best;
  }

  Eigen::VectorXd solve(const Columns& columns) const {
    Eigen::MatrixXd part(a_.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k)
      part.col(static_cast<Eigen::Index>(k)) = a_.col(columns[k]);
    return part.colPivHouseholderQr().solve(b_);
  }

  /// Goes to the solution, or towards it until coefficients vanish, which then leave.
  void approach(Eigen::VectorXd solution) {
    while (solution.size() > 0 && !(solution.minCoeff() > 0)) {
      double step = 1;
      for (std::size_t k = 0; k < passive_.size(); ++k) {
        const double x = x_[passive_[k]], target = solution[static_cast<Eigen::Index>(k)];
        if (target <= 0) step = std::min(step, x > 0 ? x / (x - target) : 0.0);
      }
      Columns kept;
      for (std::size_t k = 0; k < passive_.size(); ++k) {
        double& x = x_[passive_[k]];
        const double target = solution[static_cast<Eigen::Index>(k)];
        const bool leaves = target <= 0 && (x <= 0 || x / (x - target) <= step);
        x = leaves ? 0 : x + step * (target - x);
        if (!leaves) kept.push_back(passive_[k]);
      }
      passive_ = std::move(kept);
      if (passive_.empty()) return;
      solution = solve(passive_);
    }
    for (std::size_t k = 0; k < passive_.size(); ++k)
      x_[passive_[k]] = solution[static_cast<Eigen::Index>(k)];
  }

  const Eigen::MatrixXd& a_;
  const Eigen::VectorXd& b_;
  Eigen::VectorXd x_, tolerance_;
  Columns passive_;  ///< columns with a positive coefficient
  std::vector<char> is_barred_;
};

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  ActiveSet set(a, b);
  const Eigen::Index most_steps = 30 * std::max<Eigen::Index>(a.cols(), 1);
  for (Eigen::Index step = 0; step < most_steps; ++step)
    if (!set.improve()) return set.solution();
  throw NumericalError(
      fmt::format("nonnegative least squares of {} equations in {} unknowns did not end after {} "
                  "steps; give fewer pairs",
                  a.rows(), a.cols(), most_steps));
}

}  // namespace roughmesh::detail
