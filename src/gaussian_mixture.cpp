// SPDX-License-Identifier: BSD-3-Clause
#include "gaussian_mixture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "nnls.hpp"

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
  // With sum x = 1, A x - rho = (A - rho 1^T) x. The smallest |(A - rho 1^T) x|^2 + (sum x - 1)^2
  // is taken where x / sum x is the best of all vectors of sum 1: for each direction the factor
  // that is best leaves a monotone function of the first norm.
  const std::vector<double> scales = ladder(options);
  const auto m = static_cast<Eigen::Index>(samples.size());
  const auto n = static_cast<Eigen::Index>(scales.size());
  Eigen::MatrixXd a(m + 1, n);
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      a(i, k) = gaussian(samples[i].r, scales[k]) - samples[i].rho;
  a.row(m).setOnes();
  const Eigen::VectorXd weights = nonnegative_least_squares(a, Eigen::VectorXd::Unit(m + 1, m));

  GaussianMixture result;
  for (Eigen::Index k = 0; k < n; ++k)
    if (weights[k] > 0) result.terms.push_back({weights[k] / weights.sum(), scales[k]});
  for (const CorrelationPair& sample : samples)
    result.residual =
        std::max(result.residual, std::abs(mixture_rho(result.terms, sample.r) - sample.rho));
  return result;
}

}  // namespace roughmesh::detail
