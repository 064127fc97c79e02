// SPDX-License-Identifier: BSD-3-Clause
// Gaussians of one coordinate, alone and repeated.
#pragma once

#include <cmath>
#include <numbers>

namespace roughmesh::detail {

inline double bell(double x, double scale) {
  const double ratio = x / scale;
  return std::exp(-ratio * ratio / 2);
}

/// Sum of bell(x + n period) over all whole n, for |x| <= period: few terms of it, or of its
/// Fourier series (the theta function; https://dlmf.nist.gov/20.7.E32).
inline double periodic_bell(double x, double period, double scale) {
  const double ratio = scale / period;
  if (ratio < 0.4) {
    double sum = bell(x, scale);
    for (int n = 1; (n - 1) * period < 9 * scale; ++n)  // exp(-9^2 / 2) = 3e-18
      sum += bell(x + n * period, scale) + bell(x - n * period, scale);
    return sum;
  }
  constexpr double negligible = 42;  // exp(-42) = 6e-19
  double sum = 1;
  for (int m = 1;; ++m) {
    const double q = 2 * std::numbers::pi * m, exponent = q * q * ratio * ratio / 2;
    if (exponent > negligible) break;
    sum += 2 * std::exp(-exponent) * std::cos(q * x / period);
  }
  return sum * std::sqrt(2 * std::numbers::pi) * ratio;
}

}  // namespace roughmesh::detail
