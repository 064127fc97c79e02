// SPDX-License-Identifier: BSD-3-Clause
#include "matern.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/LU>

#include "gamma_function.hpp"

namespace roughmesh::detail {
namespace {

// Below this argument (scaled as in the table) rho = 1 for nu >= 0.75, to 1e-13, and the leading
// term of the series at 0 is enough for smaller nu.
constexpr double smallest_argument = 0x1p-30;
constexpr double largest_argument = 0x1p10;  // rho < exp(-1000) beyond
constexpr double largest_series_nu = 0.75;

double argument_scale(double nu) { return std::sqrt(2 * std::min(nu, 1.0)); }

// log rho = log(1 - Gamma(1 - nu) / Gamma(1 + nu) (z/2)^(2 nu)) as z -> 0 and nu < 1
// (https://dlmf.nist.gov/10.27.E4 and 10.25.E2).
double log_matern_near_zero(double nu, double z) {
  if (z == 0 || nu > largest_series_nu) return 0;
  const double log_factor = std::log(std::tgamma(1 - nu) / std::tgamma(1 + nu));
  return std::log(-std::expm1(log_factor + 2 * nu * std::log(z / 2)));
}

// e^u - 1 - u, to a relative error of 1e-15.
double exp_remainder(double u) {
  if (std::abs(u) > 0.5) return std::expm1(u) - u;
  double series = 1;
  for (int k = 14; k >= 3; --k) series = 1 + series * u / k;
  return series * u * u / 2;
}

// log of the integral of exp(-a (e^u - 1 - u) - b (e^-u - 1 + u)) over all u, for a, b >= 0, not
// both 0. Two positive terms: nothing cancels however large they are. The integrand is 1 at most,
// at u = 0.
double log_peak_integral(double a, double b) {
  constexpr double negligible = 46;
  const double step = std::min(0.15, 0.6 / std::sqrt(a + b));
  const auto exponent = [&](double u) { return a * exp_remainder(u) + b * exp_remainder(-u); };
  double sum = 1;
  for (const double signed_step : {step, -step})
    for (double k = 1; exponent(k * signed_step) < negligible; ++k)
      sum += std::exp(-exponent(k * signed_step));
  return std::log(sum * step);
}

}  // namespace

// rho is the mean of exp(-z^2 / (4 G)) over G ~ Gamma(nu, 1) (https://dlmf.nist.gov/10.32.E10).
// With G = a e^u, a = (nu + sqrt(nu^2 + z^2)) / 2 at the peak of the integrand and b = a - nu, no
// factor overflows and no digits cancel, from nu = 1e-300 to 1e300.
double log_matern(double nu, double x) {
  if (x * argument_scale(nu) < smallest_argument)
    return log_matern_near_zero(nu, std::sqrt(2 * nu) * x);
  const double z = std::sqrt(2 * nu) * x;
  const double a = (nu + std::hypot(nu, z)) / 2;
  const double b = z / a * (z / 4);
  return nu * std::log1p(b / nu) - 2 * b + log_peak_integral(a, b) - log_scaled_gamma(nu);
}

bool is_half_integer_matern(double nu) { return nu == 0.5 || nu == 1.5 || nu == 2.5; }

double matern_half_integer(double nu, double x) {
  const double z = std::sqrt(2 * nu) * x;
  if (z > largest_argument) return 0;
  const double polynomial = nu == 0.5 ? 1 : nu == 1.5 ? 1 + z : 1 + z * (1 + z / 3);
  return polynomial * std::exp(-z);
}

MaternTable::MaternTable(double nu) : nu_(nu), scale_(argument_scale(nu)) {
  constexpr int n = n_coefficients;
  Eigen::Vector<double, n> nodes;
  Eigen::Matrix<double, n, n> powers;
  for (int i = 0; i < n; ++i) {
    nodes[i] = std::cos((i + 0.5) / n * std::numbers::pi);
    for (int k = 0; k < n; ++k) powers(i, k) = std::pow(nodes[i], k);
  }
  const Eigen::PartialPivLU<Eigen::Matrix<double, n, n>> interpolation(powers);
  for (double binade = smallest_argument; binade < largest_argument; binade *= 2)
    for (int quarter = 0; quarter < 4; ++quarter) {
      const double half_width = binade / 8;
      Segment segment{binade + (2 * quarter + 1) * half_width, 1 / half_width, {}};
      Eigen::Vector<double, n> values;
      for (int i = 0; i < n; ++i)
        values[i] = -log_matern(nu_, (segment.centre + nodes[i] * half_width) / scale_);
      Eigen::Map<Eigen::Vector<double, n>>(segment.coefficients.data()) =
          interpolation.solve(values);
      segments_.push_back(segment);
    }
}

double MaternTable::rho(double x) const {
  const double v = x * scale_;
  if (v < smallest_argument) return std::exp(log_matern_near_zero(nu_, std::sqrt(2 * nu_) * x));
  if (!(v < largest_argument)) return 0;
  // Exponent and two leading bits of the fraction count the quarters of binades.
  const auto quarter_index = [](double value) { return std::bit_cast<std::uint64_t>(value) >> 50; };
  const Segment& segment = segments_[quarter_index(v) - quarter_index(smallest_argument)];
  const double t = (v - segment.centre) * segment.inverse_half_width;
  const double square = t * t;
  double even = 0, odd = 0;  // two short chains of operations rather than one long one
  for (int k = n_coefficients - 2; k >= 0; k -= 2) {
    even = even * square + segment.coefficients[k];
    odd = odd * square + segment.coefficients[k + 1];
  }
  return std::exp(-std::max(0.0, even + t * odd));
}

}  // namespace roughmesh::detail
