// SPDX-License-Identifier: BSD-3-Clause
#include "audit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t max_pairs = 10'000;
constexpr std::size_t max_diagonal = 10'000;
constexpr std::size_t n_near_pairs = 200;
constexpr std::size_t n_strata = 50;
constexpr std::size_t n_sources = (max_pairs - n_near_pairs) / n_strata;

using Strata = std::array<double, n_strata>;  ///< lower ends, ascending

std::vector<PointPair> all_pairs(std::size_t n) {
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      pairs.emplace_back(static_cast<Index>(i), static_cast<Index>(j));
  return pairs;
}

/// Takes the low 21 bits of a number three places apart.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Points along Morton's curve, on which neighbours are close in space.
std::vector<Index> curve_through(std::span<const Vec3> points, const Eigen::Matrix3d& stretch) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(stretch * x);
  const double size = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::uint64_t> code(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 cell = (stretch * points[i] - box.min()) * (0x1fffff / size);
    for (int axis = 0; axis < 3; ++axis)
      code[i] |= spread_bits(static_cast<std::uint64_t>(cell[axis])) << axis;
  }
  std::vector<Index> curve(points.size());
  std::iota(curve.begin(), curve.end(), Index{0});
  std::sort(curve.begin(), curve.end(),
            [&](Index i, Index j) { return code[i] != code[j] ? code[i] < code[j] : i < j; });
  return curve;
}

struct NearPairs {
  std::vector<PointPair> pairs;
  double shortest = 0;  ///< shortest positive distance; 0 if there is none
};

/// The closest of the pairs that follow each other on the curve.
NearPairs near_pairs(std::span<const Vec3> points, const Distance& distance) {
  const std::vector<Index> curve = curve_through(points, distance.stretch());
  std::vector<std::pair<double, PointPair>> steps(curve.size() - 1);
  for (std::size_t k = 0; k < steps.size(); ++k)
    steps[k] = {distance(points[curve[k]], points[curve[k + 1]]), {curve[k], curve[k + 1]}};
  NearPairs near;
  for (const auto& [length, pair] : steps)
    if (length > 0 && (near.shortest == 0 || length < near.shortest)) near.shortest = length;
  std::partial_sort(steps.begin(), steps.begin() + n_near_pairs, steps.end());
  for (std::size_t k = 0; k < n_near_pairs; ++k) near.pairs.push_back(steps[k].second);
  return near;
}

/// Strata of equal ratio from the shortest distance to one that no pair exceeds (by the triangle
/// inequality, twice the largest distance from any one point).
Strata make_strata(std::span<const Vec3> points, const Distance& distance, double shortest) {
  double largest = shortest;
  for (const Vec3& x : points) largest = std::max(largest, 2 * distance(points[0], x));
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

double error_of(double covariance, double rho) {
  const double error = std::abs(covariance - rho);
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

}  // namespace

std::vector<PointPair> audited_pairs(std::span<const Vec3> points, const Distance& distance) {
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

Audit audit_covariance(const Factor& factor, std::span<const Vec3> points,
                       const Autocorrelation& autocorrelation, const Distance& distance) {
  std::vector<PointPair> pairs = audited_pairs(points, distance);
  const std::size_t n = points.size(), n_pairs = pairs.size();
  const std::size_t n_diagonal = std::min(n, max_diagonal);
  for (std::size_t k = 0; k < n_diagonal; ++k) {
    const auto point = static_cast<Index>(k * n / n_diagonal);
    pairs.emplace_back(point, point);
  }
  const std::vector<double> covariances = factor.covariances(pairs);
  Audit audit{0, static_cast<Index>(n_pairs), static_cast<Index>(n_diagonal)};
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const auto [i, j] = pairs[p];
    const double rho = autocorrelation.rho(distance(points[i], points[j]));
    audit.covariance_error = std::max(audit.covariance_error, error_of(covariances[p], rho));
  }
  return audit;
}

}  // namespace roughmesh::detail
