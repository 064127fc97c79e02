// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "gamma_function.hpp"
#include "matching_points.hpp"
#include "parallel.hpp"

namespace roughmesh {
namespace {

constexpr std::size_t most_exact_points = 2000;
constexpr std::size_t n_sampled_sources = 256;

struct Source {
  std::size_t point = 0;
  double weight = 0;  ///< the weights of all sources add up to 1
};

struct CountedAreas {
  std::vector<double> of_point;
  double total = 0;
};

// The field times the weights of a mask, and the areas its Sq is taken over.
struct MaskedField {
  std::vector<double> weights;  ///< in [0, 1]
  CountedAreas areas;

  double share(std::size_t i) const { return areas.of_point[i] / areas.total; }
};

// Points in the middle of strata of equal area in canonical order, among those whose weight is not
// 0, which are all alike: one stands for them, however small the rest of the surface is. No random
// number, so the same on every machine.
std::vector<Source> sampled_sources(const MaskedField& field) {
  std::vector<Source> sources;
  Source unmoved;
  double moved = 0;
  for (std::size_t i = 0; i < field.weights.size(); ++i) {
    if (field.weights[i] > 0)
      moved += field.share(i);
    else
      unmoved = {i, unmoved.weight + field.share(i)};
  }
  double passed = 0;
  for (std::size_t i = 0; i < field.weights.size() && sources.size() < n_sampled_sources; ++i) {
    if (field.weights[i] > 0) passed += field.share(i);
    while (sources.size() < n_sampled_sources &&
           passed * n_sampled_sources >= (static_cast<double>(sources.size()) + 0.5) * moved)
      sources.push_back({i, moved / n_sampled_sources});
  }
  if (unmoved.weight > 0) sources.push_back(unmoved);
  return sources;
}

// Every point with its share of the area; a sample of them on large surfaces.
std::vector<Source> source_points(const MaskedField& field) {
  if (field.weights.size() > most_exact_points) return sampled_sources(field);
  std::vector<Source> sources;
  for (std::size_t i = 0; i < field.weights.size(); ++i) sources.push_back({i, field.share(i)});
  return sources;
}

// Area-weighted means over the surface of g_ij of docs/math.md, eq. 44, which is 1 - rho without a
// mask, and of its square.
struct Decorrelation {
  double mean = 0;
  double mean_square = 0;
};

Decorrelation decorrelation_from(std::size_t i, const Surface& surface, const MaskedField& field,
                                 const Correlation& correlation) {
  Decorrelation sum;
  for (std::size_t j = 0; j < surface.points.size(); ++j) {
    const double area = field.areas.of_point[j];
    if (area == 0) continue;
    const double step = field.weights[i] - field.weights[j];
    const double product = field.weights[i] * field.weights[j];
    double lost = step * step / 2;
    if (product > 0)
      lost += product * (1 - correlation(static_cast<Index>(i), static_cast<Index>(j)));
    sum.mean += area * lost;
    sum.mean_square += area * lost * lost;
  }
  return {sum.mean / field.areas.total, sum.mean_square / field.areas.total};
}

// Mean and variance of Sq^2 (docs/math.md, eq. 19, 20 and 44). Written in g_ij, which
// centring leaves as it is, so that strongly correlated surfaces keep their digits.
struct MeanSquareMoments {
  double mean = 0;
  double variance = 0;
};

MeanSquareMoments mean_square_moments(const Surface& surface, const MaskedField& field,
                                      const Correlation& correlation) {
  const std::vector<Source> sources = source_points(field);
  std::vector<Decorrelation> rows(sources.size());
  detail::parallel_for(sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows[i] = decorrelation_from(sources[i].point, surface, field, correlation);
  });
  double mean = 0, mean_of_squares = 0, square_of_means = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    mean += sources[i].weight * rows[i].mean;
    mean_of_squares += sources[i].weight * rows[i].mean_square;
    square_of_means += sources[i].weight * rows[i].mean * rows[i].mean;
  }
  return {mean, 2 * std::max(0.0, mean_of_squares - 2 * square_of_means + mean * mean)};
}

