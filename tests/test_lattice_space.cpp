// SPDX-License-Identifier: BSD-3-Clause
// The space of the method `lattice` keeps distances, and sorts places into absolute cells.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "lattice_space.hpp"
#include "nearest_image.hpp"

namespace roughmesh::detail {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_places(std::size_t n, const Vec3& centre, double size) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < n; ++i)
    places.emplace_back(centre + size * Vec3(part(random), part(random), part(random)));
  return places;
}

std::vector<Anisotropy> anisotropies() {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).matrix();
  return {{.lengths = {1, 1, 1}},
          {.lengths = {1, 0.2, 3}},
          {.lengths = {inf, 0.5, 2}},
          {.lengths = {1, inf, inf}},
          {.lengths = {0.5, inf, 2}, .axes = turned},
          {.lengths = {1, 0.2, 3}, .axes = turned}};
}

TEST(LatticeSpace, KeepsDistances) {
  const std::vector<Vec3> places = random_places(50, {1, -2, 3}, 4);
  for (const Anisotropy& anisotropy : anisotropies()) {
    const Distance distance = Distance::stretched(anisotropy);
    const LatticeSpace space(distance, 3);
    for (const Vec3& x : places)
      EXPECT_NEAR((space(x) - space(places[0])).norm(), distance(x, places[0]), 1e-13);
  }
}

// Axes without variation come first, so that the others are the inner loops.
TEST(LatticeSpace, PutsAxesWithoutVariationFirst) {
  for (const Anisotropy& anisotropy : anisotropies()) {
    const LatticeSpace space(Distance::stretched(anisotropy), 3);
    const auto n_infinite = std::count(anisotropy.lengths.begin(), anisotropy.lengths.end(), inf);
    EXPECT_EQ(space.n_varying(), 3 - n_infinite);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(space.varies(axis), axis >= n_infinite);
      EXPECT_EQ(space(Vec3(3, -4, 5))[axis] != 0, space.varies(axis));
    }
  }
}

TEST(LatticeSpace, LeavesTheThirdCoordinateOfAPlaneOut) {
  const LatticeSpace space(Distance::euclidean(), 2);
  EXPECT_EQ(space.n_varying(), 2);
  EXPECT_EQ(space(Vec3(1, 2, 3)), space(Vec3(1, 2, -77)));
  EXPECT_DOUBLE_EQ((space(Vec3(1, 2, 3)) - space(Vec3(4, 6, 8))).norm(), 5);
}

TEST(LatticeSpace, ReducesToOnePeriod) {
  const Vec3 period(1, 0, 2.5);
  const Anisotropy anisotropy{.lengths = {1, 0.5, 3},
                              .axes = Eigen::Matrix3d(Vec3(-1, 1, -1).asDiagonal())};
  const Distance distance = Distance::periodic(period, anisotropy);
  const LatticeSpace space(distance, 3);
  std::vector<Vec3> places = random_places(200, Vec3::Zero(), 20);
  for (const double x : {0.0, -0.0, 1.0, -1e-300, -1e-17, 1 - 1e-17, 7.0})
    places.emplace_back(x, x, x);
  const Vec3 around(space.period(0), space.period(1), space.period(2));
  EXPECT_EQ(around[1], 0);
  for (const Vec3& x : places) {
    const Vec3 y = space(x);
    for (const int axis : {0, 2}) EXPECT_TRUE(y[axis] >= 0 && y[axis] < around[axis]) << y[axis];
    EXPECT_NEAR(nearest_image(y - space(places[0]), around).norm(), distance(x, places[0]), 1e-12);
  }
}

