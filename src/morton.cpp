// SPDX-License-Identifier: BSD-3-Clause
#include "morton.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <numeric>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 1 << 14;

/// Takes the low 21 bits of a number three places apart.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

struct Key {
  std::uint64_t code;
  Index point;
};

bool operator<(const Key& a, const Key& b) {
  return a.code != b.code ? a.code < b.code : a.point < b.point;
}

/// Codes by their leading bits. Sorting each bucket by itself stays in the caches of a core, so
/// that many points take hardly longer each than a few.
class Buckets {
 public:
  explicit Buckets(std::span<const std::uint64_t> codes)
      : first_(*std::min_element(codes.begin(), codes.end())),
        shift_(shift(*std::max_element(codes.begin(), codes.end()) - first_)) {
    ends_.fill(0);
    for (const std::uint64_t code : codes) ++ends_[number(code)];
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
  }

  std::vector<Key> sorted(std::span<const std::uint64_t> codes) const {
    std::vector<Key> keys(codes.size());
    auto next = ends_;
    for (std::size_t i = codes.size(); i-- > 0;)
      keys[--next[number(codes[i])]] = {codes[i], static_cast<Index>(i)};
    parallel_for(next.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        std::sort(keys.data() + next[b], keys.data() + ends_[b]);
    });
    return keys;
  }

 private:
  static constexpr int bits = 12;

  static int shift(std::uint64_t largest) {
    return std::max(static_cast<int>(std::bit_width(largest)) - bits, 0);
  }
  std::size_t number(std::uint64_t code) const {
    return static_cast<std::size_t>((code - first_) >> shift_);
  }

  std::uint64_t first_;
  int shift_;
  std::array<std::size_t, std::size_t{1} << bits> ends_;
};

}  // namespace

std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

std::vector<std::uint64_t> morton_codes(std::span<const Vec3> places, double shift) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  const double width = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());
  const double scale = shift > 0 ? 0.5 : 1;
  std::vector<std::uint64_t> codes(places.size());
  parallel_for(places.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const double part = ((places[i] - box.min())[axis] / width + shift) * scale;  // in [0, 1]
        const double cell = std::min(part * 0x1p21, 0x1p21 - 1);
        codes[i] |= spread_bits(static_cast<std::uint64_t>(cell)) << axis;
      }
  });
  return codes;
}

std::vector<Index> morton_order(std::span<const std::uint64_t> codes) {
  std::vector<Index> order(codes.size());
  if (codes.empty()) return order;
  const Buckets buckets(codes);
  const std::vector<Key> keys = buckets.sorted(codes);
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = keys[k].point;
  return order;
}

std::vector<Index> morton_order(std::span<const Vec3> places) {
  return morton_order(morton_codes(places));
}

std::vector<Vec3> comparable_places(std::span<const Vec3> places, const Distance& distance) {
  double step = 1;
  if (distance.kind() == DistanceKind::curve) {
    step = 0;
    for (const Vec3& x : places) step = std::max(step, x.x());
  }
  std::vector<Vec3> result(places.begin(), places.end());
  for (Vec3& x : result) x = distance.stretch() * Vec3(x.x(), step * x.y(), x.z());
  return result;
}

std::vector<Index> morton_order(std::span<const Vec3> places, const Distance& distance) {
  if (distance.kind() != DistanceKind::curve && distance.stretch().isIdentity(0))
    return morton_order(places);
  return morton_order(comparable_places(places, distance));
}

}  // namespace roughmesh::detail
