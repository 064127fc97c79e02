// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "nearest.hpp"

namespace roughmesh::detail {
namespace {

// Shares of the tolerance. One Gaussian leaves all of it to the lattice.
constexpr double mixture_share = 0.35;
constexpr double nugget_share = 0.15;
constexpr double lattice_share = 1 - mixture_share - nugget_share;

constexpr double polynomial_share = 0.1;  // of the lattices', where terms are coarse

// Terms at least this smooth, in typical distances of neighbours, are summed from coarse to fine:
// then a cell has enough places to pay for its nodes.
constexpr double coarse_distance = 10;

// Sizes of cells. A number that depended on the places would make heights depend on them.
constexpr int n_coarse_stages = 12;

// Places nearer to each other than this part of the correlation length are one: their nuggets are.
constexpr double same_place = 0x1p-30;

ScaleMixture fit(const Correlation& correlation, double tolerance, double smallest_scale) {
  return fit_scale_mixture(correlation.autocorrelation(), correlation.distance(),
                           {.tolerance = tolerance, .smallest_scale = smallest_scale});
}

LatticeTerms one_term(const Correlation& correlation, double tolerance) {
  LatticeTerms terms;
  terms.mixture = fit(correlation, tolerance, std::numeric_limits<double>::min());
  terms.lattice_error = tolerance;
  return terms;
}

[[noreturn]] void refuse_cutoff(double cutoff) {
  throw InputError(
      fmt::format("--cutoff: {:g}; no part of this autocorrelation has as large a scale, so "
                  "nothing is left; use a smaller one",
                  cutoff));
}

// Cutoffs down to this part of the correlation length are made of one fit, shorter ones of fits
// that reach so many times farther.
constexpr double reach_of_fit = 0x1p-10;

/// The smallest scale of a fit that knows what is below the cutoff; the same for many cutoffs, so
/// that what one of them leaves is part of what a shorter one does.
double scale_below(double cutoff, double length) {
  double scale = length;
  do scale *= reach_of_fit;
  while (scale > cutoff / 4);
  return scale;
}

/// How much of each term is above the cutoff. A term of a fitted mixture stands for the scales up
/// to the middle of the way to the next ones, evenly in their logarithm, so that the variance falls
/// steadily with the cutoff; one of an exact mixture stands for itself.
void cut(ScaleMixture& mixture, double cutoff) {
  std::vector<MixtureTerm>& terms = mixture.terms;
  if (mixture.ratio == 1) {
    std::erase_if(terms, [&](const MixtureTerm& term) { return term.scale < cutoff; });
    return;
  }
  const std::vector<MixtureTerm> all = terms;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double scale = all[k].scale;
    const double low = k > 0 ? std::sqrt(all[k - 1].scale * scale) : scale;
    const double high = k + 1 < all.size() ? std::sqrt(scale * all[k + 1].scale) : scale;
    if (cutoff <= low) continue;
    const double share = cutoff < high ? std::log(high / cutoff) / std::log(high / low) : 0;
    terms[k].weight *= share;
  }
  std::erase_if(terms, [](const MixtureTerm& term) { return !(term.weight > 0); });
}

LatticeTerms terms_above_cutoff(const Correlation& correlation, double tolerance, double cutoff) {
  LatticeTerms terms;
  terms.mixture = fit(correlation, mixture_share * tolerance,
                      scale_below(cutoff, correlation.autocorrelation().length()));
  std::vector<MixtureTerm>& kept = terms.mixture.terms;
  cut(terms.mixture, cutoff);
  if (kept.empty()) refuse_cutoff(cutoff);
  terms.mixture.nugget = 0;
  double variance = 0;
  for (const MixtureTerm& term : kept) variance += term.weight;
  terms.lost_variance = std::max(0.0, 1 - variance);
  terms.lattice_error = lattice_share * tolerance;
  terms.distance = cutoff;
  return terms;
}

/// A quarter of the shortest period: a mixture that holds only between the farthest places of a
/// cell would be hard to tell from others. Infinite without a period.
double quarter_cell(const Vec3& period) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const double length : period)
    if (length > 0) shortest = std::min(shortest, length);
  return shortest / 4;
}

/// Images that can be equally near, in the middle of a cell.
double n_nearest_images(const Vec3& period) {
  return std::exp2(static_cast<double>((period.array() > 0).count()));
}

