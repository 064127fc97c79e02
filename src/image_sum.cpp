// SPDX-License-Identifier: BSD-3-Clause
#include "image_sum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "periodic_bell.hpp"
#include "scale_quadrature.hpp"

namespace roughmesh::detail {
namespace {

constexpr double negligible = 1e-18;
constexpr std::size_t most_cells = 20'000;

double near_bell(double x, double period, double scale) {
  return bell(x, scale) + bell(x + period, scale) + bell(x - period, scale);
}

// Panels widen with the distance from 0, because the images left out are at least 1.5 of the
// shortest period off the axis.
std::vector<double> make_panels(double range, double shortest_period) {
  if (range == 0) return {};
  std::vector<double> ends = {0};
  while (ends.back() < range)
    ends.push_back(std::min(range, ends.back() + std::max(shortest_period / 4, ends.back() / 8)));
  return ends;
}

// Distance beyond which rho cannot be told from 0.
double distance_of_negligible_rho(const Autocorrelation& autocorrelation) {
  double r = autocorrelation.equivalent_lengths().one_over_e;
  while (autocorrelation.rho(r) > negligible && r < 1e300) r *= 1.25;
  return r;
}

void require_fit(const Autocorrelation& autocorrelation) {
  if (autocorrelation.family() != Family::table || !autocorrelation.gaussian_terms().empty())
    return;
  throw InputError(
      fmt::format("--distance periodic needs a positive definite autocorrelation; this table is "
                  "met by none to 0.02 (the best leaves {:.3g}); choose --distance minimum-image",
                  *autocorrelation.fit_residual()));
}

void require_convergence(const Autocorrelation& autocorrelation, int n_sums) {
  if (autocorrelation.family() != Family::rational_quadratic ||
      2 * autocorrelation.shape() > n_sums)
    return;
  throw InputError(
      fmt::format("rational-quadratic with --alpha {} has no periodic form on {} axes: the sum "
                  "over images diverges; it needs --alpha above {}",
                  autocorrelation.shape(), n_sums, n_sums / 2.0));
}

// The images of exp(-(r / l)^p) add up to about its integral over the periodic axes, in units of
// the cell: l^n Gamma(n / p) / p times the area of the unit sphere. Where that is large, what
// differs from place to place is no more than round-off of the sum.
void require_narrow(const Autocorrelation& autocorrelation, double log_cell, int n_sums) {
  if (autocorrelation.family() != Family::stretched || n_sums == 0) return;
  const double p = autocorrelation.shape(),
               most = -std::log(std::numeric_limits<double>::epsilon());
  const double log_sum = n_sums * std::log(autocorrelation.length()) + std::lgamma(n_sums / p) -
                         std::log(p) - log_cell;
  if (log_sum < most) return;
  throw InputError(fmt::format(
      "--power: {:g}; with so slow a decay the periodic field is constant; use a larger "
      "--power, a shorter --length or --distance minimum-image",
      p));
}

}  // namespace

void require_image_sum(const Autocorrelation& autocorrelation, int n_sums) {
  require_fit(autocorrelation);
  require_convergence(autocorrelation, n_sums);
}

ImageSum::ImageSum(const Autocorrelation& autocorrelation, const Distance& distance,
                   const Vec3& extent)
    : autocorrelation_(autocorrelation) {
  set_axes(distance, extent);
  int n_sums = 0;
  double shortest = std::numeric_limits<double>::infinity(), largest = 0, log_cell = 0;
  for (const Axis& axis : axes_) {
    largest = std::max({largest, axis.period, axis.range});
    if (axis.period == 0) continue;
    ++n_sums;
    shortest = std::min(shortest, axis.period);
    log_cell += std::log(axis.period);
  }
  require_image_sum(autocorrelation, n_sums);
  require_narrow(autocorrelation, log_cell, n_sums);
  negligible_distance_ = distance_of_negligible_rho(autocorrelation);
  if (n_sums > 0 && negligible_distance_ > 1.5 * shortest) {
    far_ = PanelTable(panels(shortest));
    // Far images are at least 1.5 periods away: 10 of these scales.
    fill_table(scale_quadrature(autocorrelation, {shortest * 0.15, largest}, n_sums));
  }
  total_ = near_images(Vec3::Zero()) + far_images(Vec3::Zero());
  if (!std::isfinite(total_))
    throw InputError(fmt::format(
        "--length: {:g}; the autocorrelation reaches too many periods to be summed; use "
        "a shorter one or --distance minimum-image",
        autocorrelation.length()));
}

void ImageSum::set_axes(const Distance& distance, const Vec3& extent) {
  for (int number = 0; number < 3; ++number) {
    Axis& axis = axes_[static_cast<std::size_t>(number)];
    axis.number = number;
    axis.stretch = std::abs(distance.stretch()(number, number));
    axis.period = axis.stretch * distance.period()[number];
    axis.range = axis.period > 0 ? axis.period / 2 : axis.stretch * extent[number];
  }
  // The last axis is the innermost loop, and should be a long one.
  std::stable_partition(axes_.begin(), axes_.end(), [](const Axis& a) { return a.range == 0; });
}

PanelTable::Ends ImageSum::panels(double shortest_period) const {
  PanelTable::Ends ends;
  std::size_t n_cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    ends[a] = make_panels(axes_[a].range, shortest_period);
    if (!ends[a].empty()) n_cells *= ends[a].size() - 1;
  }
  if (n_cells > most_cells)
    throw InputError(
        "the periods, or a period and the size of the surface, differ by too much for the sum over "
        "images; leave the long --period out or choose --distance minimum-image");
  return ends;
}

