// SPDX-License-Identifier: BSD-3-Clause
#include "scale_mixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "convex_fit.hpp"
#include "mixture_samples.hpp"
#include "mixture_space.hpp"

namespace roughmesh::detail {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::array steps_per_octave = {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0};

// Shares of the tolerance: what rho may be where samples end, rounding of the weights, the fit.
constexpr double end_share = 1.0 / 32, rounding_share = 1.0 / 64;
constexpr double fit_share = 0.95, fit_share_of_several_axes = 0.9;  // with more between samples
// Variance of scales so small that the ladder need not reach them.
constexpr double small_scale_share = 1.0 / 4;

constexpr double least_scale = 1e-20;  // in correlation lengths
constexpr double finest_quantum = 0x1p-48;

// A ladder beyond the first that fits is tried for the terms it may save, if it is this short.
constexpr Index longest_ladder_tried = 64;
constexpr int most_ladders_tried = 3;

void check_options(const ScaleMixtureOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw InputError(
        fmt::format("--tolerance is {}; it must be between 0 and 1, exclusive", options.tolerance));
  if (!(options.smallest_scale > 0 && std::isfinite(options.smallest_scale)))
    throw InputError(
        fmt::format("the smallest scale of a Gaussian mixture is {}; it must be greater than 0 and "
                    "finite",
                    options.smallest_scale));
}

// A ladder of so many octaves would be a mistake.
void check_smallest_scale(const Autocorrelation& autocorrelation,
                          const ScaleMixtureOptions& options) {
  const double least = least_scale * autocorrelation.length();
  if (options.smallest_scale >= least) return;
  throw InputError(
      fmt::format("the smallest scale of a Gaussian mixture is {}; it must be at least {} of the "
                  "correlation length {}",
                  options.smallest_scale, least_scale, autocorrelation.length()));
}

std::string described(const Autocorrelation& autocorrelation) {
  std::string family(name(autocorrelation.family()));
  switch (autocorrelation.family()) {
    case Family::matern:
      return fmt::format("{} with --nu {}", family, autocorrelation.shape());
    case Family::self_affine:
      return fmt::format("{} with --hurst {}", family, autocorrelation.shape());
    case Family::stretched:
      return fmt::format("{} with --power {}", family, autocorrelation.shape());
    case Family::rational_quadratic:
      return fmt::format("{} with --alpha {}", family, autocorrelation.shape());
    case Family::gaussian:
    case Family::exponential:
    case Family::table:
      break;
  }
  return family;
}

// Mixtures known without a fit.
std::vector<GaussianTerm> known_terms(const Autocorrelation& autocorrelation) {
  const double length = autocorrelation.length();
  if (autocorrelation.family() == Family::gaussian) return {{1, length}};
  if (autocorrelation.family() == Family::stretched && autocorrelation.shape() == 2)
    return {{1, length / std::numbers::sqrt2}};
  if (autocorrelation.family() != Family::table) return {};
  const auto terms = autocorrelation.gaussian_terms();
  if (terms.empty())
    throw InputError(
        fmt::format("--table is met by no mixture of Gaussians to 0.02 (the best leaves {:.3g}), "
                    "which --method lattice needs; use --method cholesky",
                    *autocorrelation.fit_residual()));
  return {terms.begin(), terms.end()};
}

double value_at(const ScaleMixture& mixture, const MixtureSpace& space,
                const MixtureSpace::Coordinates& x) {
  double sum = 0;
  for (const MixtureTerm& term : mixture.terms) sum += term.weight * space.gaussian(x, term.scale);
  return sum;
}

// Rounds the weights to multiples of the quantum, a power of 2. What they lack of 1 is the nugget,
// or, without one, goes to the largest.
void round_weights(ScaleMixture& mixture, double quantum) {
  std::vector<MixtureTerm>& terms = mixture.terms;
  double lack = 1;
  for (MixtureTerm& term : terms) {
    term.weight = std::round(term.weight / quantum) * quantum;
    lack -= term.weight;
  }
  const bool has_nugget = lack > 0 && (terms.empty() || mixture.nugget > quantum / 2);
  mixture.nugget = has_nugget ? lack : 0;
  if (!has_nugget && !terms.empty())
    std::max_element(terms.begin(), terms.end(), [](const MixtureTerm& a, const MixtureTerm& b) {
      return a.weight < b.weight;
    })->weight += lack;
  std::erase_if(terms, [](const MixtureTerm& term) { return !(term.weight > 0); });
}

// The terms as they are; the smallest ones, which do not reach the shortest distance, go into the
// nugget.
ScaleMixture known_mixture(const std::vector<GaussianTerm>& terms, const MixtureSpace& space,
                           const ScaleMixtureOptions& options) {
  ScaleMixture result;
  std::array<double, MixtureSpace::most_axes> lost{};  // at the shortest distance on each axis
  int level = 0;
  for (const GaussianTerm& term : space.shares(terms)) {
    if (term.scale >= options.smallest_scale) {
      result.terms.push_back({level, term.scale, term.weight});
    } else {
      result.nugget += term.weight;
      for (std::size_t axis = 0; axis < space.n_axes(); ++axis) {
        MixtureSpace::Coordinates x{};
        x[axis] = shortest_distance(options);
        lost[axis] += term.weight * space.gaussian(x, term.scale);
      }
    }
    ++level;
  }
  round_weights(result, finest_quantum);
  result.residual = *std::max_element(lost.begin(), lost.end());
  return result;
}

// Samples for the fit and, closer together, for the check.
struct Comparison {
  Comparison(const Autocorrelation& autocorrelation, const MixtureSpace& space,
             const ScaleMixtureOptions& options)
      : target(autocorrelation, space, shortest_distance(options)),
        reach(target.reach(end_share * options.tolerance)),
        fit(target, reach, {.on_axes = 12, .of_grid = space.n_axes() < 3 ? 3 : 2}),
        check(target, reach, {.on_axes = 36, .of_grid = space.n_axes() < 3 ? 6 : 4}) {}

