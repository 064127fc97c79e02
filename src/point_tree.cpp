// SPDX-License-Identifier: BSD-3-Clause
#include "point_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "morton.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr Index most_points_of_leaf = 16;

template <class Value>
std::vector<Value> taken_along(std::span<const Index> curve, std::span<const Value> values) {
  constexpr std::size_t grain = 1 << 14;
  std::vector<Value> result(curve.size());
  parallel_for(curve.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) result[k] = values[curve[k]];
  });
  return result;
}

std::size_t nearest_to_mean(std::span<const Vec3> places) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : places) mean += x;
  mean /= static_cast<double>(places.size());
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double square = (places[k] - mean).squaredNorm();
    if (square < least) nearest = k;
    least = std::min(least, square);
  }
  return nearest;
}

double radius_about(const Vec3& centre, std::span<const Vec3> places) {
  double square = 0;
  for (const Vec3& x : places) square = std::max(square, (x - centre).squaredNorm());
  return std::sqrt(square);
}

}  // namespace

PointTree::PointTree(std::span<const Vec3> places, const Distance& distance)
    : places_(places), distance_(distance) {
  const std::vector<Vec3> comparable = comparable_places(places, distance);
  std::vector<std::uint64_t> codes = morton_codes(comparable);
  curve_ = morton_order(codes);
  codes = taken_along<std::uint64_t>(curve_, codes);
  if (!curve_.empty()) add_cell(codes, 0, static_cast<Index>(curve_.size()));
  find_centres(taken_along<Vec3>(curve_, comparable));
}

// The parts of a cell differ in the highest of their digits, three bits each, that is not common to
// all. Points of one code are not parted.
void PointTree::add_cell(std::span<const std::uint64_t> codes, Index begin, Index end) {
  const std::size_t cell = cells_.size();
  cells_.push_back({begin, end});
  const std::uint64_t differing = codes[begin] ^ codes[end - 1];
  if (end - begin > most_points_of_leaf && differing != 0) {
    const int shift = static_cast<int>(std::bit_width(differing) - 1) / 3 * 3;
    for (Index first = begin; first < end;) {
      const std::uint64_t last_code = codes[first] | ((std::uint64_t{1} << shift) - 1);
      const auto last = std::upper_bound(codes.begin() + first, codes.begin() + end, last_code);
      const auto next = static_cast<Index>(last - codes.begin());
      add_cell(codes, first, next);
      first = next;
    }
  }
  cells_[cell].next = static_cast<Index>(cells_.size());
}

void PointTree::find_centres(std::span<const Vec3> along_curve) {
  constexpr std::size_t grain = 64;
  parallel_for(cells_.size(), grain, [&](std::size_t first, std::size_t last) {
    for (PointCell& cell : std::span(cells_).subspan(first, last - first)) {
      const auto places = along_curve.subspan(cell.begin, cell.end - cell.begin);
      const std::size_t centre = nearest_to_mean(places);
      cell.point = curve_[cell.begin + static_cast<Index>(centre)];
      cell.radius = radius_about(places[centre], places);
    }
  });
}

}  // namespace roughmesh::detail
