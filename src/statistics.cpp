// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/statistics.hpp"

#include <algorithm>
#include <cmath>
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

// Every point with its share of the area; on large surfaces the points in the middle of 256 strata
// of equal area in canonical order. No random number, so the same on every machine.
std::vector<Source> source_points(const Surface& surface) {
  const std::size_t n = surface.points.size();
  std::vector<Source> sources;
  if (n <= most_exact_points) {
    for (std::size_t i = 0; i < n; ++i) sources.push_back({i, surface.areas[i] / surface.area});
    return sources;
  }
  double area = 0;
  for (std::size_t i = 0; i < n && sources.size() < n_sampled_sources; ++i) {
    area += surface.areas[i];
    while (sources.size() < n_sampled_sources &&
           area * n_sampled_sources >= (static_cast<double>(sources.size()) + 0.5) * surface.area)
      sources.push_back({i, 1.0 / n_sampled_sources});
  }
  return sources;
}

// Area-weighted means over the surface of 1 - rho(distance to one point) and of its square.
struct Decorrelation {
  double mean = 0;
  double mean_square = 0;
};

Decorrelation decorrelation_from(std::size_t source, const Surface& surface,
                                 const Correlation& correlation) {
  Decorrelation sum;
  for (std::size_t j = 0; j < surface.points.size(); ++j) {
    const double lost = 1 - correlation(static_cast<Index>(source), static_cast<Index>(j));
    sum.mean += surface.areas[j] * lost;
    sum.mean_square += surface.areas[j] * lost * lost;
  }
  return {sum.mean / surface.area, sum.mean_square / surface.area};
}

// Mean and variance of Sq^2 (docs/math.md, eq. 19 and 20). Written in 1 - rho, which centring
// leaves as it is, so that strongly correlated surfaces keep their digits.
struct MeanSquareMoments {
  double mean = 0;
  double variance = 0;
};

MeanSquareMoments mean_square_moments(const Surface& surface, const Correlation& correlation) {
  const std::vector<Source> sources = source_points(surface);
  std::vector<Decorrelation> rows(sources.size());
  detail::parallel_for(sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows[i] = decorrelation_from(sources[i].point, surface, correlation);
  });
  double mean = 0, mean_of_squares = 0, square_of_means = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    mean += sources[i].weight * rows[i].mean;
    mean_of_squares += sources[i].weight * rows[i].mean_square;
    square_of_means += sources[i].weight * rows[i].mean * rows[i].mean;
  }
  return {mean, 2 * std::max(0.0, mean_of_squares - 2 * square_of_means + mean * mean)};
}

}  // namespace

HeightStatistics height_statistics(const Surface& surface, std::span<const double> heights) {
  if (heights.size() != surface.points.size() || heights.empty())
    throw InputError(fmt::format("{} heights for a surface of {} points; give one for each",
                                 heights.size(), surface.points.size()));
  HeightStatistics result;
  result.mean =
      std::inner_product(heights.begin(), heights.end(), surface.areas.begin(), 0.0) / surface.area;
  const auto moment = [&](int order, double unit) {
    double sum = 0;
    for (std::size_t i = 0; i < heights.size(); ++i)
      sum += surface.areas[i] * std::pow((heights[i] - result.mean) / unit, order);
    return sum / surface.area;
  };
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  result.sz = *highest - *lowest;
  if (result.sz == 0) return result;
  result.sq = result.sz * std::sqrt(moment(2, result.sz));  // no overflow in any length unit
  result.ssk = moment(3, result.sq);
  result.sku = moment(4, result.sq);
  return result;
}

// Sq^2 is a quadratic form of normal numbers. A multiple of chi-square with the same mean and
// variance stands for it (G. E. P. Box 1954, doi:10.1214/aoms/1177728786), `half` being half its
// number of degrees of freedom.
ExpectedSq expected_sq(const Surface& surface, const Correlation& correlation) {
  constexpr double large = 1e6;
  detail::require_points_of(surface, correlation);
  const MeanSquareMoments moments = mean_square_moments(surface, correlation);
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
