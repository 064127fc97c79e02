// SPDX-License-Identifier: BSD-3-Clause
// The distance to the nearest other place is the one that looking at all of them finds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "nearest.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh::detail {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Distance of a difference, or of the shortest of its images that is not 0.
double shortest_image(const Vec3& difference, const Vec3& period) {
  double shortest = inf;
  std::array<int, 3> far{};
  for (int axis = 0; axis < 3; ++axis)
    far[static_cast<std::size_t>(axis)] = period[axis] > 0 ? 1 : 0;
  for (int i = -far[0]; i <= far[0]; ++i)
    for (int j = -far[1]; j <= far[1]; ++j)
      for (int k = -far[2]; k <= far[2]; ++k) {
        const Vec3 image = difference + Vec3(i, j, k).cwiseProduct(period);
        if (image != Vec3::Zero()) shortest = std::min(shortest, image.norm());
      }
  return shortest;
}

void expect_brute_force(const std::vector<Vec3>& places, const Vec3& period = Vec3::Zero()) {
  const std::vector<double> distances = nearest_distances(places, period);
  ASSERT_EQ(distances.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    double shortest = inf;
    for (const Vec3& y : places)
      shortest = std::min(shortest, shortest_image(places[i] - y, period));
    if (shortest == inf)
      ASSERT_EQ(distances[i], inf) << i;
    else
      ASSERT_NEAR(distances[i], shortest, 1e-14 * (shortest + places[i].norm() + period.norm()))
          << i;
  }
}

std::vector<Vec3> random_places(int n, const Vec3& size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Vec3> places(static_cast<std::size_t>(n));
  for (Vec3& x : places) x = Vec3(part(random), part(random), part(random)).cwiseProduct(size);
  return places;
}

TEST(NearestDistances, AreThoseOfAllPairs) {
  for (const int n : {2, 3, 17, 700}) expect_brute_force(random_places(n, {1, 2, 3}));
  expect_brute_force(random_places(500, {1, 0, 0}));
  expect_brute_force(random_places(500, {0, 1e-9, 2e-9}));
  expect_brute_force(test::sorted(test::icosphere(3).nodes));
  expect_brute_force(test::plate(20).nodes);
}

// Distances of neighbours grow a million times across the mesh.
TEST(NearestDistances, HoldOnGradedMeshes) {
  std::vector<Vec3> places = random_places(600, {1, 1, 1});
  for (Vec3& x : places) x = x.array().pow(12);
  expect_brute_force(places);
}

// Near one face of the period the nearest place is an image from the other face, edge or corner.
TEST(NearestDistances, CountImages) {
  for (const Vec3& period : {Vec3(1, 0, 0), Vec3(1, 0, 2), Vec3(1, 1.5, 2)})
    for (const int n : {1, 2, 5, 300}) {
      std::vector<Vec3> places = random_places(n, {1, 1.5, 2});
      expect_brute_force(places, period);
      for (std::size_t i = 0; i < places.size(); i += 2)  // all near the corners of the cell
        for (int axis = 0; axis < 3; ++axis) {
          double& x = places[i][axis];
          x = (i / 2 >> axis) % 2 == 0 ? 1e-3 * x : Vec3(1, 1.5, 2)[axis] - 1e-3 * x;
        }
      expect_brute_force(places, period);
    }
}

TEST(NearestDistances, PassOverEqualPlaces) {
  std::vector<Vec3> places;
  for (const Vec3& x : random_places(60, {1, 1, 1}))
    for (std::size_t n = 0; n <= places.size() % 4; ++n) places.push_back(x);
  ASSERT_GT(places.size(), 100U);
  expect_brute_force(places);
  expect_brute_force(places, {1, 1, 0});
}

TEST(NearestDistances, AreInfiniteWhereAllPlacesAreEqual) {
  EXPECT_TRUE(nearest_distances({}, Vec3::Zero()).empty());
  for (const std::size_t n : {1, 2, 50})
    EXPECT_EQ(nearest_distances(std::vector<Vec3>(n, Vec3(1, 2, 3)), Vec3::Zero()),
              std::vector<double>(n, inf));
}

// Powers of two: the same bits in any unit.
TEST(NearestDistances, ScaleWithTheUnitOfLength) {
  const std::vector<Vec3> places = random_places(200, {1, 2, 3});
  const std::vector<double> plain = nearest_distances(places, {4, 0, 4});
  for (const double unit : {0x1p-200, 0x1p-30, 0x1p30, 0x1p200}) {
    std::vector<Vec3> scaled = places;
    for (Vec3& x : scaled) x *= unit;
    const std::vector<double> distances = nearest_distances(scaled, unit * Vec3(4, 0, 4));
    for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(distances[i], unit * plain[i]);
  }
}

}  // namespace
}  // namespace roughmesh::detail
