// SPDX-License-Identifier: BSD-3-Clause
// Every family as a sum of Gaussians, to nearly the rounding error of a double, for sums over
// images.
#pragma once

#include <vector>

#include "roughmesh/autocorrelation.hpp"

namespace roughmesh::detail {

struct ScaleRange {
  double smallest = 0;  ///< Gaussians of smaller scale are left out
  double largest = 0;   ///< no distance or period of interest exceeds it
};

/// rho(r) = sum_k weight_k exp(-r^2 / (2 scale_k^2)) for r > 9 range.smallest (docs/math.md, eq.
/// 26), and the same for its sum over a lattice of up to 3 dimensions with periods up to
/// range.largest: no scale is left out that matters to it. Some weights may be negative.
/// @param n_sums  dimension of the lattice; `rational-quadratic` needs 2a > n_sums
std::vector<GaussianTerm> scale_quadrature(const Autocorrelation& autocorrelation,
                                           const ScaleRange& range, int n_sums);

}  // namespace roughmesh::detail
