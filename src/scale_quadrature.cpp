// SPDX-License-Identifier: BSD-3-Clause
// The laws of the random scale L are those of docs/math.md, eq. 14; here in t = log(L^2 / l^2). As
// a function of t a Gaussian of r is analytic for |Im t| < pi / 2, and so are the densities used
// here, so that the trapezoidal rule of step 0.25 is exact to 1e-15.
#include "scale_quadrature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "gamma_function.hpp"
#include "quadrature.hpp"
#include "stable_law.hpp"

namespace roughmesh::detail {
namespace {

using Terms = std::vector<GaussianTerm>;

constexpr double step = 0.25;
constexpr double negligible = 42;  // exp(-42) = 6e-19

double log_square(double scale, double length) { return 2 * std::log(scale / length); }

// e^t - 1 - t, whose large factor nu must not meet the difference of nearly equal numbers.
double exp_remainder(double t) {
  if (std::abs(t) > 0.1) return std::expm1(t) - t;
  double sum = 0;
  for (int n = 12; n > 2; --n) sum = (1 + sum) * t / n;  // 0.1^11 / 13! is below 1e-20
  return (1 + sum) * t * t / 2;
}

// L^2 = l^2 e^t with nu e^t ~ Gamma(nu). The largest scales end like exp(-nu e^t).
Terms matern_terms(double nu, double length, const ScaleRange& range, int n_sums) {
  const double h = std::min(step, 0.6 / std::sqrt(nu)), constant = log_scaled_gamma(nu);
  Terms terms;
  const auto exponent = [&](double t) { return nu * exp_remainder(t); };
  const auto add = [&](double t) {
    terms.push_back({h * std::exp(-exponent(t) - constant), length * std::exp(t / 2)});
  };
  const double growth = 0.5 * n_sums;  // of the sum over images, with the scale
  for (double k = 0; exponent(k * h) - growth * k * h < negligible; ++k) add(k * h);
  const double lowest = log_square(range.smallest, length);
  for (double k = -1; k * h > lowest && exponent(k * h) < negligible; --k) add(k * h);
  return terms;
}

// L^2 = l^2 e^t with a e^-t ~ Gamma(a). The largest scales fall off like exp(-a t), the sum over
// images like exp(-(a - n/2) t): a geometric series, whose rest the last term stands for.
Terms rational_quadratic_terms(double a, double length, const ScaleRange& range, int n_sums) {
  constexpr double alike = 50;  // in t: scales 1e10 times as large as all that is summed over
  const double h = std::min(step, 0.6 / std::sqrt(a)), constant = log_scaled_gamma(a);
  Terms terms;
  const auto exponent = [&](double t) { return a * exp_remainder(-t); };
  const auto add = [&](double t) {
    terms.push_back({h * std::exp(-exponent(t) - constant), length * std::exp(t / 2)});
  };
  const double lowest = log_square(range.smallest, length);
  for (double k = -1; k * h > lowest && exponent(k * h) < negligible; --k) add(k * h);
  const double growth = 0.5 * n_sums, decay = a - growth;
  const double highest = std::max(0.0, log_square(range.largest, length)) + alike;
  for (double k = 0; k * h < highest && exponent(k * h) - growth * k * h < negligible; ++k)
    add(k * h);
  terms.back().weight /= -std::expm1(-decay * h);
  return terms;
}

// Weights that give the value at `place`, 0 to 1 from the sixth to the seventh of twelve
// equidistant nodes, of their interpolation polynomial.
constexpr int n_nodes = 12;
std::array<double, n_nodes> interpolation_weights(double place) {
  std::array<double, n_nodes> weights{};
  for (int i = 0; i < n_nodes; ++i) {
    weights[i] = 1;
    for (int j = 0; j < n_nodes; ++j)
      if (j != i) weights[i] *= (place + 5 - j) / (i - j);
  }
  return weights;
}

// Terms at arbitrary t moved to a grid: a Gaussian as a function of t is interpolated to 1e-13.
class TermGrid {
 public:
  void add(double t, double weight) {
    const double place = std::floor(t / spacing);
    const auto weights = interpolation_weights(t / spacing - place);
    for (int i = 0; i < n_nodes; ++i)
      weight_at_[static_cast<int>(place) - 5 + i] += weight * weights[i];
  }
  Terms terms(double length) const {
    Terms result;
    for (const auto& [place, weight] : weight_at_)
      result.push_back({weight, length * std::exp(place * spacing / 2)});
    return result;
  }

