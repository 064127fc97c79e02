// SPDX-License-Identifier: BSD-3-Clause
// Positive stable random numbers, which mix Gaussians into `stretched` (docs/math.md, eq. 14).
#pragma once

#include <algorithm>
#include <cmath>

namespace roughmesh::detail {

/// log of M. Kanter's function a(u) (1975), Ann. Probab. 3:697-707, doi:10.1214/aop/1176996309:
/// S = (a(U) / W)^(1/alpha - 1), with U uniform on (0, pi) and W exponential, is positive
/// alpha-stable. `rest` is pi - u.
inline double log_kanter(double alpha, double u, double rest) {
  const double log_sine = std::log(std::sin(std::min(u, rest)));
  return (alpha * std::log(std::sin(alpha * u)) - log_sine) / (1 - alpha) +
         std::log(std::sin((1 - alpha) * u));
}

}  // namespace roughmesh::detail