  // Of the tolerance.
  double accepted_share() const {
    return target.space().n_axes() == 1 ? fit_share : fit_share_of_several_axes;
  }

  MixtureTarget target;
  double reach;
  MixtureSamples fit, check;
};

// The variance of scales below s is at most (1 - rho(r)) / (1 - exp(-r^2 / (2 s^2))) for any r.
// Sums over images hold less of it.
double smallest_scale(const Autocorrelation& autocorrelation, const ScaleMixtureOptions& options) {
  const double negligible = small_scale_share * options.tolerance * -std::expm1(-2.0);
  double scale = autocorrelation.length();
  while (scale > options.smallest_scale && 1 - autocorrelation.rho(2 * scale) > negligible)
    scale /= 1.25;
  return std::max(scale, options.smallest_scale);
}

// The variance of scales above s is at most rho(r) exp(r^2 / (2 s^2)) for any r, under sums over
// images as well. Infinite where rho does not become small.
double largest_scale(const MixtureTarget& target, double negligible) {
  constexpr double accuracy = 1e-13;  // of rho
  const MixtureSpace& space = target.space();
  const double reach = target.reach(10 * accuracy);
  double largest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < space.n_axes(); ++axis) {
    const double end = space.period(axis) > 0 ? space.period(axis) / 2 : 2 * reach;
    for (double r = target.nearest(); r <= end; r *= std::numbers::sqrt2) {
      MixtureSpace::Coordinates x{};
      x[axis] = r;
      const double excess = std::log(negligible / (target(x) + accuracy));
      if (excess > 0) largest = std::min(largest, r / std::sqrt(2 * excess));
    }
  }
  return largest;
}

struct LadderRange {
  double smallest = 0, largest = 0;
};

// Columns of a fit: the Gaussians of a ladder, and the nugget, which is 0 wherever rho is sampled.
struct Ladder {
  double steps = 1;  ///< per octave
  int lowest_level = 0;
  std::vector<double> scales;
  Eigen::MatrixXd columns;

  Index n_scales() const { return static_cast<Index>(scales.size()); }
};

