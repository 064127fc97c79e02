// SPDX-License-Identifier: BSD-3-Clause
// Heights along the normals.
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/displace.hpp"

#include "support/cells.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

std::vector<double> constant(const Surface& surface, double height) {
  return std::vector<double>(surface.points.size(), height);
}

}  // namespace

TEST(Displace, EachPointMovesAlongItsNormalByItsHeight) {
  const Surface surface = select_surface(test::icosphere(2));
  std::vector<double> heights(surface.points.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = std::sin(3.0 * static_cast<double>(i));
  const std::vector<Vec3> displacements = displace(surface, heights);
  ASSERT_EQ(displacements.size(), heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    EXPECT_EQ(displacements[i], heights[i] * surface.normals[i]);
}

// Exact normals turn a constant height c into a scaling by 1 + c: the volume grows by (1 + c)^3.
TEST(Displace, AConstantPositiveHeightInflatesASphere) {
  const Surface surface = select_surface(test::icosphere(2));
  const double before = enclosed_volume(surface, surface.points);
  for (const double c : {0.1, -0.1}) {
    const auto moved = moved_points(surface, displace(surface, constant(surface, c)));
    EXPECT_NEAR(enclosed_volume(surface, moved), before * std::pow(1 + c, 3), 1e-13);
  }
}

// Outward is outward whatever way the file has it, and flipping turns growth into shrinkage.
TEST(Displace, GrowthDoesNotDependOnTheOrientationOfTheFile) {
  Mesh mesh = test::icosphere(1);
  for (Index e = 0; e < mesh.blocks[0].size(); ++e) test::turn_element(mesh.blocks[0], e);
  for (const bool flip : {false, true}) {
    const Surface surface = select_surface(mesh, {.flip = flip});
    const auto moved = moved_points(surface, displace(surface, constant(surface, 0.1)));
    const double change = std::abs(enclosed_volume(surface, moved)) -
                          std::abs(enclosed_volume(surface, surface.points));
    EXPECT_EQ(change > 0, !flip);
  }
}

TEST(Displace, OneHeightPerPointIsNeeded) {
  const Surface surface = select_surface(test::icosphere(0));
  EXPECT_THROW(displace(surface, std::vector<double>(11)), InputError);
  EXPECT_THROW(displace(surface, {}), InputError);
}
