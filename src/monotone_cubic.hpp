// SPDX-License-Identifier: BSD-3-Clause
// Interpolation without overshoot.
#pragma once

#include <span>
#include <vector>

namespace roughmesh::detail {

/// The cubic Hermite interpolant of F. N. Fritsch and R. E. Carlson (1980), doi:10.1137/0717021:
/// differentiable, and monotone where the data are (docs/math.md, eq. 30).
class MonotoneCubic {
 public:
  /// @param x, y  the same number of them, at least two; x strictly ascending, all finite
  MonotoneCubic(std::vector<double> x, std::vector<double> y);

  double operator()(double x) const;  ///< x from the first to the last node, else theirs
  double integral() const;            ///< from the first node to the last
  double first_slope() const { return slope_.front(); }
  std::span<const double> nodes() const { return x_; }

 private:
  std::vector<double> x_, y_, slope_;
};

}  // namespace roughmesh::detail
