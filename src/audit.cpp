// SPDX-License-Identifier: BSD-3-Clause
#include "audit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "morton.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t max_pairs = 10'000;
constexpr std::size_t max_diagonal = 10'000;
constexpr std::size_t n_near_pairs = 200;
constexpr std::size_t n_strata = 50;
constexpr std::size_t n_sources = (max_pairs - n_near_pairs) / n_strata;

constexpr std::size_t most_searched_points = 20'000;
constexpr std::size_t n_neighbourhoods = 40;

using Strata = std::array<double, n_strata>;  ///< lower ends, ascending

std::vector<PointPair> all_pairs(std::size_t n) {
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      pairs.emplace_back(static_cast<Index>(i), static_cast<Index>(j));
  return pairs;
}

struct NearPairs {
  std::vector<PointPair> pairs;
  double shortest = 0;  ///< shortest positive distance; 0 if there is none
};

/// The closest of the pairs that follow each other on one of five curves. A curve that crosses a
/// face of its cells between two close points parts them. But seen from cells of any size, the five
/// shifts put the faces of one axis a fifth of a cell apart, so that each of the three axes spoils
/// one curve at most, and two curves are left on which the closest pair stays together.
NearPairs near_pairs(std::span<const Vec3> points, const Distance& distance) {
  constexpr int n_curves = 5;
  const std::vector<Vec3> places = comparable_places(points, distance);
  std::vector<std::pair<double, PointPair>> steps;
  for (int c = 0; c < n_curves; ++c) {
    const std::vector<Index> curve =
        morton_order(morton_codes(places, static_cast<double>(c) / n_curves));
    for (std::size_t k = 1; k < curve.size(); ++k)
      steps.emplace_back(distance(points[curve[k - 1]], points[curve[k]]),
                         std::minmax(curve[k - 1], curve[k]));
  }
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  NearPairs near;
  const auto positive =
      std::find_if(steps.begin(), steps.end(), [](const auto& step) { return step.first > 0; });
  if (positive != steps.end()) near.shortest = positive->first;
  steps.resize(std::min(steps.size(), n_near_pairs));
  for (const auto& step : steps) near.pairs.push_back(step.second);
  return near;
}

/// Strata of equal ratio from the shortest distance to one that no pair exceeds (by the triangle
/// inequality, twice the largest distance from any one point). Points of different pieces of a
/// curve are infinitely far apart and belong to the last stratum.
Strata make_strata(std::span<const Vec3> points, const Distance& distance, double shortest) {
  double largest = shortest;
  for (const Vec3& x : points)
    if (const double r = distance(points[0], x); std::isfinite(r))
      largest = std::max(largest, 2 * r);
  Strata strata{};
  for (std::size_t s = 1; s < n_strata; ++s)
    strata[s] = shortest * std::pow(largest / shortest, static_cast<double>(s) / n_strata);
  return strata;
}

/// One partner in each stratum that has any, found from a random point on. The bits are those of no
/// field: the second counter word is never 2 elsewhere.
std::vector<PointPair> pairs_of_source(std::span<const Vec3> points, const Distance& distance,
                                       const Strata& strata, std::uint64_t number) {
  const std::size_t n = points.size();
  const auto words = random_words({0, 0}, {number, 2, 0, 0});
  const std::size_t source = words[0] % n, start = words[1] % n;
  std::array<bool, n_strata> is_filled{};
  std::vector<PointPair> pairs;
  for (std::size_t k = 0; k < n && pairs.size() < n_strata; ++k) {
    const std::size_t partner = (start + k) % n;
    if (partner == source) continue;
    const double r = distance(points[source], points[partner]);
    const auto above = std::upper_bound(strata.begin(), strata.end(), r) - strata.begin();
    bool& is_found = is_filled[static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - 1, 0))];
    if (is_found) continue;
    is_found = true;
    pairs.emplace_back(static_cast<Index>(source), static_cast<Index>(partner));
  }
  return pairs;
}

