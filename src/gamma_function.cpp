// SPDX-License-Identifier: BSD-3-Clause
#include "gamma_function.hpp"

#include <cmath>
#include <numbers>

namespace roughmesh::detail {

// https://dlmf.nist.gov/5.11.E13 where the gamma function would overflow; the next term is below
// 1e-16 there.
double gamma_ratio(double x) {
  if (x < 150) return std::tgamma(x + 0.5) / std::tgamma(x);
  const double y = 1 / x;
  return std::sqrt(x) *
         (1 - y / 8 * (1 - y / 16 * (1 + y * 5 / 8 * (1 - y * 21 / 160 * (1 + y * 19 / 8)))));
}

// https://dlmf.nist.gov/5.11.E1, whose next term is below 1e-16 for x >= 16.
double log_scaled_gamma(double x) {
  if (x < 16) return std::log(std::tgamma(x)) + x - x * std::log(x);
  const double y = 1 / (x * x);
  const double series =
      1.0 / 12 -
      y * (1.0 / 360 - y * (1.0 / 1260 - y * (1.0 / 1680 - y * (1.0 / 1188 - y * 691 / 360360))));
  return 0.5 * std::log(2 * std::numbers::pi / x) + series / x;
}

}  // namespace roughmesh::detail
