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
  std::function<double(Index, Index)> covariance;  ///< of the unmasked field; none: its correlation
  std::vector<double> variances;                   ///< covariance(i, i)

  double share(std::size_t i) const { return areas.of_point[i] / areas.total; }
};

// Points with an area by weight, equal ones in canonical order: strata have one weight each.
std::vector<std::size_t> sorted_by_weight(const MaskedField& field) {
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < field.weights.size(); ++i)
    if (field.areas.of_point[i] > 0) points.push_back(i);
  std::stable_sort(points.begin(), points.end(), [&](std::size_t i, std::size_t j) {
    return field.weights[i] < field.weights[j];
  });
  return points;
}

// The points in the middle of strata of equal area, from a list of more points than strata. No
// random number, so the same on every machine.
void append_middles(const MaskedField& field, std::span<const std::size_t> points, double share,
                    std::vector<Source>& sources) {
  const double stratum = share / n_sampled_sources;
  double passed = 0, middle = stratum / 2;
  for (const std::size_t i : points) {
    passed += field.share(i);
    for (; stratum > 0 && middle <= passed; middle += stratum) sources.push_back({i, stratum});
  }
}

// Points of weight 0 are all alike: one stands for them, however small the rest of the surface is.
std::vector<Source> sampled_sources(const MaskedField& field) {
  const std::vector<std::size_t> points = sorted_by_weight(field);
  const auto first_moved = std::find_if(points.begin(), points.end(),
                                        [&](std::size_t i) { return field.weights[i] > 0; });
  const std::span still(points.begin(), first_moved), moved(first_moved, points.end());
  const auto share_of = [&](std::span<const std::size_t> some) {
    return std::accumulate(some.begin(), some.end(), 0.0,
                           [&](double sum, std::size_t i) { return sum + field.share(i); });
  };
  std::vector<Source> sources;
  if (!still.empty()) sources.push_back({still.front(), share_of(still)});
  if (moved.size() > n_sampled_sources)
    append_middles(field, moved, share_of(moved), sources);
  else
    for (const std::size_t i : moved) sources.push_back({i, field.share(i)});
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

// Half the mean square difference of the masked field between two points (docs/math.md, eq. 44).
double half_variogram(Index i, Index j, const MaskedField& field, const Correlation& correlation) {
  const double a = field.weights[i], b = field.weights[j];
  if (field.covariance)
    return (a * a * field.variances[i] + b * b * field.variances[j]) / 2 -
           a * b * field.covariance(i, j);
  return (a - b) * (a - b) / 2 + (a * b > 0 ? a * b * (1 - correlation(i, j)) : 0);
}

Decorrelation decorrelation_from(std::size_t i, const Surface& surface, const MaskedField& field,
                                 const Correlation& correlation) {
  Decorrelation sum;
  for (std::size_t j = 0; j < surface.points.size(); ++j) {
    const double area = field.areas.of_point[j];
    if (area == 0) continue;
    const double lost =
        half_variogram(static_cast<Index>(i), static_cast<Index>(j), field, correlation);
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
  MaskedField field{field_weights(surface, options.weights),
                    counted_areas(surface, options.areas),
                    options.covariance,
                    {}};
  for (Index i = 0; field.covariance && i < surface.n_points(); ++i)
    field.variances.push_back(field.covariance(i, i));
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
