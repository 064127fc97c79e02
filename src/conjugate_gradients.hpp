// SPDX-License-Identifier: BSD-3-Clause
// Three right-hand sides at once, which read the matrix only once.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace roughmesh::detail {

/// The value of a row stays in a subspace: a node that slides in a plane or along a line.
struct SlidingRow {
  Eigen::Index row = 0;
  Eigen::Matrix3d free = Eigen::Matrix3d::Identity();  ///< orthogonal projection onto it
};

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

/// Conjugate gradients with the diagonal as preconditioner, each component on its own unless
/// oblique subspaces join them. The same bits on any number of threads.
/// @param matrix   symmetric, positive definite
/// @param sliding  each row once; the residual of others does not count beyond their subspaces
Solution solve(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix,
               std::span<const Eigen::Vector3d> load, std::span<const SlidingRow> sliding = {},
               const SolveOptions& options = {});

}  // namespace roughmesh::detail