Eigen::MatrixXd with_nugget(const std::vector<VectorXd>& gaussians) {
  const auto n = static_cast<Index>(gaussians.size());
  Eigen::MatrixXd columns(gaussians.front().size(), n + 1);
  for (Index k = 0; k < n; ++k) columns.col(k) = gaussians[k];
  columns.col(n).setZero();
  return columns;
}

// Up to the largest scale, or the first whose Gaussian is constant over the samples.
Ladder make_ladder(const Comparison& comparison, const LadderRange& range, double steps,
                   double tolerance) {
  const double length = comparison.target.autocorrelation().length();
  Ladder ladder{.steps = steps, .scales = {}, .columns = {}};
  ladder.lowest_level = static_cast<int>(std::ceil(steps * std::log2(range.smallest / length)));
  std::vector<VectorXd> gaussians;
  do {
    const double level = ladder.lowest_level + static_cast<double>(gaussians.size());
    ladder.scales.push_back(length * std::exp2(level / steps));
    gaussians.push_back(comparison.fit.gaussian(ladder.scales.back()));
  } while (ladder.scales.back() < range.largest &&
           gaussians.back().minCoeff() < 1 - end_share * tolerance);
  ladder.columns = with_nugget(gaussians);
  return ladder;
}

class LadderFit {
 public:
  LadderFit(const Comparison& comparison, Ladder ladder, double tolerance)
      : comparison_(comparison),
        ladder_(std::move(ladder)),
        tolerance_(tolerance),
        fit_(ladder_.columns, comparison.fit.target()) {
    fit_.solve();
    weights_ = fit_.weights();
    residual_ = largest_difference(ladder_.columns, weights_, comparison_.fit.target());
    if (!is_met()) return;
    std::vector<VectorXd> gaussians;
    for (const double scale : ladder_.scales)
      gaussians.push_back(comparison_.check.gaussian(scale));
    check_columns_ = with_nugget(gaussians);
    residual_ = checked_residual(weights_);
  }

  double residual() const { return residual_; }
  bool is_met() const { return residual_ <= accepted(); }

  /// Leaves out what the fit can do without: the finest scales first, since they cost most, and the
  /// nugget last.
  void prune() {
    for (Index k = 0; k < weights_.size(); ++k) {
      ConvexFit trial = fit_;
      trial.leave_out(k);
      VectorXd weights = weights_;
      if (weights_[k] > 0) {
        trial.solve();
        weights = trial.weights();
        if (!is_met_by(weights)) continue;
      }
      fit_ = std::move(trial);
      weights_ = std::move(weights);
    }
  }

  ScaleMixture mixture() const {
    ScaleMixture result;
    for (Index k = 0; k < ladder_.n_scales(); ++k)
      result.terms.push_back(
          {ladder_.lowest_level + static_cast<int>(k), ladder_.scales[k], weights_[k]});
    result.nugget = weights_[ladder_.n_scales()];
    const auto n_terms = static_cast<double>((weights_.array() > 0).count());
    round_weights(result,
                  std::exp2(std::floor(std::log2(2 * rounding_share * tolerance_ / n_terms))));
    result.ratio = std::exp2(1 / ladder_.steps);
    result.residual = final_residual(result);
    return result;
  }

 private:
  double accepted() const { return comparison_.accepted_share() * tolerance_; }

  static double largest_difference(const Eigen::MatrixXd& columns, const VectorXd& weights,
                                   const VectorXd& target) {
    VectorXd difference = -target;
    for (Index k = 0; k < weights.size(); ++k)
      if (weights[k] > 0) difference += weights[k] * columns.col(k);
    return difference.cwiseAbs().maxCoeff();
  }

  // Fewer samples first.
  bool is_met_by(const VectorXd& weights) const {
    return !weights.isZero(0) &&
           largest_difference(ladder_.columns, weights, comparison_.fit.target()) <= accepted() &&
           checked_residual(weights) <= accepted();
  }

  double checked_residual(const VectorXd& weights) const {
    return largest_difference(check_columns_, weights, comparison_.check.target());
  }

