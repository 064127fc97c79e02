// SPDX-License-Identifier: BSD-3-Clause
#include "autocorrelation_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "quadrature.hpp"
#include "spectrum_share.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t least_pairs = 3;
constexpr std::size_t most_fitted_pairs = 2000;
constexpr double largest_residual = 0.02;
constexpr double largest_end = 0.1;
constexpr double largest_error_at_0 = 1e-6;

void check_pairs(std::span<const CorrelationPair> pairs) {
  if (pairs.size() < least_pairs)
    throw InputError(fmt::format("--table has {} pairs of r and rho; give at least {}",
                                 pairs.size(), least_pairs));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (const std::string flaw = flaw_of_pair(pairs, i); !flaw.empty())
      throw InputError(fmt::format("--table, pair {}: {}", i + 1, flaw));
  if (pairs.back().rho > largest_end)
    throw InputError(
        fmt::format("--table ends at r = {} with rho = {}: not decayed; give pairs up to where rho "
                    "stays below {}",
                    pairs.back().r, pairs.back().rho, largest_end));
}

// rho(0) = 1 in front where the table starts later.
std::vector<CorrelationPair> with_origin(std::span<const CorrelationPair> pairs) {
  std::vector<CorrelationPair> result;
  if (pairs.front().r > 0) result.push_back({0, 1});
  result.insert(result.end(), pairs.begin(), pairs.end());
  result.front().rho = 1;
  return result;
}

// Evenly thinned, ends included: a fit of a few dozen terms gains nothing from more.
std::vector<CorrelationPair> thinned(std::span<const CorrelationPair> pairs) {
  if (pairs.size() <= most_fitted_pairs) return {pairs.begin(), pairs.end()};
  std::vector<CorrelationPair> result;
  for (std::size_t k = 0; k < most_fitted_pairs; ++k)
    result.push_back(pairs[k * (pairs.size() - 1) / (most_fitted_pairs - 1)]);
  return result;
}

// Scales from a quarter of the first distance, so that a Gaussian may vanish before the first pair,
// to eight times the last, which is flat over the table. A ladder of ratio 2^(1/8) meets a Gaussian
// between two rungs to 1.2e-3, and usually to 4e-4.
GaussianMixture fit(std::span<const CorrelationPair> pairs) {
  constexpr double largest_span = 1e6;  // of scales, a table of one close pair and far ones
  const double largest = 8 * pairs.back().r;
  const double smallest = std::max(pairs[1].r / 4, largest / largest_span);
  GaussianMixture mixture = fit_gaussian_mixture(
      thinned(pairs),
      {.smallest_scale = smallest, .largest_scale = largest, .ratio = std::exp2(0.125)});
  for (const CorrelationPair& pair : pairs)
    mixture.residual =
        std::max(mixture.residual, std::abs(mixture_rho(mixture.terms, pair.r) - pair.rho));
  return mixture;
}

MonotoneCubic interpolant(std::span<const CorrelationPair> pairs) {
  std::vector<double> r, rho;
  for (const CorrelationPair& pair : pairs) {
    r.push_back(pair.r);
    rho.push_back(pair.rho);
  }
  return {std::move(r), std::move(rho)};
}

// Gauss-Legendre rule of 5 points on n equal parts.
template <class Function>
double integrate(double begin, double end, std::size_t n, const Function& f) {
  constexpr double near = 0.5384693101056831, far = 0.9061798459386640;
  constexpr double middle_weight = 0.5688888888888889, near_weight = 0.4786286704993665,
                   far_weight = 0.2369268850561891;
  const double half = (end - begin) / static_cast<double>(n) / 2;
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double x = begin + static_cast<double>(2 * k + 1) * half;
    sum += middle_weight * f(x) + near_weight * (f(x - near * half) + f(x + near * half)) +
           far_weight * (f(x - far * half) + f(x + far * half));
  }
  return sum * half;
}

}  // namespace