/// Clouds of any size and place, with equal places and near ones between them.
std::vector<std::vector<Vec3>> clouds() {
  std::vector<std::vector<Vec3>> result = {
      random_places(300, Vec3::Zero(), 1),     random_places(300, {3, -8, 2}, 100),
      random_places(300, {1e6, -1e6, 1e6}, 1), random_places(300, {1e9, 0, 0}, 1e-3),
      random_places(1, {1e9, -3, 0}, 1),       random_places(2, Vec3::Zero(), 1e-12)};
  std::vector<Vec3> together;
  for (const Vec3& x : random_places(40, Vec3::Zero(), 1))
    for (int k = 0; k < 9; ++k) together.emplace_back(x + (k % 3) * Vec3(1e-8, -2e-8, 1e-8));
  std::shuffle(together.begin(), together.end(), std::mt19937(1));
  result.push_back(together);
  return result;
}

TEST(SortedPlaces, AreThePlacesInAnotherOrder) {
  for (const std::vector<Vec3>& cloud : clouds()) {
    const SortedPlaces sorted(cloud, 0.7);
    ASSERT_EQ(sorted.size(), cloud.size());
    std::vector<std::uint32_t> order = sorted.order();
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(sorted.places()[i], cloud[order[i]]);
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
  }
}

// Equal places among them, which only their numbers tell apart.
TEST(SortedPlaces, AreFoundByNumberAndPlace) {
  for (const std::vector<Vec3>& cloud : clouds()) {
    const SortedPlaces sorted(cloud, 0.7);
    for (std::size_t i = 0; i < sorted.size(); ++i)
      ASSERT_EQ(sorted.position(sorted.order()[i], sorted.places()[i]), i);
  }
}

TEST(SortedPlaces, KeepEqualPlacesTogether) {
  for (const std::vector<Vec3>& cloud : clouds()) {
    const SortedPlaces sorted(cloud, 0.7);
    std::vector<Vec3> seen;  // one of each run
    for (const Vec3& x : sorted.places()) {
      if (!seen.empty() && seen.back() == x) continue;
      EXPECT_EQ(std::find(seen.begin(), seen.end(), x), seen.end());
      seen.push_back(x);
    }
  }
}

Vec3 cell_of(const Vec3& place, double edge) { return (place / edge).array().floor(); }

// Cells of the edge times any power of 2 are absolute. Of those so large that two or more would
// hold all places there may be parts, but never a part of two.
TEST(SortedPlaces, FillCellsOneByOne) {
  const double edge = 0.7;
  for (const std::vector<Vec3>& cloud : clouds()) {
    const SortedPlaces sorted(cloud, edge);
    for (int doubling = -3; doubling <= 60; ++doubling) {
      const double size = std::ldexp(edge, doubling);
      if (sorted.n_doublings(size) > 20) continue;  // too small for the cloud
      const auto cells = sorted.cells(1.4 * size);
      std::size_t next = 0;
      for (const auto& [first, end] : cells) {
        ASSERT_EQ(first, next);
        ASSERT_LT(first, end);
        for (std::size_t i = first; i < end; ++i)
          ASSERT_EQ(cell_of(sorted.places()[i], size), cell_of(sorted.places()[first], size));
        next = end;
      }
      ASSERT_EQ(next, cloud.size());
      if (sorted.n_doublings(size) < 0) {
        EXPECT_LE(cells.size(), 8U);
        continue;
      }
      for (std::size_t k = 1; k < cells.size(); ++k)  // no cell in two parts
        ASSERT_NE(cell_of(sorted.places()[cells[k].first], size),
                  cell_of(sorted.places()[cells[k - 1].first], size));
    }
  }
}

TEST(SortedPlaces, SplitCellsIntoSmallerOnes) {
  const SortedPlaces sorted(random_places(300, {3, -8, 2}, 100), 0.7);
  std::vector<SortedPlaces::Range> split;
  for (const SortedPlaces::Range& cell : sorted.cells(0.7 * 32))
    for (const SortedPlaces::Range& part : sorted.cells(cell, 0.7 * 8)) split.push_back(part);
  EXPECT_EQ(split, sorted.cells(0.7 * 8));
}

}  // namespace
}  // namespace roughmesh::detail
