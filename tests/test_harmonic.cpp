// SPDX-License-Identifier: BSD-3-Clause
// The weighted harmonic extension by itself.
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "harmonic.hpp"
#include "support/cells.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

// Every node with z < 1/2 is given, every other one unknown; nothing stays.
detail::NodeRoles half_given(const Mesh& mesh) {
  detail::NodeRoles roles;
  for (const Vec3& x : mesh.nodes) {
    roles.given.push_back(x.z() < 0.5 ? roles.n_given++ : -1);
    roles.unknown.push_back(x.z() < 0.5 ? -1 : roles.n_unknown++);
  }
  return roles;
}

std::vector<detail::Simplex> tetrahedra(const Mesh& mesh) {
  std::vector<detail::Simplex> result;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; block.type.shape == ElementShape::tetrahedron && e < block.size(); ++e) {
      const auto t = block.element(e);
      result.push_back({t[0], t[1], t[2], t[3]});
    }
  return result;
}

}  // namespace

TEST(Harmonic, TheStiffnessIsSymmetricAndPositiveDefinite) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const detail::HarmonicExtension extension(mesh.nodes, tetrahedra(mesh), half_given(mesh));
  const Eigen::MatrixXd stiffness = extension.stiffness();
  EXPECT_EQ(stiffness, stiffness.transpose());
  EXPECT_EQ(stiffness.llt().info(), Eigen::Success);
}

// A node in 100,000 tetrahedra around an axis: time that grows with their square would be noticed.
// Constants are solutions; gradients of 1e5 along the rim cancel to 1e-16 of that per tetrahedron.
TEST(Harmonic, ANodeOfManyElements) {
  const Index n = 100'000;
  std::vector<Vec3> nodes = {{0, 0, 0}, {0, 0, 1}};
  std::vector<detail::Simplex> fan;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    nodes.emplace_back(std::cos(angle), std::sin(angle), 0);
    fan.push_back({0, 2 + i, 2 + (i + 1) % n, 1});
  }
  detail::NodeRoles roles;
  roles.unknown.assign(nodes.size(), -1);
  roles.unknown[0] = roles.n_unknown++;
  roles.given.assign(nodes.size(), -1);
  for (std::size_t node = 1; node < nodes.size(); ++node) roles.given[node] = roles.n_given++;
  const detail::HarmonicExtension extension(nodes, fan, roles);
  const std::vector<Vec3> given(nodes.size() - 1, Vec3(1, 2, 3));
  EXPECT_NEAR((extension.extend(given)[0] - given[0]).norm(), 0, 1e-9);
}
