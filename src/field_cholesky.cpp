// SPDX-License-Identifier: BSD-3-Clause
#include "field_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

#include <fmt/format.h>

#include "factorize.hpp"
#include "free_memory.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr double smallest_plain_pivot = 1e-5;
constexpr double remaining_diagonal = 1e-8;
constexpr std::size_t patch_size = 500;

// What is left of a semidefinite R has |S_ij| <= sqrt(S_ii S_jj) <= 1e-8, up to round-off of about
// 1e-13. Half as much again cannot come from it, and leaves |L L^T - R| below the promised 2e-8
// together with the 1e-10 that separate_ties() adds.
constexpr double largest_semidefinite_remainder = 1.5 * remaining_diagonal;

constexpr double tie_separation = 1e-10;
constexpr double eigenvalue_smoothing = 1e-10;

void require_matrix(std::size_t n, const char* purpose) {
  require_memory(static_cast<double>(n) * static_cast<double>(n) * sizeof(double),
                 fmt::format("{} of {} points", purpose, n),
                 "use fewer points (a coarser mesh or a smaller group)");
}

/// Lower triangle of R; returns the smallest correlation of two points, 1 if there is only one.
double assemble(const AutocorrelationMatrix& matrix, DenseMatrix& a) {
  const std::size_t n = matrix.n, grain = 16;
  std::vector<double> smallest((n + grain - 1) / grain, 1.0);
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      const std::span<double> below(a.column(j) + j + 1, n - j - 1);
      a(j, j) = 1.0;
      matrix.write_below_diagonal(j, below);
      bool are_numbers = true;
      for (const double r : below) {
        are_numbers &= !std::isnan(r);
        smallest[begin / grain] = std::min(smallest[begin / grain], r);
      }
      // The factorizations compare with limits, which a NaN passes unseen.
      if (!are_numbers)
        throw NumericalError(fmt::format(
            "a correlation with point {} is not a number; change the distance or the function", j));
    }
  });
  return *std::min_element(smallest.begin(), smallest.end());
}

/// The points closest to the first one, which are those most correlated with it, in their order.
std::vector<std::size_t> patch_around_first_point(const DenseMatrix& a) {
  std::vector<std::size_t> patch(a.n_rows());
  std::iota(patch.begin(), patch.end(), std::size_t{0});
  if (patch.size() <= patch_size) return patch;
  const double* const correlation = a.column(0);
  const auto is_closer = [&](std::size_t i, std::size_t j) {
    return correlation[i] != correlation[j] ? correlation[i] > correlation[j] : i < j;
  };
  std::nth_element(patch.begin(), patch.begin() + patch_size, patch.end(), is_closer);
  patch.resize(patch_size);
  std::sort(patch.begin(), patch.end());
  return patch;
}

/// Spares smooth families a factorization that would be abandoned. It never changes the verdict: a
/// pivot is the variance of a point given the points before it, and given only those of the patch
/// it is larger. So too small a pivot in the patch means one in the whole matrix.
bool may_be_well_conditioned(const DenseMatrix& a) {
  const std::vector<std::size_t> patch = patch_around_first_point(a);
  DenseMatrix block(patch.size(), patch.size());
  for (std::size_t j = 0; j < patch.size(); ++j)
    for (std::size_t i = j; i < patch.size(); ++i) block(i, j) = a(patch[i], patch[j]);
  return cholesky(block, smallest_plain_pivot);
}

/// Makes the largest remaining diagonal unique on symmetric surfaces, where round-off would choose
/// among equals. The bits differ from all that white_noise() uses by the second counter word, so
/// that no seed is correlated with the choice.
void separate_ties(DenseMatrix& a) {
  for (std::size_t i = 0; i < a.n_rows(); ++i) {
    const std::uint64_t word = random_words({0, 0}, {i, 1, 0, 0})[0];
    a(i, i) *= 1 + tie_separation * (static_cast<double>(word >> 11) * 0x1p-53);
  }
}

bool is_indefinite(const PivotedCholesky& pivoted) {
  return pivoted.smallest_diagonal < -remaining_diagonal ||
         pivoted.largest_off_diagonal > largest_semidefinite_remainder;
}

std::vector<Index> identity_order(std::size_t n) {
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  return order;
}

/// Largest |variance - 1| of a factor.
double variance_change(const Factor& factor) {
  std::vector<PointPair> diagonal(factor.order().size());
  for (std::size_t i = 0; i < diagonal.size(); ++i)
    diagonal[i] = {static_cast<Index>(i), static_cast<Index>(i)};
  double largest = 0;
  for (const double variance : factor.covariances(diagonal))
    largest = std::max(largest, std::abs(variance - 1));
  return largest;
}

