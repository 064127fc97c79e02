// SPDX-License-Identifier: BSD-3-Clause
// The linear map from white noise to heights.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"
#include "roughmesh/white_noise.hpp"

#include "dense_matrix.hpp"
#include "field_method.hpp"

namespace roughmesh::detail {

enum class FactorShape {
  trapezoid,  ///< column k is zero above row k; what the matrix holds there is never read
  full
};

/// Heights d = L w of n points, where L has n rows and at most n columns.
class Factor {
 public:
  /// @param order  length n: the point whose height row k gives. Column k multiplies the noise
  ///               number of point order[k], so that two nearly tied pivots may change places.
  Factor(DenseMatrix columns, std::vector<Index> order, FactorShape shape);

  /// Length n, in the order of the points. Each height is one sum over ascending columns, whatever
  /// the threads and the calls before.
  std::vector<double> heights(const NoiseStream& stream) const;

  /// (L L^T)_ij of each pair of points, from the entries that heights() reads.
  std::vector<double> covariances(std::span<const PointPair> pairs) const;

  const std::vector<Index>& order() const { return order_; }
  std::size_t rank() const { return columns_.n_columns(); }

 private:
  std::size_t first_row(std::size_t column) const {
    return shape_ == FactorShape::trapezoid ? column : 0;
  }
  void add_columns(std::span<const double> noise, std::size_t begin, std::span<double> rows) const;

  DenseMatrix columns_;
  std::vector<Index> order_;
  std::vector<Index> row_of_point_;
  FactorShape shape_;
};

}  // namespace roughmesh::detail
