// SPDX-License-Identifier: BSD-3-Clause
// Products of small matrices with values on boxes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace roughmesh::detail {

/// Rows by columns, row after row.
struct SmallMatrix {
  int n_rows = 0, n_columns = 0;
  std::vector<double> entries;

  double& operator()(int i, int j) { return entries[position(i, j)]; }
  double operator()(int i, int j) const { return entries[position(i, j)]; }

 private:
  std::size_t position(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(n_columns) +
           static_cast<std::size_t>(j);
  }
};

SmallMatrix zero_matrix(int n_rows, int n_columns);

/// result += a b. The entries of b and the result may be part of larger arrays.
/// @param b       a.n_columns rows of `width` numbers
/// @param result  a.n_rows rows of `width` numbers
void add_product(const SmallMatrix& a, const double* b, int width, double* result);

/// Values on a box under one matrix for each axis: result(i, j, k) += sum over (x, y, z) of
/// matrices[0](i, x) matrices[1](j, y) matrices[2](k, z) values(x, y, z).
void add_tensor_product(const std::array<SmallMatrix, 3>& matrices, std::span<const double> values,
                        std::span<double> result);

/// Doubles of the longest vector register in use.
constexpr int tensor_lanes = 8;

/// Weights of up to 16 values along an axis, and zeros.
using NodeWeights = std::array<double, 16>;

/// The box of values under one vector of weights for each axis.
/// @param values  and behind them tensor_lanes - 1 finite numbers, which do not count
double interpolate(const std::array<NodeWeights, 3>& weights, const double* values,
                   const std::array<int, 3>& size);

}  // namespace roughmesh::detail
