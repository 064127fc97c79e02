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

/// Points along Morton's curve through their box, shifted diagonally by a part of its size.
std::vector<Index> curve_through(const std::vector<Vec3>& points, double shift) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  const double size = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::uint64_t> code(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double place = ((points[i] - box.min())[axis] / size + shift) / 2;  // in [0, 1)
      code[i] |= spread_bits(static_cast<std::uint64_t>(place * 0x1p21)) << axis;
    }
  std::vector<Index> curve(points.size());
  std::iota(curve.begin(), curve.end(), Index{0});
  std::sort(curve.begin(), curve.end(),
            [&](Index i, Index j) { return code[i] != code[j] ? code[i] < code[j] : i < j; });
  return curve;
}

/// Places whose Euclidean distance is small where theirs is. Pieces of a curve, one step apart in
/// y, are moved as far apart as they are long.
std::vector<Vec3> comparable_places(std::span<const Vec3> points, const Distance& distance) {
  double step = 1;
  if (distance.kind() == DistanceKind::curve) {
    step = 0;
    for (const Vec3& x : points) step = std::max(step, x.x());
  }
  std::vector<Vec3> places(points.begin(), points.end());
  for (Vec3& x : places) x = distance.stretch() * Vec3(x.x(), step * x.y(), x.z());
  return places;
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
  const std::vector<Vec3> stretched = comparable_places(points, distance);
  std::vector<std::pair<double, PointPair>> steps;
  for (int c = 0; c < n_curves; ++c) {
    const std::vector<Index> curve = curve_through(stretched, static_cast<double>(c) / n_curves);
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

double error_of(double covariance, double rho) {
  const double error = std::abs(covariance - rho);
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

}  // namespace

std::vector<PointPair> audited_pairs(const Correlation& correlation) {
  const std::span<const Vec3> points = correlation.places();
  const Distance& distance = correlation.distance();
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

Audit audit_covariance(const FieldMethod& method, const Correlation& correlation) {
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
