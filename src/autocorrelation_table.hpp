// SPDX-License-Identifier: BSD-3-Clause
// The autocorrelation family `table`: measured pairs as a function.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/autocorrelation.hpp"

#include "gaussian_mixture.hpp"
#include "monotone_cubic.hpp"

namespace roughmesh::detail {

/// What is wrong with pair number `i`, given those before it; empty if nothing is.
std::string flaw_of_pair(std::span<const CorrelationPair> pairs, std::size_t i);

/// The Gaussian mixture closest to the pairs where it meets them to 0.02 (docs/math.md, eq. 29),
/// else their monotone interpolant, with 0 beyond the last pair (eq. 30).
class AutocorrelationTable {
 public:
  /// @throws InputError  fewer than 3 pairs, a flawed one, or one above 0.1 at the end
  explicit AutocorrelationTable(std::span<const CorrelationPair> pairs);

  double rho(double r) const;
  double residual() const { return mixture_.residual; }  ///< of the best mixture, used or not
  std::span<const GaussianTerm> terms() const;           ///< empty for an interpolant

  double decay_distance(double level) const;  ///< smallest r with rho(r) = level
  double integral() const;                    ///< of rho over r
  std::optional<double> slope_variance() const;

  /// docs/math.md, eq. 14.
  double spectrum_share_above(double q, int dimension) const;

 private:
  double interpolant_share(double q, int dimension) const;

  GaussianMixture mixture_;
  std::optional<MonotoneCubic> interpolant_;
};

}  // namespace roughmesh::detail
