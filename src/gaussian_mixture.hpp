// SPDX-License-Identifier: BSD-3-Clause
// Autocorrelation functions as positive sums of Gaussians, by fit.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/autocorrelation.hpp"

namespace roughmesh::detail {

struct MixtureFitOptions {
  double smallest_scale = 0;          ///< ladder of scales from here, > 0 ...
  double largest_scale = 0;           ///< ... to here, both included
  double ratio = 1.4142135623730951;  ///< of neighbouring scales, at most; > 1
};

struct GaussianMixture {
  std::vector<GaussianTerm> terms;  ///< ascending in scale; weights > 0, their sum is 1
  double residual = 0;              ///< largest |rho(r) - sample| over the samples
};

/// sum_k weight_k exp(-r^2 / (2 scale_k^2))
double mixture_rho(std::span<const GaussianTerm> terms, double r);

/// The mixture closest to the samples in the sense of least squares (docs/math.md, eq. 29), with
/// rho(0) = 1 exactly.
/// @param samples  at least one with r > 0; r ascending
/// @throws InputError  a ladder out of range or of more than 10,000 scales
GaussianMixture fit_gaussian_mixture(std::span<const CorrelationPair> samples,
                                     const MixtureFitOptions& options);

}  // namespace roughmesh::detail
