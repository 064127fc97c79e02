// SPDX-License-Identifier: BSD-3-Clause
// Height parameters of a rough surface, area-weighted, as ISO 25178-2 defines them.
#pragma once

#include <span>

#include "roughmesh/correlation.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// Moments of heights about their area-weighted mean (docs/math.md, eq. 18).
struct HeightStatistics {
  double mean = 0;  ///< area-weighted, a length
  double sq = 0;    ///< rms height, a length
  double ssk = 0;   ///< skewness
  double sku = 0;   ///< kurtosis; 3 for a Gaussian
  double sz = 0;    ///< largest minus smallest height, a length
};

/// @param heights  n numbers, in the order of surface.points
HeightStatistics height_statistics(const Surface& surface, std::span<const double> heights);

/// What Sq must be over realizations on this surface, for a field of unit rms height.
struct ExpectedSq {
  double mean = 0;                ///< E[Sq] / Rq
  double standard_deviation = 0;  ///< of Sq / Rq
};

/// From rho alone (docs/math.md, eq. 19 and 20): below 1 because Sq is taken about the mean of a
/// finite surface. Exact sums up to 2,000 points, beyond that over 256 area-weighted source points:
/// linear time.
/// @throws InputError  the correlation is not one of the points of this surface
ExpectedSq expected_sq(const Surface& surface, const Correlation& correlation);

}  // namespace roughmesh
