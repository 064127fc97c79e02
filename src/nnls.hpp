// SPDX-License-Identifier: BSD-3-Clause
// Nonnegative least squares.
#pragma once

#include <Eigen/Core>

namespace roughmesh::detail {

/// The x >= 0 of smallest |A x - b|, by the active-set method of C. L. Lawson and R. J. Hanson
/// (1974), Solving least squares problems, chapter 23, doi:10.1137/1.9781611971217 (docs/math.md,
/// eq. 29). Every subproblem is solved by orthogonal transformations, so that columns may be nearly
/// dependent.
/// @param a  m by n, finite
/// @param b  length m, finite
/// @return   length n
/// @throws NumericalError  no end after 30 n steps
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace roughmesh::detail
