// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "roughmesh/distance.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

TEST(Distance, HalfTheCircumferenceToTheAntipode) {
  const Mesh mesh = test::icosphere(2, 3.0);
  const Distance distance = Distance::great_circle(mesh.nodes);
  for (const Vec3& x : mesh.nodes) EXPECT_NEAR(distance(x, -x), 3 * std::numbers::pi, 1e-12);
}
