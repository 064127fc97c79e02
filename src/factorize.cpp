// SPDX-License-Identifier: BSD-3-Clause
#include "factorize.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Core>
#include <cblas.h>
#include <fmt/format.h>
#include <lapacke.h>

#include "roughmesh/error.hpp"

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

// Columns of a panel, by measurement: wide enough that the update of the rest runs at the speed of
// a matrix product, narrow enough that the panel itself takes little of the time.
constexpr std::size_t plain_panel = 256;
constexpr std::size_t pivoted_panel = 64;

int as_int(std::size_t n) { return static_cast<int>(n); }

/// Trailing rows and columns from `end` on: minus the product of the panel [begin, end) with
/// itself.
void update_trailing(DenseMatrix& a, std::size_t begin, std::size_t end) {
  const int n = as_int(a.n_rows());
  if (end == a.n_rows() || begin == end) return;
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n - as_int(end), as_int(end - begin), -1.0,
              &a(end, begin), n, 1.0, &a(end, end), n);
}

/// Cholesky factor of the diagonal block [begin, end); false at a pivot that is too small.
bool factorize_diagonal_block(DenseMatrix& a, std::size_t begin, std::size_t end,
                              double smallest_pivot) {
  const int info = LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', as_int(end - begin), &a(begin, begin),
                                       as_int(a.n_rows()));
  if (info != 0) return false;
  for (std::size_t i = begin; i < end; ++i)
    if (!(a(i, i) * a(i, i) >= smallest_pivot)) return false;
  return true;
}

/// State of the pivoted factorization: `remaining` is the diagonal of what is left to factorize.
struct PivotedPanels {
  DenseMatrix& a;
  std::vector<double> remaining;
  std::vector<Index> order;

  explicit PivotedPanels(DenseMatrix& matrix)
      : a(matrix), remaining(matrix.n_rows()), order(matrix.n_rows()) {
    for (std::size_t i = 0; i < remaining.size(); ++i) remaining[i] = a(i, i);
    std::iota(order.begin(), order.end(), Index{0});
  }

  std::size_t largest_remaining(std::size_t from) const {
    const auto begin = remaining.begin() + static_cast<std::ptrdiff_t>(from);
    return static_cast<std::size_t>(std::max_element(begin, remaining.end()) - remaining.begin());
  }

  /// Exchanges rows and columns j < p of the symmetric matrix, of which the lower half is stored.
  void exchange(std::size_t j, std::size_t p) {
    const std::size_t n = a.n_rows();
    std::swap(remaining[j], remaining[p]);
    std::swap(order[j], order[p]);
    std::swap(a(j, j), a(p, p));
    cblas_dswap(as_int(j), &a(j, 0), as_int(n), &a(p, 0), as_int(n));
    cblas_dswap(as_int(p - j - 1), a.column(j) + j + 1, 1, &a(p, j + 1), as_int(n));
    std::swap_ranges(a.column(j) + p + 1, a.column(j) + n, a.column(p) + p + 1);
  }

  /// Column j of L from column j of R less the columns of the panel before it. By Eigen, on one
  /// thread: each of some thousand calls is so short that waiting for threads would cost more than
  /// they bring, and far more on a busy machine.
  void eliminate(std::size_t panel, std::size_t j) {
    const auto below = static_cast<Eigen::Index>(a.n_rows() - j - 1);
    const auto before = static_cast<Eigen::Index>(j - panel);
    const Eigen::OuterStride<> stride(static_cast<Eigen::Index>(a.n_rows()));
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> rows(a.column(panel) + j + 1,
                                                                          below, before, stride);
    const Eigen::Map<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row(
        a.column(panel) + j, before, Eigen::InnerStride<>(stride.outer()));
    Eigen::Map<Eigen::VectorXd> column(a.column(j) + j + 1, below);
    Eigen::Map<Eigen::VectorXd> left(remaining.data() + j + 1, below);

    const double pivot = std::sqrt(remaining[j]);
    a(j, j) = pivot;
    column.noalias() -= rows * row.transpose();
    column /= pivot;
    left -= column.cwiseAbs2();
  }

