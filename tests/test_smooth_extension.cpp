// SPDX-License-Identifier: BSD-3-Clause
// The clamped plate that carries displacements from sharp edges into faces.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/error.hpp"

#include "free_memory.hpp"
#include "smooth_extension.hpp"

namespace roughmesh::detail {
namespace {

struct Fan {
  std::vector<Vec3> nodes;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<NodeRole> roles;
};

/// A disc: node 0 in the middle, a ring of n nodes around it, another ring that is given.
Fan make_fan(Index n) {
  Fan fan{{Vec3::Zero()}, {}, {NodeRole::sought}};
  for (const int ring : {1, 2})
    for (Index k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      fan.nodes.emplace_back(ring * std::cos(angle), ring * std::sin(angle), 0);
      fan.roles.push_back(ring == 1 ? NodeRole::sought : NodeRole::given);
    }
  for (Index k = 0; k < n; ++k) {
    const Index a = 1 + k, b = 1 + (k + 1) % n;
    fan.triangles.push_back({0, a, b});
    fan.triangles.push_back({a, a + n, b + n});
    fan.triangles.push_back({a, b + n, b});
  }
  return fan;
}

// A constant has no Laplacian, so it is its own continuation.
TEST(SmoothExtension, ConstantsContinue) {
  const Fan fan = make_fan(12);
  const SmoothExtension extension(fan.nodes, fan.triangles, fan.roles);
  ASSERT_EQ(extension.given().size(), 12u);
  ASSERT_EQ(extension.sought().size(), 13u);
  const Vec3 constant(1, -2, 0.5);
  for (const Vec3& u : extension.extend(std::vector<Vec3>(12, constant)))
    EXPECT_LT((u - constant).norm(), 1e-12);
}

// The square of a row of n numbers has n^2 of them, whatever a factorization makes of it.
TEST(SmoothExtension, ANodeOfVeryManyTrianglesIsRefusedBeforeTheWork) {
  if (!free_memory()) GTEST_SKIP() << "free memory is not known here";
  const Fan fan = make_fan(1'000'000);
  try {
    const SmoothExtension extension(fan.nodes, fan.triangles, fan.roles);
    ADD_FAILURE() << "accepted 10^12 numbers";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("choose --edges average"), std::string::npos);
  }
}

}  // namespace
}  // namespace roughmesh::detail
