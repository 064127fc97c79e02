// SPDX-License-Identifier: BSD-3-Clause
// The sampling method `cholesky`: the whole autocorrelation matrix, factorized.
#pragma once

#include <functional>
#include <span>

#include "roughmesh/field.hpp"

#include "factor.hpp"

namespace roughmesh::detail {

/// R of n points (docs/math.md, eq. 1), with unit diagonal, as a recipe: it may be needed up to
/// three times, and two copies of it would take the memory that the factor needs.
struct AutocorrelationMatrix {
  std::size_t n = 0;
  /// Writes R_ij of i = j + 1 .. n - 1; called from several threads.
  std::function<void(std::size_t j, std::span<double> below)> write_below_diagonal;
};

/// The correlation must outlive the result.
AutocorrelationMatrix autocorrelation_matrix(const Correlation& correlation);

struct CholeskyField {
  Factor factor;
  CholeskySummary summary;
};

/// Chooses the factorization by properties of R alone, never by whether a call of LAPACK succeeded:
///
/// - every pivot at least 1e-5: plain Cholesky, rows in the order of the points;
/// - else pivoted Cholesky, stopped at a remaining diagonal of 1e-8;
/// - where that shows R to be indefinite: eigenvalues, the negative ones set to zero.
///
/// @throws InputError      too little free memory
/// @throws NumericalError  a correlation that is not a number; the eigenvalue decomposition did not
/// converge
CholeskyField factorize_correlation(const AutocorrelationMatrix& matrix);

/// The same as a method; keeps a copy of the correlation.
PreparedField prepare_cholesky(const Correlation& correlation);

}  // namespace roughmesh::detail