void require_numbers(std::span<const double> values, const Surface& surface, const char* what) {
  if (values.size() == surface.points.size() && !values.empty()) return;
  throw InputError(fmt::format("{} {} for a surface of {} points; give one for each", values.size(),
                               what, surface.points.size()));
}

// Those given, or all of the surface.
CountedAreas counted_areas(const Surface& surface, std::span<const double> areas) {
  if (areas.empty()) return {surface.areas, surface.area};
  require_numbers(areas, surface, "areas");
  for (const double area : areas)
    if (!(area >= 0) || !std::isfinite(area))
      throw InputError(
          fmt::format("statistics: {} is no node area; give finite areas from 0 on", area));
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  if (!(total > 0))
    throw InputError(
        "statistics: every node area is 0, so no point counts; take a smaller fade or mask");
  return {{areas.begin(), areas.end()}, total};
}

std::vector<double> field_weights(const Surface& surface, std::span<const double> weights) {
  if (weights.empty()) return std::vector<double>(surface.points.size(), 1.0);
  require_numbers(weights, surface, "weights");
  for (const double weight : weights)
    if (!(weight >= 0 && weight <= 1))
      throw InputError(
          fmt::format("statistics: {} is no mask weight; give numbers from 0 to 1", weight));
  return {weights.begin(), weights.end()};
}

// Largest minus smallest height; of the points with an area, where areas are given.
double height_range(std::span<const double> heights, std::span<const double> areas) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!areas.empty() && areas[i] == 0) continue;
    lowest = std::min(lowest, heights[i]);
    highest = std::max(highest, heights[i]);
  }
  return highest - lowest;
}

}  // namespace

HeightStatistics height_statistics(const Surface& surface, std::span<const double> heights,
                                   std::span<const double> areas) {
  require_numbers(heights, surface, "heights");
  const CountedAreas counted = counted_areas(surface, areas);
  const std::vector<double>& area = counted.of_point;
  HeightStatistics result;
  result.mean =
      std::inner_product(heights.begin(), heights.end(), area.begin(), 0.0) / counted.total;
  const auto moment = [&](int order, double unit) {
    double sum = 0;
    for (std::size_t i = 0; i < heights.size(); ++i)
      if (area[i] > 0) sum += area[i] * std::pow((heights[i] - result.mean) / unit, order);
    return sum / counted.total;
  };
  result.sz = height_range(heights, areas);
  if (result.sz == 0) return result;
  result.sq = result.sz * std::sqrt(moment(2, result.sz));  // no overflow in any length unit
  result.ssk = moment(3, result.sq);
  result.sku = moment(4, result.sq);
  return result;
}

// Sq^2 is a quadratic form of normal numbers. A multiple of chi-square with the same mean and
// variance stands for it (G. E. P. Box 1954, doi:10.1214/aoms/1177728786), `half` being half its
// number of degrees of freedom.
ExpectedSq expected_sq(const Surface& surface, const Correlation& correlation,
                       const SqOptions& options) {
  constexpr double large = 1e6;
  detail::require_points_of(surface, correlation);
  const MaskedField field{field_weights(surface, options.weights),
                          counted_areas(surface, options.areas)};
  const MeanSquareMoments moments = mean_square_moments(surface, field, correlation);
  if (!(moments.mean > 0)) return {};
  const double root = std::sqrt(moments.mean);
  if (moments.variance == 0) return {root, 0};
  const double half = moments.mean / moments.variance * moments.mean;
  const double shortfall = detail::gamma_ratio(half) / std::sqrt(half);
  const double relative_variance =
      half > large ? 1 / (4 * half) : std::max(0.0, 1 - shortfall * shortfall);
  return {root * shortfall, root * std::sqrt(relative_variance)};
}

}  // namespace roughmesh
