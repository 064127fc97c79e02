// SPDX-License-Identifier: BSD-3-Clause
// Morton's curve: the code interleaves the bits of the coordinates, and the order is that of the
// codes on any number of threads.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "morton.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

// Points of a sphere along a spiral.
std::vector<Vec3> spiral(std::size_t n) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double angle = 2.399963 * static_cast<double>(i), r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

// Bit by bit, of a place in the unit cube: the 21 highest of each coordinate, x lowest.
std::uint64_t code_of(const Vec3& place) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 21; ++bit)
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = std::min(std::floor(std::ldexp(place[axis], 21)), std::ldexp(1, 21) - 1);
      if (std::fmod(std::floor(std::ldexp(cell, -bit)), 2) == 1)
        code |= std::uint64_t{1} << (3 * bit + axis);
    }
  return code;
}

TEST(Morton, CodesInterleaveTheBitsOfTheCoordinates) {
  std::vector<Vec3> places = spiral(500);
  for (Vec3& x : places) x = (x + Vec3::Ones()) / 2;
  places.insert(places.end(), {Vec3::Zero(), Vec3::Ones()});  // the box is the unit cube
  const std::vector<std::uint64_t> codes = morton_codes(places);
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(codes[i], code_of(places[i])) << i;
  EXPECT_EQ(*std::max_element(codes.begin(), codes.end()), (std::uint64_t{1} << 63) - 1);
}

TEST(Morton, ShiftMovesThePlacesAlongTheDiagonalOfACurveOfTwiceTheSize) {
  std::vector<Vec3> places = spiral(500);
  for (Vec3& x : places) x = (x + Vec3::Ones()) / 2;
  places.insert(places.end(), {Vec3::Zero(), Vec3::Ones()});
  const std::vector<std::uint64_t> codes = morton_codes(places, 0.375);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_EQ(codes[i], code_of((places[i] + 0.375 * Vec3::Ones()) / 2)) << i;
}

TEST(Morton, OrderIsThatOfTheCodesAndThenOfTheNumbersOnAnyThreads) {
  std::vector<Vec3> places = spiral(100'000);
  for (std::size_t i = 0; i < places.size(); i += 7) places[i] = places[0];  // many equal codes
  const std::vector<std::uint64_t> codes = morton_codes(places);
  std::vector<Index> expected(places.size());
  std::iota(expected.begin(), expected.end(), Index{0});
  std::stable_sort(expected.begin(), expected.end(),
                   [&](Index i, Index j) { return codes[i] < codes[j]; });
  for (const int n_threads : {1, 2, 5}) {
    const ThreadLimit limit(n_threads);
    EXPECT_EQ(morton_order(places), expected) << n_threads;
  }
}

TEST(Morton, PlacesWithoutExtentAreAllInTheFirstCell) {
  EXPECT_TRUE(morton_order(std::vector<Vec3>{}).empty());
  EXPECT_EQ(morton_codes(std::vector<Vec3>(3, Vec3(1e300, -5, 0))),
            std::vector<std::uint64_t>(3, 0));
}

// Codes that share their leading bits, codes far from 0, codes all over, and the same ones again.
TEST(Morton, OrderOfAnyCodesIsThatOfAStableSort) {
  std::mt19937_64 random(1);
  for (const int bits : {0, 1, 5, 12, 13, 40, 63}) {
    std::vector<std::uint64_t> codes(20'000);
    for (std::uint64_t& code : codes) code = (random() >> 1) & ((std::uint64_t{1} << bits) - 1);
    const std::uint64_t most = *std::max_element(codes.begin(), codes.end());
    for (std::uint64_t& code : codes) code += (std::uint64_t{1} << 63) - 1 - most;
    std::vector<Index> expected(codes.size());
    std::iota(expected.begin(), expected.end(), 0);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](Index a, Index b) { return codes[a] < codes[b]; });
    EXPECT_EQ(morton_order(codes), expected) << bits << " bits";
  }
  EXPECT_TRUE(morton_order(std::vector<std::uint64_t>{}).empty());
}

}  // namespace
}  // namespace roughmesh::detail
