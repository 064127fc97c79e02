// SPDX-License-Identifier: BSD-3-Clause
// Height parameters of a rough surface, area-weighted, as ISO 25178-2 defines them.
#pragma once

#include <functional>
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
/// @param areas    n node areas that count instead of surface.areas, or none: points of area 0 are
///                 left out, like those that full_weight_areas leaves out
/// @throws InputError  other numbers of them; areas that are negative, not finite or all 0
HeightStatistics height_statistics(const Surface& surface, std::span<const double> heights,
                                   std::span<const double> areas = {});

/// What Sq must be over realizations on this surface, for a field of unit rms height.
struct ExpectedSq {
  double mean = 0;                ///< E[Sq] / Rq
  double standard_deviation = 0;  ///< of Sq / Rq
};

/// What part of a surface Sq is taken over, and of which field.
struct SqOptions {
  std::span<const double> weights = {};  ///< n mask weights of the field in [0, 1]; none: all 1
  std::span<const double> areas = {};    ///< n node areas, as for height_statistics
  /// Covariance of the unmasked field at two points, called from several threads, where it is not
  /// the correlation: of a sampler that had to clip eigenvalues. None: the correlation.
  std::function<double(Index, Index)> covariance = {};
};

/// From rho alone (docs/math.md, eq. 19, 20 and 44): below 1 because Sq is taken about the mean of
/// a finite surface. Exact sums up to 2,000 points; beyond that over 256 area-weighted source
/// points, groups of far points counting as one: in the time that sorting the points takes.
/// @throws InputError  weights or areas out of range, or other numbers of them; a correlation that
///                     is not one of the points of this surface
ExpectedSq expected_sq(const Surface& surface, const Correlation& correlation,
                       const SqOptions& options = {});

}  // namespace roughmesh
