// SPDX-License-Identifier: BSD-3-Clause
#include "sq_moments.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "parallel.hpp"
#include "point_tree.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t most_exact_points = 2000;
constexpr std::size_t n_sampled_sources = 256;
// Diameter over distance of far points that one of them stands for.
constexpr double far_angle = 0.2;

// ---- Points that stand for all of the surface ----

struct Source {
  Index point = 0;
  double area = 0;
};

double area_of(const MaskedField& field, std::span<const Index> points) {
  return std::accumulate(points.begin(), points.end(), 0.0,
                         [&](double sum, Index i) { return sum + field.areas[i]; });
}

// Points with an area by weight, equal ones along the curve: strata have one weight each and lie
// together.
std::vector<Index> sorted_by_weight(const MaskedField& field, std::span<const Index> curve) {
  struct Entry {
    double weight;
    std::size_t place;
  };
  const auto comes_before = [](const Entry& a, const Entry& b) {
    return a.weight != b.weight ? a.weight < b.weight : a.place < b.place;
  };
  std::vector<Entry> entries;
  entries.reserve(curve.size());
  for (std::size_t k = 0; k < curve.size(); ++k)
    if (field.areas[curve[k]] > 0) entries.push_back({field.weights[curve[k]], k});
  if (!std::is_sorted(entries.begin(), entries.end(), comes_before))
    parallel_sort(std::span(entries), comes_before);
  std::vector<Index> points(entries.size());
  for (std::size_t k = 0; k < points.size(); ++k) points[k] = curve[entries[k].place];
  return points;
}

// The points in the middle of strata of equal area, from a list of more points than strata. No
// random number, so the same on every machine.
void append_middles(const MaskedField& field, std::span<const Index> points,
                    std::vector<Source>& sources) {
  const double stratum = area_of(field, points) / n_sampled_sources;
  double passed = 0, middle = stratum / 2;
  for (const Index i : points) {
    passed += field.areas[i];
    for (; stratum > 0 && middle <= passed; middle += stratum) sources.push_back({i, stratum});
  }
}

// Points of weight 0 are all alike: one stands for them, however small the rest of the surface is.
std::vector<Source> sampled_sources(const MaskedField& field, std::span<const Index> curve) {
  const std::vector<Index> points = sorted_by_weight(field, curve);
  const auto first_moved =
      std::find_if(points.begin(), points.end(), [&](Index i) { return field.weights[i] > 0; });
  const std::span still(points.begin(), first_moved), moved(first_moved, points.end());
  std::vector<Source> sources;
  if (!still.empty()) sources.push_back({still.front(), area_of(field, still)});
  if (moved.size() > n_sampled_sources)
    append_middles(field, moved, sources);
  else
    for (const Index i : moved) sources.push_back({i, field.areas[i]});
  return sources;
}

std::vector<Source> all_points(const MaskedField& field) {
  std::vector<Source> sources;
  for (std::size_t i = 0; i < field.areas.size(); ++i)
    sources.push_back({static_cast<Index>(i), field.areas[i]});
  return sources;
}

// ---- Sums over the points around each of them ----

// The weights of some points: their mean over the area, and sums of area times powers of the
// deviations from it.
struct CellMask {
  double area = 0;
  double mean = 1;
  double squares = 0, cubes = 0, fourths = 0;
};

CellMask mask_of(const MaskedField& field, std::span<const Index> points) {
  CellMask mask{area_of(field, points)};
  if (mask.area == 0) return mask;
  double sum = 0;
  for (const Index i : points) sum += field.areas[i] * field.weights[i];
  mask.mean = sum / mask.area;
  for (const Index i : points) {
    const double deviation = field.weights[i] - mask.mean, square = deviation * deviation;
    mask.squares += field.areas[i] * square;
    mask.cubes += field.areas[i] * square * deviation;
    mask.fourths += field.areas[i] * square * square;
  }
  return mask;
}

// Sums of area times g_ij of docs/math.md, eq. 44, which is 1 - rho without a mask, and times its
// square.
struct Decorrelation {
  double sum = 0;
  double squares = 0;
};

class PairSums {
 public:
  PairSums(const MaskedField& field, const PointTree& tree)
      : field_(field), tree_(tree), masks_(tree.n_cells()) {
    constexpr std::size_t grain = 64;
    if (field.covariance) variances_.resize(field.areas.size());
    parallel_for(variances_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        variances_[i] = field.covariance(static_cast<Index>(i), static_cast<Index>(i));
    });
    parallel_for(masks_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) masks_[c] = mask_of(field, tree.points(c));
    });
  }

  Decorrelation from(Index source, double angle) const {
    Decorrelation total;
    tree_.visit(
        field_.correlation.places()[source], angle,
        [&](Index i) {
          add(source, i, {.area = field_.areas[i], .mean = field_.weights[i]}, total);
        },
        [&](std::size_t cell, Index centre) { add(source, centre, masks_[cell], total); });
    return total;
  }

 private:
  double variance(Index i) const { return variances_.empty() ? 1 : variances_[i]; }

  // Half the mean square difference of the unmasked field between two points.
  double half_variogram(Index i, Index j) const {
    if (!field_.covariance) return 1 - field_.correlation(i, j);
    return (variances_[i] + variances_[j]) / 2 - field_.covariance(i, j);
  }

  // Points near j, with the field of j and their own weights b: g is a polynomial in b of degree
  // 2, expanded about their mean weight.
  void add(Index i, Index j, const CellMask& mask, Decorrelation& total) const {
    if (mask.area == 0) return;
    const double a = field_.weights[i], b = mask.mean;
    const double of_i = variance(i), of_j = variance(j), lost = half_variogram(i, j);
    const double g = a * b * lost + (a - b) * (a * of_i - b * of_j) / 2;
    const double slope = a * (lost - (of_i + of_j) / 2) + b * of_j;
    total.sum += mask.area * g + of_j / 2 * mask.squares;
    total.squares += mask.area * g * g + (slope * slope + g * of_j) * mask.squares +
                     slope * of_j * mask.cubes + of_j * of_j / 4 * mask.fourths;
  }

  const MaskedField& field_;
  const PointTree& tree_;
  std::vector<double> variances_;  // of the covariance, where it is not the correlation
  std::vector<CellMask> masks_;    // of each cell
};

}  // namespace

// In g_ij, which centring leaves as it is, strongly correlated surfaces keep their digits.
MeanSquareMoments mean_square_moments(const MaskedField& field) {
  const PointTree tree(field.correlation.places(), field.correlation.distance());
  const PairSums pairs(field, tree);
  const bool is_exact = field.areas.size() <= most_exact_points;
  const bool has_cells = field.correlation.distance().kind() != DistanceKind::curve;
  const std::vector<Source> sources =
      is_exact ? all_points(field) : sampled_sources(field, tree.curve());
  std::vector<Decorrelation> rows(sources.size());
  parallel_for(sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      rows[k] = pairs.from(sources[k].point, !is_exact && has_cells ? far_angle : 0);
  });
  const double area = area_of(field, tree.curve());
  double mean = 0, mean_of_squares = 0, square_of_means = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double share = sources[k].area / area, of_row = rows[k].sum / area;
    mean += share * of_row;
    mean_of_squares += share * rows[k].squares / area;
    square_of_means += share * of_row * of_row;
  }
  return {mean, 2 * std::max(0.0, mean_of_squares - 2 * square_of_means + mean * mean)};
}

}  // namespace roughmesh::detail
