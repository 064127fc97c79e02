// SPDX-License-Identifier: BSD-3-Clause
// Three right-hand sides at once, which read the matrix only once.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace roughmesh::detail {

struct SolveOptions {
  double tolerance = 1e-12;  ///< of the relative residual of each component
  int most_iterations = 10'000;
};

struct Solution {
  std::vector<Eigen::Vector3d> values;
  int iterations = 0;
  double residual = 0;  ///< the largest relative one
  bool converged = false;
};

/// Conjugate gradients with the diagonal as preconditioner, each component on its own. The same
/// bits on any number of threads.
/// @param matrix  symmetric, positive definite
Solution solve(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix,
               std::span<const Eigen::Vector3d> load, const SolveOptions& options = {});

}  // namespace roughmesh::detail
