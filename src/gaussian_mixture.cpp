// SPDX-License-Identifier: BSD-3-Clause
#include "gaussian_mixture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "convex_fit.hpp"

namespace roughmesh::detail {
namespace {

double gaussian(double r, double scale) {
  const double x = r / scale;
  return std::exp(-x * x / 2);
}

std::vector<double> ladder(const MixtureFitOptions& options) {
  constexpr double most_scales = 10'000;
  const double span = std::log(options.largest_scale / options.smallest_scale);
  const double n_steps = std::ceil(span / std::log(options.ratio) * (1 - 1e-12));
  if (!(options.smallest_scale > 0 && options.ratio > 1 && n_steps >= 0 && n_steps < most_scales))
    throw InputError(fmt::format("a ladder of scales from {} to {} by ratio {} is out of range",
                                 options.smallest_scale, options.largest_scale, options.ratio));
  std::vector<double> scales;
  for (double k = 0; k <= n_steps; ++k)
    scales.push_back(options.smallest_scale * std::exp(n_steps > 0 ? span * k / n_steps : 0));
  return scales;
}

}  // namespace

double mixture_rho(std::span<const GaussianTerm> terms, double r) {
  double sum = 0;
  for (const GaussianTerm& term : terms) sum += term.weight * gaussian(r, term.scale);
  return sum;
}

GaussianMixture fit_gaussian_mixture(std::span<const CorrelationPair> samples,
                                     const MixtureFitOptions& options) {
  const std::vector<double> scales = ladder(options);
  const auto m = static_cast<Eigen::Index>(samples.size());
  const auto n = static_cast<Eigen::Index>(scales.size());
  Eigen::MatrixXd columns(m, n);
  Eigen::VectorXd target(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    target[i] = samples[i].rho;
    for (Eigen::Index k = 0; k < n; ++k) columns(i, k) = gaussian(samples[i].r, scales[k]);
  }
  ConvexFit fit(columns, target);
  fit.solve();
  const Eigen::VectorXd weights = fit.weights();

  GaussianMixture result;
  for (Eigen::Index k = 0; k < n; ++k)
    if (weights[k] > 0) result.terms.push_back({weights[k], scales[k]});
  for (const CorrelationPair& sample : samples)
    result.residual =
        std::max(result.residual, std::abs(mixture_rho(result.terms, sample.r) - sample.rho));
  return result;
}

}  // namespace roughmesh::detail
