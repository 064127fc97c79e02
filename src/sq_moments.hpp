// SPDX-License-Identifier: BSD-3-Clause
// Mean and variance of Sq^2 over realizations.
#pragma once

#include <functional>
#include <span>

#include "roughmesh/correlation.hpp"

namespace roughmesh::detail {

/// A field times the weights of a mask, and the areas its Sq is taken over.
struct MaskedField {
  const Correlation& correlation;
  std::span<const double> weights;  ///< n, in [0, 1]
  std::span<const double> areas;    ///< n, not all 0
  /// Of the unmasked field, called from several threads, where it is not the correlation.
  std::function<double(Index, Index)> covariance = {};
};

struct MeanSquareMoments {
  double mean = 0;
  double variance = 0;
};

/// m and v of docs/math.md, eq. 19 and 44: exact sums up to 2,000 points, beyond that in a time
/// that is nearly that of sorting them.
MeanSquareMoments mean_square_moments(const MaskedField& field);

}  // namespace roughmesh::detail
