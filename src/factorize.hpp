// SPDX-License-Identifier: BSD-3-Clause
// Factorizations of a symmetric matrix, of which only the lower triangle is read.
#pragma once

#include <cstddef>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "dense_matrix.hpp"

namespace roughmesh::detail {

/// R = L L^T in place (docs/math.md, eq. 21), rows in their order. Given up at the first pivot
/// L_ii^2 below `smallest_pivot`: returns false and leaves the matrix spoiled. A pivot is the
/// variance of a point given all points before it, so the verdict is a property of R, not of
/// round-off.
bool cholesky(DenseMatrix& matrix, double smallest_pivot);

/// What a pivoted factorization left: P R P^T = L L^T + S, where S lives on the rows from `rank`
/// on.
struct PivotedCholesky {
  std::size_t rank = 0;
  std::vector<Index> order;         ///< order[k]: row of R that became row k
  double smallest_diagonal = 0;     ///< least S_ii; 0 at full rank
  double largest_off_diagonal = 0;  ///< largest |S_ij|, i != j
};

/// The next pivot is always the largest remaining diagonal; stops where that is at most
/// `tolerance`. In place: the first `rank` columns are then L on and below the diagonal, rows in
/// pivot order. The law of LAPACK's dpstrf (Lucas 2004, LAPACK Working Note 161), but S comes out
/// whole, which decides whether R was semidefinite at all.
PivotedCholesky pivoted_cholesky(DenseMatrix& matrix, double tolerance);

/// Replaces R = Q Lambda Q^T by the symmetric Q f(Lambda) Q^T, both triangles, where
/// f(lambda) = max(lambda, 0) / sqrt(max(lambda, 0) + smoothing): docs/math.md, eq. 22. Nearly a
/// square root of the positive part, but one in which neither multiple nor tiny eigenvalues make
/// the result jump. Returns the eigenvalues, ascending; allocates a second matrix of the same size.
/// @throws NumericalError  no convergence
std::vector<double> spectral_root(DenseMatrix& matrix, double smoothing);

}  // namespace roughmesh::detail