// How near a place may have another one and still do without the first 1, 2, ... terms: what is
// lost of their covariance then stays within `allowed`.
std::vector<double> distances_to_skip(std::span<const MixtureTerm> terms, double allowed) {
  std::vector<double> distances;
  double far = 0;
  for (std::size_t n = 1; n <= terms.size(); ++n) {
    const auto lost = [&](double r) {
      double sum = 0;
      for (const MixtureTerm& term : terms.first(n))
        sum += term.weight * std::exp(-0.5 * (r / term.scale) * (r / term.scale));
      return sum;
    };
    double near = far;
    far = std::max(far, terms[n - 1].scale * std::sqrt(std::max(0.0, -2 * std::log(allowed))));
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (near + far);
      (lost(middle) > allowed ? near : far) = middle;
    }
    distances.push_back(far);
  }
  return distances;
}

std::vector<std::uint8_t> count_skipped(std::span<const double> nearest,
                                        std::span<const double> distances) {
  const auto last =
      distances.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(distances.size(), 255));
  std::vector<std::uint8_t> result(nearest.size());
  for (std::size_t i = 0; i < nearest.size(); ++i)
    result[i] = static_cast<std::uint8_t>(std::upper_bound(distances.begin(), last, nearest[i]) -
                                          distances.begin());
  return result;
}

// Of the finite ones; 0 without any.
double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

LatticeTerms terms_for_places(const Correlation& correlation, double tolerance,
                              const LatticeSpace& space, const SortedPlaces& places) {
  const Vec3 period(space.period(0), space.period(1), space.period(2));
  const std::vector<double> nearest = nearest_distances(places.places(), period);
  const double length = correlation.autocorrelation().length();
  // Lengths of more than 10^8 periods make same places of all; the quarter cell decides then.
  const double shortest =
      std::min({std::max(*std::min_element(nearest.begin(), nearest.end()), same_place * length),
                length, quarter_cell(period)});
  const double share = mixture_share * tolerance;
  LatticeTerms terms;
  terms.mixture = fit(correlation, share, smallest_scale(shortest, share));
  terms.lattice_error = lattice_share * tolerance;
  terms.distance = median(nearest);
  const double allowed = nugget_share * tolerance / n_nearest_images(period);
  terms.n_skipped = count_skipped(nearest, distances_to_skip(terms.mixture.terms, allowed));
  return terms;
}

LatticeTerms chosen_terms(const Correlation& correlation, const FieldOptions& options,
                          const LatticeSpace& space, const SortedPlaces& places) {
  if (is_one_gaussian(correlation.autocorrelation())) {
    LatticeTerms terms = one_term(correlation, options.tolerance);
    if (terms.mixture.terms.front().scale < options.cutoff.value_or(0))
      refuse_cutoff(*options.cutoff);
    return terms;
  }
  if (options.cutoff) return terms_above_cutoff(correlation, options.tolerance, *options.cutoff);
  return terms_for_places(correlation, options.tolerance, space, places);
}

/// Cells have an edge that the correlation length decides, to a power of 2, so that under a cutoff
/// they are the same on every mesh, unless they have to be enlarged.
void set_cell(double distance, double length, const SortedPlaces& places, CoarseTerms& coarse) {
  coarse.cell = length * std::exp2(std::round(std::log2(coarse_distance * distance / length)));
  for (; places.n_doublings(coarse.cell) > 20; coarse.cell *= 2) coarse.is_enlarged = true;
}

void choose_coarse(double length, const SortedPlaces& places, LatticeTerms& chosen) {
  const std::vector<MixtureTerm>& terms = chosen.mixture.terms;
  chosen.coarse.first = terms.size();
  if (chosen.distance == 0) return;
  set_cell(chosen.distance, length, places, chosen.coarse);
  const auto smooth = std::find_if(terms.begin(), terms.end(), [&](const MixtureTerm& term) {
    return term.scale >= chosen.coarse.cell;
  });
  if (terms.end() - smooth < 2) return;
  chosen.coarse.first = static_cast<std::size_t>(smooth - terms.begin());
  chosen.coarse.n_stages = n_coarse_stages;
  chosen.coarse.error = polynomial_share * chosen.lattice_error;
  chosen.lattice_error -= chosen.coarse.error;
  for (std::uint8_t& n : chosen.n_skipped)
    n = static_cast<std::uint8_t>(std::min<std::size_t>(n, chosen.coarse.first));
}

}  // namespace

bool is_one_gaussian(const Autocorrelation& autocorrelation) {
  return autocorrelation.family() == Family::gaussian ||
         (autocorrelation.family() == Family::stretched && autocorrelation.shape() == 2) ||
         autocorrelation.gaussian_terms().size() == 1;
}

LatticeTerms choose_terms(const Correlation& correlation, const FieldOptions& options,
                          const LatticeSpace& space, const SortedPlaces& places) {
  LatticeTerms terms = chosen_terms(correlation, options, space, places);
  choose_coarse(correlation.autocorrelation().length(), places, terms);
  return terms;
}

}  // namespace roughmesh::detail
