// SPDX-License-Identifier: BSD-3-Clause
// Nodes that slide, or move alike, through fewer numbers than they have coordinates.
#include <random>

#include <gtest/gtest.h>

#include "repair_volume.hpp"
#include "support/cells.hpp"
#include "tied_nodes.hpp"

using namespace roughmesh;
using detail::NodeTies;
using detail::TiedPoints;

namespace {

// Nodes 0 and 3 are images that slide in an oblique plane, 1 slides along a line, 2 is free, 4
// stays.
NodeTies ties() {
  const Vec3 m = Vec3(1, 2, -0.5).normalized(), other = Vec3(1, 0, 2).normalized();
  return {{{0, m},
           {1, m},
           {1, other},
           {3, m},
           {4, Vec3::UnitX()},
           {4, Vec3::UnitY()},
           {4, Vec3::UnitZ()}},
          {0, 1, 2, 0, 4}};
}

Eigen::VectorXd random_vector(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

const std::vector<Index> all = {0, 1, 2, 3, 4};

}  // namespace

// Planes: 2 directions in common for nodes 0 and 3, 1 for node 1, 3 for node 2, none for node 4.
TEST(TiedNodes, ShiftsKeepPlanesAndImages) {
  const TiedPoints<3> tied(ties(), all, Eigen::Matrix3d::Identity(), random_vector(15, 1));
  ASSERT_EQ(tied.start().size(), 6);
  EXPECT_TRUE(tied.shifts(tied.start()).isZero(0));
  const Eigen::VectorXd shifts = tied.shifts(random_vector(6, 2));
  for (const SlidingNode& each : ties().sliding)
    EXPECT_NEAR(shifts.segment<3>(3 * Eigen::Index{each.node}).dot(each.normal), 0, 1e-15);
  EXPECT_EQ(shifts.segment<3>(0), shifts.segment<3>(9));
  EXPECT_GT(shifts.segment<3>(3).norm(), 0.01);
  EXPECT_GT(shifts.segment<3>(6).norm(), 0.01);
}

// Shifts are linear, x = B (q - q_0), and derivatives by q are B^T times those by x: g . B (q -
// q_0) = B^T g . (q - q_0). Each side sums 15 products of numbers below 4.
TEST(TiedNodes, DerivativesAreThoseOfTheChainRule) {
  const TiedPoints<3> tied(ties(), all, Eigen::Matrix3d::Identity(), random_vector(15, 1));
  for (unsigned seed = 3; seed < 10; ++seed) {
    const Eigen::VectorXd gradient = random_vector(15, seed), q = random_vector(6, 10 * seed);
    EXPECT_NEAR(gradient.dot(tied.shifts(q)), tied.reduced(gradient).dot(q - tied.start()), 1e-13);
  }
}

TEST(TiedNodes, LinesOfAPlaneLeaveOneDirection) {
  const Eigen::Matrix<double, 2, 3> axes = Eigen::Matrix<double, 2, 3>::Identity();
  const NodeTies in_plane{{{0, Vec3(0.6, 0.8, 0)}}, {}};
  const std::vector<Index> one = {0};
  const TiedPoints<2> tied(in_plane, one, axes, Eigen::Vector2d(1, 1));
  ASSERT_EQ(tied.start().size(), 1);
  const Eigen::VectorXd shift = tied.shifts(Eigen::VectorXd::Constant(1, 5.0));
  EXPECT_NEAR(0.6 * shift[0] + 0.8 * shift[1], 0, 1e-15);
  EXPECT_GT(shift.norm(), 1);
}

// A node beside the side x = 1 of a cell is pushed along it, and nodes of both sides may
// slide: what mends one moves the other alike.
TEST(TiedNodes, RepairMovesImagesAlike) {
  const int n = 6;
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, n);
  std::vector<Vec3> positions = mesh.nodes;
  detail::NodeFlags is_free(mesh.nodes.size(), 0);
  NodeTies sides;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3& x = mesh.nodes[node];
    const bool on_other = std::min(x.y(), x.z()) == 0 || std::max(x.y(), x.z()) == 1;
    is_free[node] = !on_other;
    sides.images.push_back(x.x() == 1 ? node - n : node);
    if (!on_other && (x.x() == 0 || x.x() == 1)) sides.sliding.push_back({node, Vec3::UnitX()});
    if ((x - Vec3(5, 3, 3) / n).norm() < 1e-9) {
      positions[node] += Vec3(0.14, 0.2, 0.1);
      is_free[node] = 0;
    }
  }
  EXPECT_FALSE(check_mesh(mesh, positions).valid());
  const MovedVolume mended = detail::VolumeRepair(mesh, is_free, 0, sides).mend(positions);
  EXPECT_TRUE(check_mesh(mesh, mended.nodes).valid());
  int n_moved = 0;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Index image = sides.images[node];
    const Vec3 shift = mended.nodes[node] - mesh.nodes[node];
    EXPECT_NEAR((shift - (mended.nodes[image] - mesh.nodes[image])).norm(), 0, 1e-15);
    if (mesh.nodes[node].x() == 1) {
      EXPECT_EQ(shift.x(), 0);
    }
    n_moved += image != node && shift.norm() > 1e-6;
  }
  EXPECT_GT(n_moved, 4);
}
