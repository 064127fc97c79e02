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
#include "sq_moments.hpp"

namespace roughmesh {
namespace {

void require_numbers(std::span<const double> values, const Surface& surface, const char* what) {
  if (values.size() == surface.points.size() && !values.empty()) return;
  throw InputError(fmt::format("{} {} for a surface of {} points; give one for each", values.size(),
                               what, surface.points.size()));
}

struct CountedAreas {
  std::span<const double> of_point;
  double total = 0;
};

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
  return {areas, total};
}

void require_weights(const Surface& surface, std::span<const double> weights) {
  require_numbers(weights, surface, "weights");
  for (const double weight : weights)
    if (!(weight >= 0 && weight <= 1))
      throw InputError(
          fmt::format("statistics: {} is no mask weight; give numbers from 0 to 1", weight));
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
  const std::span<const double> area = counted.of_point;
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
  const std::vector<double> ones(options.weights.empty() ? surface.points.size() : 0, 1.0);
  const std::span<const double> weights = options.weights.empty() ? ones : options.weights;
  require_weights(surface, weights);
  const detail::MeanSquareMoments moments = detail::mean_square_moments(
      {correlation, weights, counted_areas(surface, options.areas).of_point, options.covariance});
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
