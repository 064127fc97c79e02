// SPDX-License-Identifier: BSD-3-Clause
// Quadrature of smooth functions, to nearly the rounding error of a double.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gamma_function.hpp"

namespace roughmesh::detail {

/// E[f(s)] with G = shape e^s distributed as Gamma(shape, 1), for f analytic near the real axis
/// and negligible below `lowest`. The trapezoidal rule converges exponentially here: L. N.
/// Trefethen and J. A. C. Weideman (2014), SIAM Rev. 56:385-458, doi:10.1137/130932132.
template <class Function>
double gamma_expectation(double shape, double lowest, const Function& f) {
  constexpr double negligible = 45;  // exp(-45) = 3e-20
  const double step = std::min(0.15, 0.6 / std::sqrt(shape));
  const auto exponent = [&](double s) { return shape * (std::expm1(s) - s); };
  double sum = 0;
  for (double k = 0; exponent(k * step) < negligible; ++k)
    sum += f(k * step) * std::exp(-exponent(k * step));
  for (double k = -1; k * step > lowest && exponent(k * step) < negligible; --k)
    sum += f(k * step) * std::exp(-exponent(k * step));
  return sum * step * std::exp(-log_scaled_gamma(shape));
}

/// Calls visit(from_left, from_right, weight) for the nodes of the double exponential rule on (0,
/// width), each given by its distance from both ends, so that algebraic singularities there cost no
/// digits. H. Takahasi and M. Mori (1974), Publ. RIMS 9:721-741, doi:10.2977/prims/1195192451.
template <class Visit>
void tanh_sinh_nodes(double width, const Visit& visit) {
  constexpr int half_steps = 56;
  constexpr double step = 3.4 / half_steps;
  for (int k = -half_steps; k <= half_steps; ++k) {
    const double t = k * step;
    const double y = std::numbers::pi * std::sinh(t);
    const double left = width / (1 + std::exp(-y));
    const double right = width / (1 + std::exp(y));
    visit(left, right, left * right * std::cosh(t) * step * std::numbers::pi / width);
  }
}

/// Integral of f over (0, width) by that rule; f(from_left, from_right) is given its distance from
/// both ends.
template <class Function>
double tanh_sinh(double width, const Function& f) {
  double sum = 0;
  tanh_sinh_nodes(
      width, [&](double left, double right, double weight) { sum += weight * f(left, right); });
  return sum;
}

}  // namespace roughmesh::detail