 private:
  static constexpr double spacing = 0.05;
  std::map<int, double> weight_at_;
};

// log of a W beyond which exp(-W) is negligible, even times the sum over images, which grows like
// W^(3 kappa / 2) at most.
double log_largest_exponential(double kappa) { return std::log(100 + 6 * kappa); }

// L^2 = l^2 / (2 S) with S = (A(U) / W)^kappa. For kappa < 1 the law of S has a steep side, and the
// mean over W inside that over U is the one that is smooth.
Terms steep_stable_terms(double alpha, double length, const ScaleRange& range) {
  const double kappa = 1 / alpha - 1, lowest = log_square(range.smallest, length);
  TermGrid grid;
  const auto add_angle = [&](double u, double rest, double share) {
    const double log_a = log_kanter(alpha, u, rest);
    for (double log_w = log_largest_exponential(kappa); log_w > -negligible; log_w -= step) {
      const double t = -std::log(2.0) - kappa * (log_a - log_w);
      if (t < lowest) break;
      grid.add(t, share * step * std::exp(log_w - std::exp(log_w)));
    }
  };
  tanh_sinh_nodes(std::numbers::pi, [&](double from_left, double from_right, double weight) {
    if (weight > 0) add_angle(from_left, from_right, weight / std::numbers::pi);
  });
  return grid.terms(length);
}

// For kappa >= 1 the density of log S is the smooth one.
Terms wide_stable_terms(double alpha, double length, const ScaleRange& range) {
  const double kappa = 1 / alpha - 1;
  const double log_least_a = std::log(1 - alpha) + alpha / (1 - alpha) * std::log(alpha);
  const double first = kappa * (log_least_a - log_largest_exponential(kappa));
  const double last = -std::log(2.0) - log_square(range.smallest, length);
  Terms terms;
  for (double log_s = first; log_s < last; log_s += step) {
    const double density = tanh_sinh(std::numbers::pi, [&](double u, double rest) {
      const double log_w = log_kanter(alpha, u, rest) - log_s / kappa;
      return std::exp(log_w - std::exp(std::min(log_w, 100.0)));
    });
    terms.push_back({step * density / kappa / std::numbers::pi,
                     length * std::exp(-log_s / 2) / std::numbers::sqrt2});
  }
  return terms;
}

Terms stretched_terms(double power, double length, const ScaleRange& range, int n_sums) {
  if (power == 2) return {{1, length / std::numbers::sqrt2}};
  if (power == 1) return matern_terms(0.5, length, range, n_sums);
  return power > 1 ? steep_stable_terms(power / 2, length, range)
                   : wide_stable_terms(power / 2, length, range);
}

}  // namespace

std::vector<GaussianTerm> scale_quadrature(const Autocorrelation& autocorrelation,
                                           const ScaleRange& range, int n_sums) {
  const double length = autocorrelation.length(), shape = autocorrelation.shape();
  Terms terms;
  switch (autocorrelation.family()) {
    case Family::gaussian:
      terms = {{1, length}};
      break;
    case Family::exponential:
      terms = matern_terms(0.5, length, range, n_sums);
      break;
    case Family::matern:
    case Family::self_affine:
      terms = matern_terms(shape, length, range, n_sums);
      break;
    case Family::stretched:
      terms = stretched_terms(shape, length, range, n_sums);
      break;
    case Family::rational_quadratic:
      terms = rational_quadratic_terms(shape, length, range, n_sums);
      break;
    case Family::table: {
      const auto fit = autocorrelation.gaussian_terms();
      terms.assign(fit.begin(), fit.end());
      break;
    }
  }
  std::erase_if(terms, [&](const GaussianTerm& term) {
    return term.weight == 0 || term.scale < range.smallest;
  });
  return terms;
}

}  // namespace roughmesh::detail