CholeskyField prepare_by_eigenvalues(DenseMatrix a, CholeskySummary summary) {
  const std::size_t n = a.n_rows();
  require_matrix(n, "eigenvalues of the indefinite autocorrelation matrix");
  const std::vector<double> eigenvalues = spectral_root(a, eigenvalue_smoothing);
  const auto n_below = [&](double limit) {
    return static_cast<Index>(std::lower_bound(eigenvalues.begin(), eigenvalues.end(), limit) -
                              eigenvalues.begin());
  };
  summary.factorization = Factorization::eigenvalue;
  summary.rank = static_cast<Index>(n) - n_below(remaining_diagonal);
  summary.negative_eigenvalues = n_below(-remaining_diagonal);
  summary.smallest_eigenvalue = eigenvalues.front();
  Factor factor(std::move(a), identity_order(n), FactorShape::full);
  summary.variance_change = variance_change(factor);
  return {std::move(factor), summary};
}

CholeskyField prepare(const AutocorrelationMatrix& matrix) {
  DenseMatrix a(matrix.n, matrix.n);
  CholeskySummary summary;
  summary.smallest_correlation = assemble(matrix, a);

  if (may_be_well_conditioned(a)) {
    if (cholesky(a, smallest_plain_pivot)) {
      summary.rank = static_cast<Index>(matrix.n);
      return {Factor(std::move(a), identity_order(matrix.n), FactorShape::trapezoid), summary};
    }
    assemble(matrix, a);
  }

  separate_ties(a);
  PivotedCholesky pivoted = pivoted_cholesky(a, remaining_diagonal);
  if (!is_indefinite(pivoted)) {
    a.keep_columns(pivoted.rank);
    summary.factorization = Factorization::pivoted_cholesky;
    summary.rank = static_cast<Index>(pivoted.rank);
    return {Factor(std::move(a), std::move(pivoted.order), FactorShape::trapezoid), summary};
  }

  assemble(matrix, a);
  return prepare_by_eigenvalues(std::move(a), summary);
}

class CholeskyMethod final : public FieldMethod {
 public:
  CholeskyMethod(Correlation correlation, Factor factor)
      : FieldMethod(std::move(correlation)), factor_(std::move(factor)) {}

  std::vector<double> heights(const NoiseStream& stream) const override {
    return factor_.heights(stream);
  }
  std::vector<double> covariances(std::span<const PointPair> pairs) const override {
    return factor_.covariances(pairs);
  }

 private:
  Factor factor_;
};

std::vector<std::string> cited_works(Factorization factorization) {
  std::vector<std::string> works = {
      "Loth, Kiel, Busch, Kristensen (2020), Surface roughness in finite element meshes, "
      "arXiv:2002.00894",
      "Salmon, Moraes, Dror, Shaw (2011), Parallel random numbers: as easy as 1, 2, 3, "
      "doi:10.1145/2063384.2063405",
      "Higham (2009), Cholesky factorization, doi:10.1002/wics.18"};
  if (factorization == Factorization::pivoted_cholesky)
    works.emplace_back(
        "Lucas (2004), LAPACK-style codes for level 2 and 3 pivoted Cholesky factorizations, "
        "LAPACK Working Note 161");
  return works;
}

}  // namespace

AutocorrelationMatrix autocorrelation_matrix(const Correlation& correlation) {
  return {static_cast<std::size_t>(correlation.n_points()),
          [&correlation](std::size_t j, std::span<double> below) {
            for (std::size_t i = 0; i < below.size(); ++i)
              below[i] = correlation(static_cast<Index>(j + 1 + i), static_cast<Index>(j));
          }};
}

CholeskyField factorize_correlation(const AutocorrelationMatrix& matrix) {
  require_matrix(matrix.n, "autocorrelation matrix");
  try {
    return prepare(matrix);
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format(
        "autocorrelation matrix of {} points: the system refused the memory; use fewer points (a "
        "coarser mesh or a smaller group) or a machine with more memory",
        matrix.n));
  }
}

PreparedField prepare_cholesky(const Correlation& correlation) {
  CholeskyField field = factorize_correlation(autocorrelation_matrix(correlation));
  PreparedField prepared;
  prepared.citations = cited_works(field.summary.factorization);
  prepared.summary.cholesky = field.summary;
  prepared.method = std::make_unique<CholeskyMethod>(correlation, std::move(field.factor));
  return prepared;
}

}  // namespace roughmesh::detail