/// Position along the curve of the shortest step to another place.
std::size_t shortest_step(std::span<const Vec3> places, const Distance& distance,
                          std::span<const Index> curve) {
  constexpr std::size_t grain = 1 << 14;
  using Step = std::pair<double, std::size_t>;  // length and position
  const Step none{std::numeric_limits<double>::infinity(), 0};
  std::vector<Step> shortest((curve.size() + grain - 1) / grain, none);
  parallel_for(curve.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = std::max<std::size_t>(begin, 1); k < end; ++k) {
      const double r = distance(places[curve[k - 1]], places[curve[k]]);
      if (r > 0) shortest[begin / grain] = std::min(shortest[begin / grain], {r, k});
    }
  });
  return std::accumulate(shortest.begin(), shortest.end(), none,
                         [](const Step& a, const Step& b) { return std::min(a, b); })
      .second;
}

/// Points on both sides of one along the curve: the next ones all, then fewer and fewer, so that
/// there are distances of every size.
void mark_neighbourhood(std::span<const Index> curve, std::size_t centre,
                        std::vector<std::uint8_t>& marks) {
  constexpr std::size_t n_next = 125;
  constexpr double ratio = 1.07;
  for (std::size_t step = 0; step < curve.size();) {
    if (step <= centre) marks[curve[centre - step]] = 1;
    if (centre + step < curve.size()) marks[curve[centre + step]] = 1;
    step = step < n_next ? step + 1 : static_cast<std::size_t>(ratio * static_cast<double>(step));
  }
}

double error_of(double covariance, double rho) {
  const double error = std::abs(covariance - rho);
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

std::vector<PointPair> pairs_among(std::span<const Vec3> points, const Distance& distance) {
  const std::size_t n = points.size();
  if (n < 2 || n * (n - 1) / 2 <= max_pairs) return all_pairs(n);
  NearPairs near = near_pairs(points, distance);
  const Strata strata = make_strata(points, distance, near.shortest);
  std::vector<std::vector<PointPair>> of_source(n_sources);
  parallel_for(n_sources, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      of_source[s] = pairs_of_source(points, distance, strata, s);
  });
  std::vector<PointPair> pairs = std::move(near.pairs);
  for (const std::vector<PointPair>& some : of_source)
    pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

}  // namespace

std::vector<Index> audited_points(std::span<const Vec3> places, const Distance& distance) {
  const std::size_t n = places.size();
  const bool takes_all = n <= most_searched_points;
  std::vector<std::uint8_t> marks(n, takes_all ? 1 : 0);
  if (!takes_all) {
    const std::vector<Index> curve = morton_order(places, distance);
    for (std::size_t k = 1; k < n_neighbourhoods; ++k)
      mark_neighbourhood(curve, k * n / n_neighbourhoods, marks);
    mark_neighbourhood(curve, shortest_step(places, distance, curve), marks);
  }
  std::vector<Index> points;
  for (std::size_t i = 0; i < n; ++i)
    if (marks[i]) points.push_back(static_cast<Index>(i));
  return points;
}

std::vector<PointPair> audited_pairs(const Correlation& correlation) {
  const std::span<const Vec3> places = correlation.places();
  const std::vector<Index> points = audited_points(places, correlation.distance());
  std::vector<Vec3> audited;
  audited.reserve(points.size());
  for (const Index i : points) audited.push_back(places[i]);
  std::vector<PointPair> pairs = pairs_among(audited, correlation.distance());
  for (auto& [i, j] : pairs) {
    i = points[i];
    j = points[j];
  }
  return pairs;
}

Audit audit_covariance(const FieldMethod& method) {
  const Correlation& correlation = method.correlation();
  std::vector<PointPair> pairs = audited_pairs(correlation);
  const auto n = static_cast<std::size_t>(correlation.n_points());
  const std::size_t n_pairs = pairs.size();
  const std::size_t n_diagonal = std::min(n, max_diagonal);
  for (std::size_t k = 0; k < n_diagonal; ++k) {
    const auto point = static_cast<Index>(k * n / n_diagonal);
    pairs.emplace_back(point, point);
  }
  const std::vector<double> covariances = method.covariances(pairs);
  Audit audit{0, static_cast<Index>(n_pairs), static_cast<Index>(n_diagonal)};
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const double rho = method.target(pairs[p].first, pairs[p].second);
    audit.covariance_error = std::max(audit.covariance_error, error_of(covariances[p], rho));
  }
  return audit;
}

}  // namespace roughmesh::detail
