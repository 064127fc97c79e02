// SPDX-License-Identifier: BSD-3-Clause
#include "coincident.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace roughmesh::detail {
namespace {

// A position by a hash of its numbers, so that equal positions come together when sorted.
struct Key {
  std::uint32_t hash;
  Index index;
};

// Finalizer of MurmurHash3 (A. Appleby, public domain): every bit of the input changes half of the
// output.
std::uint64_t mixed(std::uint64_t word) {
  word = (word ^ (word >> 33)) * 0xff51afd7ed558ccdULL;
  word = (word ^ (word >> 33)) * 0xc4ceb9fe1a85ec53ULL;
  return word ^ (word >> 33);
}

std::uint32_t hash_of(const Vec3& x) {
  std::uint64_t value = 0;
  for (const double c : x) value = mixed(value + std::bit_cast<std::uint64_t>(c + 0.0));  // no -0
  return static_cast<std::uint32_t>(value);
}

std::vector<Key> keys_of(const std::vector<Vec3>& positions) {
  std::vector<Key> keys(positions.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = {hash_of(positions[i]), static_cast<Index>(i)};
  return keys;
}

// One pass of a radix sort: stable, by 11 bits.
void sort_by_bits(std::span<const Key> from, std::span<Key> to, int shift) {
  constexpr std::uint32_t mask = 0x7ff;
  std::array<std::size_t, mask + 2> starts{};
  for (const Key& key : from) ++starts[((key.hash >> shift) & mask) + 1];
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
  for (const Key& key : from) to[starts[(key.hash >> shift) & mask]++] = key;
}

// By hash, and by index among equal hashes.
void sort_keys(std::vector<Key>& keys) {
  std::vector<Key> other(keys.size());
  for (const int shift : {0, 11, 22}) {
    sort_by_bits(keys, other, shift);
    keys.swap(other);
  }
}

bool comes_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// Keys of one hash, by index. They are nearly always of one position; where they are not, sorting
// has no worst case that a file could be made for.
void find_first(const std::vector<Vec3>& positions, std::span<Key> keys,
                std::vector<Index>& first) {
  const auto is_at = [&](const Key& key, const Vec3& x) { return positions[key.index] == x; };
  const Vec3& start = positions[keys[0].index];
  if (!std::all_of(keys.begin(), keys.end(), [&](const Key& key) { return is_at(key, start); }))
    std::stable_sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
      return comes_before(positions[a.index], positions[b.index]);
    });
  Index latest = keys[0].index;
  for (const Key& key : keys) {
    if (!is_at(key, positions[latest])) latest = key.index;
    first[key.index] = latest;
  }
}

}  // namespace

std::vector<Index> first_at_each_position(const std::vector<Vec3>& positions) {
  std::vector<Key> keys = keys_of(positions);
  sort_keys(keys);
  std::vector<Index> first(positions.size());
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end].hash == keys[begin].hash) ++end;
    find_first(positions, std::span(keys).subspan(begin, end - begin), first);
  }
  return first;
}

}  // namespace roughmesh::detail
