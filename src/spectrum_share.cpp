// SPDX-License-Identifier: BSD-3-Clause
// Every family is a mean of Gaussians exp(-r^2 / (2 L^2)) over a random length L (Schoenberg 1938,
// doi:10.2307/1968466), so its share is the mean of the Gaussian's own. No oscillating integral.
#include "spectrum_share.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "matern.hpp"
#include "quadrature.hpp"
#include "stable_law.hpp"

namespace roughmesh::detail {
namespace {

// Largest argument at which erfc and exp are not yet negligible: erfc(9) = 4e-37.
constexpr double erfc_reach = 9;

double gaussian_share(double x, int dimension) {
  return dimension == 2 ? std::exp(-x * x / 2) : std::erfc(x / std::numbers::sqrt2);
}

// L^2 = l^2 e^s with nu e^s ~ Gamma(nu). In the plane the mean has the form of
// rational-quadratic. On a line the complement is integrated, because it vanishes as s -> -inf.
double matern_share(double nu, double x, int dimension) {
  if (dimension == 2) return std::exp(-nu * std::log1p(x * x / (2 * nu)));
  if (x == 0) return 1;
  const double lowest = -80 - 2 * std::max(0.0, std::log(x));
  const double below = gamma_expectation(
      nu, lowest, [x](double s) { return std::erf(x * std::exp(s / 2) / std::numbers::sqrt2); });
  return std::max(0.0, 1 - below);
}

// L^2 = l^2 e^-s with a e^s ~ Gamma(a). In the plane the mean has the form of matern.
double rational_quadratic_share(double a, double x, int dimension) {
  if (dimension == 2) return std::exp(log_matern(a, x));
  if (x == 0) return 1;
  const double lowest = 2 * std::log(x / (erfc_reach * std::numbers::sqrt2));
  return gamma_expectation(
      a, lowest, [x](double s) { return std::erfc(x * std::exp(-s / 2) / std::numbers::sqrt2); });
}

// exp(-(r/l)^p) = E[exp(-(r/l)^2 S)] with S positive (p/2)-stable, so the share is that of
// L^2 = l^2 / (2 S): the probability that 4 S G exceeds x^2, with G ~ Gamma(dimension / 2). The
// variable that is integrated last, for given u, is the one in which the integrand is smooth.
double stable_share(double power, double x, int dimension) {
  const double alpha = power / 2;
  const double kappa = 1 / alpha - 1;
  const double log_scale = 2 * std::log(x / 2);  // of S G
  const auto share_for_angle = [&](double u, double rest) {
    const double log_a = log_kanter(alpha, u, rest);
    if (kappa >= 1)
      return gamma_expectation(dimension / 2.0, -1e3, [&](double s) {
        const double log_g = s + std::log(dimension / 2.0);
        return -std::expm1(-std::exp(log_a + (log_g - log_scale) / kappa));
      });
    return gamma_expectation(1, -1e3, [&](double log_w) {
      const double argument = std::exp((log_scale + kappa * (log_w - log_a)) / 2);
      return gaussian_share(std::numbers::sqrt2 * argument, dimension);
    });
  };
  return tanh_sinh(std::numbers::pi, share_for_angle) / std::numbers::pi;
}

double stretched_share(double power, double x, int dimension) {
  if (x == 0) return 1;
  if (power == 2) return gaussian_share(x / std::numbers::sqrt2, dimension);
  if (power == 1) return matern_share(0.5, x, dimension);
  return stable_share(power, x, dimension);
}

}  // namespace

double spectrum_share_above(Family family, double shape, double x, int dimension) {
  if (std::isinf(x)) return 0;
  switch (family) {
    case Family::gaussian:
      return gaussian_share(x, dimension);
    case Family::exponential:
      return matern_share(0.5, x, dimension);
    case Family::matern:
    case Family::self_affine:
      return matern_share(shape, x, dimension);
    case Family::stretched:
      return stretched_share(shape, x, dimension);
    case Family::rational_quadratic:
      return rational_quadratic_share(shape, x, dimension);
    case Family::table:
      break;  // not of the form rho(r / l); it sums the shares of its Gaussians
  }
  return 0;
}

}  // namespace roughmesh::detail