std::string flaw_of_pair(std::span<const CorrelationPair> pairs, std::size_t i) {
  const CorrelationPair& pair = pairs[i];
  if (!std::isfinite(pair.r) || !std::isfinite(pair.rho))
    return fmt::format("r = {}, rho = {}; both must be finite numbers", pair.r, pair.rho);
  if (pair.r < 0) return fmt::format("r = {}; a distance must be at least 0", pair.r);
  if (i > 0 && !(pair.r > pairs[i - 1].r))
    return fmt::format("r = {} after {}; distances must increase", pair.r, pairs[i - 1].r);
  if (pair.r == 0 && std::abs(pair.rho - 1) > largest_error_at_0)
    return fmt::format("rho(0) = {}; it must be 1: divide all values by the variance", pair.rho);
  if (std::abs(pair.rho) > 1 + largest_error_at_0)
    return fmt::format("rho = {}; it must lie between -1 and 1", pair.rho);
  return {};
}

AutocorrelationTable::AutocorrelationTable(std::span<const CorrelationPair> pairs) {
  check_pairs(pairs);
  const std::vector<CorrelationPair> all = with_origin(pairs);
  mixture_ = fit(all);
  if (mixture_.residual > largest_residual) interpolant_ = interpolant(all);
}

std::span<const GaussianTerm> AutocorrelationTable::terms() const {
  return interpolant_ ? std::span<const GaussianTerm>() : mixture_.terms;
}

double AutocorrelationTable::rho(double r) const {
  if (r == 0) return 1;
  // The weights add up to 1 but for rounding.
  if (!interpolant_) return std::min(mixture_rho(mixture_.terms, r), 1.0);
  return r > interpolant_->nodes().back() ? 0 : (*interpolant_)(r);
}

// The first node at or below the level ends the interval in which a bisection finds it.
double AutocorrelationTable::decay_distance(double level) const {
  double low = 0, high = 0;
  if (interpolant_) {
    for (const double node : interpolant_->nodes()) {
      low = high;
      high = node;
      if (rho(node) <= level) break;
    }
  } else {
    high = mixture_.terms.front().scale;
    while (rho(high) > level) high *= 2;
  }
  for (int halvings = 0; halvings < 100; ++halvings) {
    const double middle = (low + high) / 2;
    (rho(middle) > level ? low : high) = middle;
  }
  return high;
}

double AutocorrelationTable::integral() const {
  if (interpolant_) return interpolant_->integral();
  double sum = 0;
  for (const GaussianTerm& term : mixture_.terms)
    sum += term.weight * term.scale * std::sqrt(std::numbers::pi / 2);
  return sum;
}

std::optional<double> AutocorrelationTable::slope_variance() const {
  if (interpolant_) return {};
  double sum = 0;
  for (const GaussianTerm& term : mixture_.terms) sum += term.weight / term.scale / term.scale;
  return sum;
}

double AutocorrelationTable::spectrum_share_above(double q, int dimension) const {
  if (interpolant_) return interpolant_share(q, dimension);
  double sum = 0;
  for (const GaussianTerm& term : mixture_.terms)
    sum +=
        term.weight * detail::spectrum_share_above(Family::gaussian, 0, q * term.scale, dimension);
  return sum;
}

// The interpolant need not be positive definite, so that its share may leave [0, 1]: it is cut
// there. For large q only the corner of rho at 0 counts, whose share is that of an exponential.
double AutocorrelationTable::interpolant_share(double q, int dimension) const {
  constexpr double large = 1e5;  // radians over the table
  const auto nodes = interpolant_->nodes();
  if (q * nodes.back() > large) {
    const double share = -interpolant_->first_slope() / q;
    return std::clamp(dimension == 2 ? share : share * 2 / std::numbers::pi, 0.0, 1.0);
  }
  const auto integrand = [&](double r) {
    const double rho = (*interpolant_)(r);
    if (dimension == 2) return q * rho * std::cyl_bessel_j(1, q * r);
    return 2 / std::numbers::pi * rho * (r > 0 ? std::sin(q * r) / r : q);
  };
  double below = 0;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const auto n = static_cast<std::size_t>(q * (nodes[i + 1] - nodes[i])) + 1;
    below += integrate(nodes[i], nodes[i + 1], n, integrand);
  }
  return std::clamp(1 - below, 0.0, 1.0);
}

}  // namespace roughmesh::detail
