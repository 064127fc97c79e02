// SPDX-License-Identifier: BSD-3-Clause
#include "conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr std::size_t rows_per_range = 2048;

// Sums of visit(row) over ranges, added in the order of the ranges.
template <class Visit>
Array3d sum_over_rows(std::size_t n, Visit&& visit) {
  std::vector<Array3d> sums((n + rows_per_range - 1) / rows_per_range, Array3d::Zero());
  parallel_for(n, rows_per_range, [&](std::size_t begin, std::size_t end) {
    Array3d sum = Array3d::Zero();
    for (std::size_t i = begin; i < end; ++i) sum += visit(i);
    sums[begin / rows_per_range] = sum;
  });
  Array3d total = Array3d::Zero();
  for (const Array3d& sum : sums) total += sum;
  return total;
}

Vector3d row_product(const Matrix& matrix, std::size_t row, const std::vector<Vector3d>& x) {
  const auto* columns = matrix.innerIndexPtr();
  const double* values = matrix.valuePtr();
  Vector3d sum = Vector3d::Zero();
  for (auto k = matrix.outerIndexPtr()[row]; k < matrix.outerIndexPtr()[row + 1]; ++k)
    sum += values[k] * x[columns[k]];
  return sum;
}

// A component without residual is solved: it takes no further step.
Array3d ratio(const Array3d& a, const Array3d& b) { return (b > 0).select(a / b, Array3d::Zero()); }

class Solver {
 public:
  Solver(const Matrix& matrix, std::span<const Vector3d> load, std::span<const SlidingRow> sliding)
      : matrix_(matrix),
        sliding_(sliding),
        are_joined_(std::any_of(sliding.begin(), sliding.end(), joins_components)),
        inverse_diagonal_(load.size()),
        x_(load.size(), Vector3d::Zero()),
        residual_(load.begin(), load.end()),
        direction_(load.size(), Vector3d::Zero()),
        product_(load.size()) {
    const Eigen::VectorXd diagonal = matrix.diagonal();
    for (std::size_t i = 0; i < load.size(); ++i)
      inverse_diagonal_[i] = 1 / diagonal[static_cast<Eigen::Index>(i)];
    if (!sliding_.empty()) number_of_row_.assign(load.size(), -1);
    for (std::size_t k = 0; k < sliding_.size(); ++k) {
      number_of_row_[static_cast<std::size_t>(sliding_[k].row)] = static_cast<std::ptrdiff_t>(k);
      residual_[static_cast<std::size_t>(sliding_[k].row)] =
          sliding_[k].free * load[static_cast<std::size_t>(sliding_[k].row)];
    }
    load_square_ = sum([&](std::size_t i) { return residual_[i].array().square(); });
    residual_square_ = load_square_;
    energy_ = sum([&](std::size_t i) -> Array3d {
      return inverse_diagonal_[i] * residual_[i].array().square();
    });
  }

  double relative_residual() const {
    return std::sqrt(ratio(residual_square_, load_square_).maxCoeff());
  }
  bool is_finite() const { return residual_square_.isFinite().all(); }

  void step() {
    turn();
    const Array3d curvature = sum([&](std::size_t i) -> Array3d {
      product_[i] = within_subspace(i, row_product(matrix_, i, direction_));
      return product_[i].array() * direction_[i].array();
    });
    const Array3d length = ratio(energy_, curvature);
    residual_square_ = sum([&](std::size_t i) -> Array3d {
      x_[i].array() += length * direction_[i].array();
      residual_[i].array() -= length * product_[i].array();
      return residual_[i].array().square();
    });
    previous_energy_ = energy_;
    energy_ = sum([&](std::size_t i) -> Array3d {
      return inverse_diagonal_[i] * residual_[i].array().square();
    });
  }

  std::vector<Vector3d> take() { return std::move(x_); }

 private:
  std::size_t n() const { return x_.size(); }

  // Subspaces along the axes leave three systems; others make them one.
  static bool joins_components(const SlidingRow& sliding) {
    return !Eigen::Matrix3d(sliding.free.diagonal().asDiagonal()).isApprox(sliding.free, 0);
  }
  template <class Visit>
  Array3d sum(Visit&& visit) const {
    const Array3d sums = sum_over_rows(n(), std::forward<Visit>(visit));
    return are_joined_ ? Array3d::Constant(sums.sum()) : sums;
  }
  Vector3d within_subspace(std::size_t row, const Vector3d& value) const {
    if (number_of_row_.empty() || number_of_row_[row] < 0) return value;
    return sliding_[static_cast<std::size_t>(number_of_row_[row])].free * value;
  }

  void turn() {
    const Array3d share = ratio(energy_, previous_energy_);
    parallel_for(n(), rows_per_range, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        direction_[i].array() =
            inverse_diagonal_[i] * residual_[i].array() + share * direction_[i].array();
    });
  }

  const Matrix& matrix_;
  std::span<const SlidingRow> sliding_;
  bool are_joined_ = false;
  std::vector<std::ptrdiff_t> number_of_row_;  // in sliding_, or -1; empty where none slides
  std::vector<double> inverse_diagonal_;
  std::vector<Vector3d> x_, residual_, direction_, product_;
  Array3d load_square_, residual_square_;
  Array3d energy_, previous_energy_ = Array3d::Zero();  // of the residual, preconditioned
};

}  // namespace

Solution solve(const Matrix& matrix, std::span<const Vector3d> load,
               std::span<const SlidingRow> sliding, const SolveOptions& options) {
  Solver solver(matrix, load, sliding);
  Solution result;
  result.residual = solver.relative_residual();
  while (result.residual > options.tolerance && result.iterations < options.most_iterations &&
         solver.is_finite()) {
    solver.step();
    result.residual = solver.relative_residual();
    ++result.iterations;
  }
  result.converged = result.residual <= options.tolerance && solver.is_finite();
  result.values = solver.take();
  return result;
}

}  // namespace roughmesh::detail