  double final_residual(const ScaleMixture& mixture) const {
    VectorXd weights = VectorXd::Zero(weights_.size());
    for (const MixtureTerm& term : mixture.terms)
      weights[term.level - ladder_.lowest_level] = term.weight;
    return residual_beyond(mixture, checked_residual(weights));
  }

  // The larger of a residual and that beyond the samples, where rho and mixture decrease.
  double residual_beyond(const ScaleMixture& mixture, double residual) const {
    const MixtureTarget& target = comparison_.target;
    MixtureSpace::Coordinates x{};
    double& r = x[target.space().n_axes() - 1];
    r = comparison_.reach;
    if (target.space().is_bounded() || target(x) > end_share * tolerance_) return residual;
    for (;; r *= 1.02) {
      const double rho = target(x), value = value_at(mixture, target.space(), x);
      if (std::max(rho, value) <= residual) return residual;
      residual = std::max(residual, std::abs(rho - value));
    }
  }

  const Comparison& comparison_;
  Ladder ladder_;
  double tolerance_;
  ConvexFit fit_;
  VectorXd weights_;
  Eigen::MatrixXd check_columns_;
  double residual_ = 0;
};

bool is_cheaper(const ScaleMixture& a, const ScaleMixture& b) {
  if (a.terms.size() != b.terms.size()) return a.terms.size() < b.terms.size();
  return !a.terms.empty() && a.terms.front().scale > b.terms.front().scale;
}

[[noreturn]] void refuse(const Autocorrelation& autocorrelation, double tolerance, double reached) {
  throw NumericalError(
      fmt::format("{} is met by no Gaussian mixture of --method lattice to {:.3g}: the closest "
                  "leaves {:.3g}; choose a larger --tolerance or --method cholesky",
                  described(autocorrelation), tolerance, reached));
}

// The first ladder that meets rho, or one of the next, if it is short and saves terms.
ScaleMixture fitted_mixture(const Autocorrelation& autocorrelation, const MixtureSpace& space,
                            const ScaleMixtureOptions& options) {
  const Comparison comparison(autocorrelation, space, options);
  const LadderRange range = {smallest_scale(autocorrelation, options),
                             largest_scale(comparison.target, end_share * options.tolerance)};
  std::optional<ScaleMixture> best;
  double closest = 1;
  int n_tried = 0;
  for (const double steps : steps_per_octave) {
    Ladder ladder = make_ladder(comparison, range, steps, options.tolerance);
    if (best && ladder.n_scales() > longest_ladder_tried) break;
    LadderFit fit(comparison, std::move(ladder), options.tolerance);
    closest = std::min(closest, fit.residual());
    if (fit.is_met()) {
      fit.prune();
      const ScaleMixture mixture = fit.mixture();
      if (!best || is_cheaper(mixture, *best)) best = mixture;
    }
    if (best && ++n_tried == most_ladders_tried) break;
  }
  if (!best) refuse(autocorrelation, options.tolerance, closest);
  return *best;
}

}  // namespace

double shortest_distance(const ScaleMixtureOptions& options) {
  return options.smallest_scale * std::sqrt(-2 * std::log(options.tolerance));
}

double smallest_scale(double shortest_distance, double tolerance) {
  return shortest_distance / std::sqrt(-2 * std::log(tolerance));
}

ScaleMixture fit_scale_mixture(const Autocorrelation& autocorrelation, const Distance& distance,
                               const ScaleMixtureOptions& options) {
  check_options(options);
  const MixtureSpace space(distance);
  const std::vector<GaussianTerm> terms = known_terms(autocorrelation);
  if (!terms.empty()) return known_mixture(terms, space, options);
  check_smallest_scale(autocorrelation, options);
  return fitted_mixture(autocorrelation, space, options);
}

double mixture_value(const ScaleMixture& mixture, const MixtureSpace& space,
                     const Vec3& displacement) {
  const MixtureSpace::Coordinates x = space.coordinates(displacement);
  const bool is_0 = std::all_of(x.begin(), x.end(), [](double along) { return along == 0; });
  return value_at(mixture, space, x) + (is_0 ? mixture.nugget : 0);
}

}  // namespace roughmesh::detail
