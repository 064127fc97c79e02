// SPDX-License-Identifier: BSD-3-Clause
#include "quadrature.hpp"

namespace roughmesh::detail {

double log_gamma_normalization(double shape) {
  if (shape < 16) return std::log(std::tgamma(shape)) + shape - shape * std::log(shape);
  // Stirling's series, https://dlmf.nist.gov/5.11.E1; its next term is below 1e-16 here. The
  // logarithm of the gamma function itself would lose its digits against shape log(shape).
  const double x = 1 / (shape * shape);
  const double series =
      (1.0 / 12 - x * (1.0 / 360 -
                       x * (1.0 / 1260 - x * (1.0 / 1680 - x * (1.0 / 1188 - x * 691 / 360360))))) /
      shape;
  return 0.5 * std::log(2 * std::numbers::pi / shape) + series;
}

}  // namespace roughmesh::detail