// Adds a term's far images at the nodes of the table: all images minus the near ones.
void ImageSum::add_term(const GaussianTerm& term, std::vector<double>& values) const {
  std::array<std::vector<double>, 3> all, near;
  for (std::size_t a = 0; a < 3; ++a)
    for (const double x : far_.nodes(a)) {
      const double period = axes_[a].period;
      all[a].push_back(period > 0 ? periodic_bell(x, period, term.scale) : bell(x, term.scale));
      near[a].push_back(period > 0 ? near_bell(x, period, term.scale) : bell(x, term.scale));
    }
  values.resize(all[0].size() * all[1].size() * all[2].size());
  double* value = values.data();
  for (std::size_t i = 0; i < all[0].size(); ++i)
    for (std::size_t j = 0; j < all[1].size(); ++j) {
      const double all_ij = term.weight * all[0][i] * all[1][j];
      const double near_ij = term.weight * near[0][i] * near[1][j];
      for (std::size_t k = 0; k < all[2].size(); ++k)
        *value++ += all_ij * all[2][k] - near_ij * near[2][k];
    }
}

void ImageSum::fill_table(std::span<const GaussianTerm> terms) {
  std::vector<double> values;
  for (const GaussianTerm& term : terms) add_term(term, values);
  if (values.empty()) return;
  const double largest = *std::max_element(values.begin(), values.end());
  far_.set_values(std::move(values), 3e-14 * (1 + largest));
}

// In the order of the axes, stretched, 0 <= x <= range.
Vec3 ImageSum::reduced(const Vec3& difference) const {
  Vec3 x;
  for (int a = 0; a < 3; ++a) {
    const Axis& axis = axes_[static_cast<std::size_t>(a)];
    double along = axis.stretch * difference[axis.number];
    if (axis.period > 0) along -= axis.period * std::nearbyint(along / axis.period);
    x[a] = std::abs(along);
  }
  return x;
}

double ImageSum::near_images(const Vec3& x) const {
  const double farthest = negligible_distance_ * negligible_distance_;
  std::array<int, 3> reach{};
  for (std::size_t a = 0; a < 3; ++a) reach[a] = axes_[a].period > 0 ? 1 : 0;
  const auto square = [&](int a, int n) {
    const double along = x[a] + n * axes_[static_cast<std::size_t>(a)].period;
    return along * along;
  };
  double sum = 0;
  for (int i = -reach[0]; i <= reach[0]; ++i)
    for (int j = -reach[1]; j <= reach[1]; ++j)
      for (int k = -reach[2]; k <= reach[2]; ++k) {
        const double r2 = square(0, i) + square(1, j) + square(2, k);
        if (r2 < farthest) sum += autocorrelation_.rho(std::sqrt(r2));
      }
  return sum;
}

double ImageSum::rho(const Vec3& difference) const {
  const Vec3 x = reduced(difference);
  return (near_images(x) + far_images(x)) / total_;
}

}  // namespace roughmesh::detail
