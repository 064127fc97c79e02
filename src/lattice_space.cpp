// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_space.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "morton.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

/// Axes along which the field varies come last: the innermost loops run along them.
std::array<int, 3> axes_in_order(const std::array<bool, 3>& varies) {
  std::array<int, 3> order = {0, 1, 2};
  std::stable_partition(order.begin(), order.end(),
                        [&](int axis) { return !varies[static_cast<std::size_t>(axis)]; });
  return order;
}

double reduced(double x, double period) {
  const double rest = x - period * std::floor(x / period);
  return rest < period ? rest : 0;  // rounding may reach the period itself
}

/// By coordinates, so that equal places follow each other; places in a smallest cell are few.
/// @param codes  in the order of the places before, ascending
void sort_within_cells(const std::vector<Vec3>& places, const std::vector<std::uint64_t>& codes,
                       std::vector<std::uint32_t>& order) {
  const auto is_before = [&](std::uint32_t i, std::uint32_t j) {
    const Vec3 &x = places[i], &y = places[j];
    return std::tie(x[0], x[1], x[2], i) < std::tie(y[0], y[1], y[2], j);
  };
  for (std::size_t first = 0, end = 0; first < codes.size(); first = end) {
    for (end = first + 1; end < codes.size() && codes[end] == codes[first];) ++end;
    if (end - first > 1)
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(first),
                order.begin() + static_cast<std::ptrdiff_t>(end), is_before);
  }
}

/// values[order[i]] for each i.
template <class Value>
std::vector<Value> in_order(const std::vector<Value>& values,
                            const std::vector<std::uint32_t>& order) {
  std::vector<Value> result(values.size());
  parallel_for(values.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = values[order[i]];
  });
  return result;
}

}  // namespace

LatticeSpace::LatticeSpace(const Distance& distance, int dimension) {
  const Eigen::Matrix3d& stretch = distance.stretch();
  std::array<bool, 3> varies{};
  for (int axis = 0; axis < 3; ++axis)
    varies[static_cast<std::size_t>(axis)] = !stretch.row(axis).isZero(0);
  // In a plane the third coordinate is the same for all, and counts for nothing where it stands
  // alone.
  if (dimension == 2 && stretch(2, 0) == 0 && stretch(2, 1) == 0) varies[2] = false;
  const std::array<int, 3> order = axes_in_order(varies);
  for (int k = 0; k < 3; ++k) {
    const int axis = order[static_cast<std::size_t>(k)];
    varies_[static_cast<std::size_t>(k)] = varies[static_cast<std::size_t>(axis)];
    stretch_.row(k).setZero();
    if (!varies_[static_cast<std::size_t>(k)]) continue;
    stretch_.row(k) = stretch.row(axis);
    period_[k] = std::abs(stretch(axis, axis)) * distance.period()[axis];
  }
}

Vec3 LatticeSpace::operator()(const Vec3& x) const {
  Vec3 y = stretch_ * x;
  for (int axis = 0; axis < 3; ++axis)
    if (period_[axis] > 0) y[axis] = reduced(y[axis], period_[axis]);
  return y;
}

int LatticeSpace::n_varying() const {
  return static_cast<int>(std::count(varies_.begin(), varies_.end(), true));
}

SortedPlaces::SortedPlaces(std::vector<Vec3> places, double cell) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  // 2^20 of the smallest cells hold all places; their numbers then have 21 bits, counted from a
  // multiple of 2^20.
  const double extent = std::max(box.sizes().maxCoeff(), 0x1p-20 * cell);
  quantum_ = cell * std::exp2(std::ceil(std::log2(extent / cell)) - 19);
  constexpr double block = 0x1p20;
  base_ = (box.min() / quantum_ / block).array().floor() * block;
  codes_.resize(places.size());
  parallel_for(places.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) codes_[i] = code(places[i]);
  });
  const std::vector<Index> order = morton_order(codes_);
  order_.assign(order.begin(), order.end());
  codes_ = in_order(codes_, order_);
  sort_within_cells(places, codes_, order_);
  places_ = in_order(places, order_);
}

std::uint64_t SortedPlaces::code(const Vec3& place) const {
  const Vec3 number = (place / quantum_).array().floor() - base_.array();
  return morton_code(static_cast<std::uint64_t>(number.x()), static_cast<std::uint64_t>(number.y()),
                     static_cast<std::uint64_t>(number.z()));
}

std::size_t SortedPlaces::position(std::uint32_t number, const Vec3& place) const {
  const std::uint64_t cell = code(place);
  const auto is_before = [&](std::size_t i) {
    const Vec3& x = places_[i];
    return std::tie(codes_[i], x[0], x[1], x[2], order_[i]) <
           std::tie(cell, place[0], place[1], place[2], number);
  };
  std::size_t first = 0;
  for (std::size_t n = size(); n > 0;) {  // of those from `first` on, some may come before
    const std::size_t half = n / 2;
    if (is_before(first + half)) {
      first += half + 1;
      n -= half + 1;
    } else {
      n = half;
    }
  }
  return first;
}

int SortedPlaces::n_doublings(double edge) const {
  return 20 - static_cast<int>(std::lround(std::log2(edge / quantum_)));
}

std::vector<SortedPlaces::Range> SortedPlaces::cells(Range within, double largest) const {
  const double depth = std::clamp(std::floor(std::log2(largest / quantum_) + 1e-9), 0.0, 20.0);
  const int shift = 3 * static_cast<int>(depth);
  std::vector<Range> result;
  for (std::size_t first = within.first; first < within.second;) {
    std::size_t end = first + 1;
    while (end < within.second && codes_[end] >> shift == codes_[first] >> shift) ++end;
    result.emplace_back(first, end);
    first = end;
  }
  return result;
}

}  // namespace roughmesh::detail