  /// Columns of the panel [begin, end) until nothing above the tolerance remains; returns how far
  /// it came.
  std::size_t factorize_panel(std::size_t begin, std::size_t end, double tolerance) {
    for (std::size_t j = begin; j < end; ++j) {
      const std::size_t pivot = largest_remaining(j);
      if (!(remaining[pivot] > tolerance)) return j;
      if (pivot != j) exchange(j, pivot);
      eliminate(begin, j);
    }
    return end;
  }
};

/// Largest |a_ij| with i > j >= first.
double largest_off_diagonal(const DenseMatrix& a, std::size_t first) {
  const std::size_t n = a.n_rows() - first, grain = 64;
  std::vector<double> largest((n + grain - 1) / grain, 0.0);
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    double& range_largest = largest[begin / grain];
    for (std::size_t j = first + begin; j < first + end; ++j)
      for (std::size_t i = j + 1; i < a.n_rows(); ++i)
        range_largest = std::max(range_largest, std::abs(a(i, j)));
  });
  return largest.empty() ? 0.0 : *std::max_element(largest.begin(), largest.end());
}

/// Eigenvectors, in the columns of the result, and ascending eigenvalues; spoils the matrix.
DenseMatrix decompose(DenseMatrix& a, std::vector<double>& eigenvalues) {
  const int n = as_int(a.n_rows());
  DenseMatrix vectors(a.n_rows(), a.n_rows());
  std::vector<lapack_int> support(2 * a.n_rows());
  lapack_int n_found = 0;
  const int info =
      LAPACKE_dsyevr(LAPACK_COL_MAJOR, 'V', 'A', 'L', n, a.column(0), n, 0.0, 0.0, 0, 0, 0.0,
                     &n_found, eigenvalues.data(), vectors.column(0), n, support.data());
  if (info != 0 || n_found != n)
    throw NumericalError(
        fmt::format("eigenvalues of the autocorrelation matrix of {} points: LAPACK's dsyevr found "
                    "{} and ended with code {}; change the correlation length or the distance",
                    n, n_found, info));
  return vectors;
}

void copy_lower_to_upper(DenseMatrix& a) {
  parallel_for(a.n_rows(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < j; ++i) a(i, j) = a(j, i);
  });
}

}  // namespace

bool cholesky(DenseMatrix& a, double smallest_pivot) {
  const std::size_t n = a.n_rows();
  for (std::size_t begin = 0; begin < n; begin += plain_panel) {
    const std::size_t end = std::min(n, begin + plain_panel);
    if (!factorize_diagonal_block(a, begin, end, smallest_pivot)) return false;
    if (end == n) break;
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, as_int(n - end),
                as_int(end - begin), 1.0, &a(begin, begin), as_int(n), &a(end, begin), as_int(n));
    update_trailing(a, begin, end);
  }
  return true;
}

PivotedCholesky pivoted_cholesky(DenseMatrix& a, double tolerance) {
  const std::size_t n = a.n_rows();
  PivotedPanels panels(a);
  PivotedCholesky result;
  for (std::size_t begin = 0, end = 0; begin < n && result.rank == begin; begin = end) {
    end = std::min(n, begin + pivoted_panel);
    result.rank = panels.factorize_panel(begin, end, tolerance);
    update_trailing(a, begin, result.rank);
  }
  result.order = std::move(panels.order);
  for (std::size_t i = result.rank; i < n; ++i)
    result.smallest_diagonal = std::min(result.smallest_diagonal, panels.remaining[i]);
  result.largest_off_diagonal = largest_off_diagonal(a, result.rank);
  return result;
}

std::vector<double> spectral_root(DenseMatrix& a, double smoothing) {
  const std::size_t n = a.n_rows();
  std::vector<double> eigenvalues(n);
  DenseMatrix vectors = decompose(a, eigenvalues);
  const auto first = static_cast<std::size_t>(
      std::upper_bound(eigenvalues.begin(), eigenvalues.end(), 0.0) - eigenvalues.begin());
  // A product of a matrix with its own transpose is symmetric to the last bit.
  for (std::size_t k = first; k < n; ++k) {
    const double root = eigenvalues[k] / std::sqrt(eigenvalues[k] + smoothing);
    cblas_dscal(as_int(n), std::sqrt(root), vectors.column(k), 1);
  }
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, as_int(n), as_int(n - first), 1.0,
              vectors.column(0) + first * n, as_int(n), 0.0, a.column(0), as_int(n));
  copy_lower_to_upper(a);
  return eigenvalues;
}

}  // namespace roughmesh::detail
