// SPDX-License-Identifier: BSD-3-Clause
// Autocorrelation functions as few Gaussians, to a tolerance.
#pragma once

#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"

#include "mixture_space.hpp"

namespace roughmesh::detail {

/// One Gaussian of a mixture.
struct MixtureTerm {
  int level = 0;      ///< number on the ladder; may be negative
  double scale = 0;   ///< > 0: autocorrelation.length() * ratio^level, but for exact mixtures
  double weight = 0;  ///< share of the variance, > 0
};

/// rho(r) = sum_k weight_k exp(-r^2 / (2 scale_k^2)), and 1 at r = 0 (docs/math.md, eq. 45).
struct ScaleMixture {
  std::vector<MixtureTerm> terms;  ///< ascending in scale
  double nugget = 0;               ///< share of the variance of scale 0
  double ratio = 1;                ///< of neighbouring levels; 1 where the mixture is exact
  /// Largest |mixture - rho| over the distances that count, on a grid finer than that of the fit,
  /// and beyond it.
  double residual = 0;
};

struct ScaleMixtureOptions {
  double tolerance = 0;       ///< largest residual accepted, between 0 and 1
  double smallest_scale = 0;  ///< no scale is below it, > 0; it sets shortest_distance()
};

/// Distances from here on count, and r = 0. Every scale below the smallest one is nothing to them:
/// the distance is smallest_scale * sqrt(2 ln(1 / tolerance)).
double shortest_distance(const ScaleMixtureOptions& options);

/// The smallest scale for which distances from the shortest one on count.
double smallest_scale(double shortest_distance, double tolerance);

/// The mixture of a family, with few terms, and coarse ones. Weights and nugget are multiples of a
/// power of 2, so that their sum is 1 in whatever order. A function of the arguments alone (of the
/// distance, kind, stretch and periods): the same bits on every call. `table` keeps its own terms,
/// and `gaussian` is its own; their level is their position.
///
/// Under `periodic` distance a term is the sum over images of its Gaussian, divided by its value at
/// 0, so that weights are shares of the variance there as well; scale and smallest_scale are those
/// of stretched coordinates, |S x|.
/// @throws InputError      distance that is neither `euclidean` nor `periodic`, or with a sum over
///                         images that diverges; a `table` that no mixture meets; options out of
///                         range
/// @throws NumericalError  no ladder meets rho to the tolerance: names what was reached
ScaleMixture fit_scale_mixture(const Autocorrelation& autocorrelation, const Distance& distance,
                               const ScaleMixtureOptions& options);

/// The mixture at a displacement; where that is 0, or whole periods, the nugget counts. Terms may
/// have been taken out.
/// @param space  of the distance that the mixture was fitted for
double mixture_value(const ScaleMixture& mixture, const MixtureSpace& space,
                     const Vec3& displacement);

}  // namespace roughmesh::detail
