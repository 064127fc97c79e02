// SPDX-License-Identifier: BSD-3-Clause
// Faces that heights would fold over: nodes slide along the surface, and keep their heights.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"

#include "distortion.hpp"
#include "parallel.hpp"
#include "support/blocks.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "unfolding.hpp"

using namespace roughmesh;
using detail::Distortion;

namespace {

using Planar = Distortion<2>;
using InSpace = Distortion<2, 3>;

const std::vector<Planar::Corners> two_triangles = {{0, 1, 2}, {1, 3, 2}};

std::vector<Vec3> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i)
    points.emplace_back(uniform(random), uniform(random), uniform(random));
  return points;
}

std::vector<Eigen::Matrix2d> rest_shapes() {
  Eigen::Matrix2d a, b;
  a << 1, 0.2, 0, 0.8;
  b << -0.3, 0.7, 0.9, 0.1;
  return {a, b};
}

// Each triangle seen along an axis of its own.
InSpace in_space(const std::vector<Vec3>& points) {
  std::vector<InSpace::Frame> frames;
  for (const Vec3& axis : random_points(2, 7)) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, axis.normalized()).toRotationMatrix();
    frames.emplace_back(turn.topRows<2>());
  }
  return {rest_shapes(), two_triangles, points, static_cast<Index>(points.size()), frames};
}

constexpr double pi = std::numbers::pi;
constexpr int ny = 16;
constexpr double width = ny / 40.0;

/// z = sqrt(x^2 + radius^2), whose curvature at x = 0 is 1 / radius.
Mesh valley(double radius) {
  constexpr int nx = 60;
  std::vector<Vec3> nodes;
  std::vector<Index> faces;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      const double x = (i - nx / 2) / 40.0;
      nodes.emplace_back(x, j / 40.0, std::hypot(x, radius));
    }
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const Index p = i * (ny + 1) + j, q = p + ny + 1;
      faces.insert(faces.end(), {p, q, q + 1, p, q + 1, p + 1});
    }
  return test::surface_mesh(nodes, faces);
}

struct Lifted {
  Mesh mesh = valley(0.05);
  Surface surface = select_surface(mesh, {.sharp_angle = 1.5});
  std::vector<double> heights;

  explicit Lifted(double height) : heights(surface.points.size(), 0) {
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const double share = surface.points[i].y() / width;  // the ends of the valley stay
      heights[i] = height * (4 * share * (1 - share) + 0.05 * std::sin(10 * pi * share));
    }
  }

  MovedSurface move(EdgeRule rule) const {
    const EdgeOptions options{.rule = rule, .sharp_angle = 1.5};
    return SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1});
  }
  SurfaceCheck check(const MovedSurface& moved) const {
    std::vector<Vec3> nodes = mesh.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      nodes[surface.nodes[i]] += moved.displacements[i];
    return check_surface(mesh, test::only(surface), nodes);
  }
};

}  // namespace

// What is across the axes of a triangle does not count, and in one plane nothing else is new.
TEST(Unfolding, DistortionInSpaceIsThatOfTheProjection) {
  const std::vector<Vec3> points = random_points(4, 1);
  std::vector<Planar::Point> seen;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).matrix();
  for (const Vec3& x : points) seen.emplace_back(turn.topRows<2>() * x);
  InSpace space(rest_shapes(), two_triangles, points, 4, {2, InSpace::Frame(turn.topRows<2>())});
  Planar plane(rest_shapes(), two_triangles, seen, 4);
  Eigen::VectorXd by_points, by_seen;
  const double value = plane(plane.free_points(), by_seen);
  EXPECT_NEAR(space(space.free_points(), by_points), value, 1e-14 * std::abs(value));
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_LT(
        (by_points.segment<3>(3 * i) - turn.topRows<2>().transpose() * by_seen.segment<2>(2 * i))
            .norm(),
        1e-14 * by_seen.norm());
}

// Central differences: as for the other dimensions in test_foldover_free.cpp.
TEST(Unfolding, GradientInSpaceIsThatOfTheValue) {
  InSpace distortion = in_space(random_points(4, 2));
  distortion.set_epsilon(0.3);
  Eigen::VectorXd x = distortion.free_points(), gradient, unused;
  distortion(x, gradient);
  constexpr double step = 1e-5;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    Eigen::VectorXd up = x, down = x;
    up[k] += step;
    down[k] -= step;
    const double difference = (distortion(up, unused) - distortion(down, unused)) / (2 * step);
    EXPECT_NEAR(gradient[k], difference, 1e-6 * (1 + gradient.norm())) << k;
  }
}

// Heights above twice the radius of curvature fold the valley along its normals; nodes that slide
// keep the height over their tangent plane, and the border keeps its displacement.
TEST(Unfolding, NodesSlideAlongTheSurfaceUntilNoFaceIsFolded) {
  const Lifted valley(0.12);
  const MovedSurface along_normals = valley.move(EdgeRule::average);
  EXPECT_GT(valley.check(along_normals).folded_faces, 30);
  EXPECT_EQ(along_normals.n_slid, 0);

  const MovedSurface moved = valley.move(EdgeRule::offset);
  const SurfaceCheck check = valley.check(moved);
  EXPECT_TRUE(check.valid()) << check.folded_faces << " folded, " << check.self_intersections;
  Index n_slid = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < moved.displacements.size(); ++i) {
    const Index point = valley.surface.point_of_node[i];
    const Vec3& u = moved.displacements[i];
    const double slide = (u - along_normals.displacements[i]).norm();
    EXPECT_NEAR(valley.surface.normals[point].dot(u), valley.heights[point], 1e-14);
    n_slid += slide > 0 ? 1 : 0;
    farthest = std::max(farthest, slide);
  }
  EXPECT_EQ(moved.n_slid, n_slid);
  EXPECT_EQ(moved.farthest_slide, farthest);
  for (const auto& edge : valley.surface.border_edges)
    for (const Index point : edge)
      EXPECT_EQ(moved.displacements[point], along_normals.displacements[point]);
}

TEST(Unfolding, WhereNothingFoldsNothingSlides) {
  const Lifted valley(0.02);
  const MovedSurface moved = valley.move(EdgeRule::offset);
  EXPECT_EQ(moved.n_slid, 0);
  EXPECT_EQ(moved.displacements, displace(valley.surface, valley.heights));
}

TEST(Unfolding, IsTheSameOnAnyNumberOfThreads) {
  const Lifted valley(0.12);
  std::vector<MovedSurface> moved;
  for (const int n_threads : {1, 3}) {
    const detail::ThreadLimit limit(n_threads);
    moved.push_back(valley.move(EdgeRule::offset));
  }
  EXPECT_EQ(moved[0].displacements, moved[1].displacements);
}

// A crest of an L-block under waves that are shorter than its heights: every face at an edge keeps
// its height where vertices slide along the edge.
TEST(Unfolding, EdgesSlideAlongThemselves) {
  const Surface surface = select_surface(test::l_block(8), {.groups = {"all"}});
  std::vector<double> heights;
  for (const Vec3& x : surface.points)
    heights.push_back(0.16 * std::sin(16 * x.x() + 14 * x.y() - 15 * x.z() + 1));
  const auto move = [&](EdgeRule rule) {
    const EdgeOptions options{.rule = rule};
    return SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1});
  };
  const MovedSurface moved = move(EdgeRule::offset);
  ASSERT_GT(moved.n_slid, 0);
  const std::vector<Vec3> planes = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    const Vec3 normal =
        area_vector(std::vector<Vec3>{surface.points[face[0]], surface.points[face[1]],
                                      surface.points[face[2]]})
            .normalized();
    for (const Index point : face) {
      const auto node =
          std::find(surface.point_of_node.begin(), surface.point_of_node.end(), point) -
          surface.point_of_node.begin();
      EXPECT_NEAR(normal.dot(moved.displacements[static_cast<std::size_t>(node)]), heights[point],
                  1e-12);
    }
  }
}

// Nothing can help heights of many times the mesh: the search ends, and the check tells.
TEST(Unfolding, EndsWhereThereIsNoWay) {
  const Lifted valley(40);
  const MovedSurface moved = valley.move(EdgeRule::offset);
  for (const Vec3& u : moved.displacements) EXPECT_TRUE(u.allFinite());
}

// An inner wall across the valley, in whose plane all normals lie: its nodes slide along it.
TEST(Unfolding, NodesOnAWallSlideInItsPlane) {
  const Lifted valley(0.12);
  NodeConstraints constraints;
  std::vector<Index> on_wall, anchored;
  for (const Index node : valley.surface.nodes) {
    const double y = valley.mesh.nodes[node].y();
    if (std::abs(y - width / 2) < 1e-9) on_wall.push_back(node);
    if (std::abs(y - width / 4) < 1e-9) anchored.push_back(node);
  }
  for (const Index node : on_wall) constraints.sliding.push_back({node, Vec3::UnitY()});
  constraints.anchored = anchored;
  const EdgeOptions options{.sharp_angle = 1.5};
  const MovedSurface moved = SurfaceMover(test::only(valley.surface), {&options, 1}, constraints)
                                 .move({&valley.heights, 1});
  const MovedSurface along_normals = valley.move(EdgeRule::average);
  const auto place = [&](Index node) {
    return static_cast<std::size_t>(
        std::lower_bound(valley.surface.nodes.begin(), valley.surface.nodes.end(), node) -
        valley.surface.nodes.begin());
  };
  EXPECT_GT(moved.n_slid, 0);
  double farthest = 0;
  for (const Index node : on_wall) {
    const std::size_t i = place(node);
    EXPECT_NEAR(moved.displacements[i].y(), along_normals.displacements[i].y(), 1e-15);
    farthest = std::max(farthest, (moved.displacements[i] - along_normals.displacements[i]).norm());
  }
  EXPECT_GT(farthest, 1e-3);
  for (const Index node : anchored)
    EXPECT_EQ(moved.displacements[place(node)], along_normals.displacements[place(node)]);
}

// What a mask holds at an edge stays where it is, whatever the faces beside it do.
TEST(Unfolding, MaskedPointsOfAnEdgeStayInTheirFace) {
  const Mesh mesh = test::l_block(8);
  const Surface surface = select_surface(mesh, {.groups = {"all"}});
  EdgeOptions options;
  std::vector<double> heights;
  for (const Vec3& x : surface.points) {
    options.weights.push_back(x.z() < 0.5 ? 1 : 0);
    heights.push_back(options.weights.back() * 0.16 *
                      std::sin(16 * x.x() + 14 * x.y() - 15 * x.z() + 1));
  }
  const MovedSurface moved = SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1});
  ASSERT_GT(moved.n_slid, 0);
  for (std::size_t i = 0; i < moved.displacements.size(); ++i) {
    if (options.weights[surface.point_of_node[i]] > 0) continue;
    EXPECT_EQ(moved.displacements[i], Vec3::Zero());
  }
}

TEST(Unfolding, WhatDoesNotHelpIsNotKept) {
  const Lifted valley(40);
  const std::int64_t before = valley.check(valley.move(EdgeRule::average)).folded_faces;
  const MovedSurface moved = valley.move(EdgeRule::offset);
  EXPECT_TRUE(moved.n_slid == 0 || valley.check(moved).folded_faces < before);
}

TEST(Unfolding, ConstraintsOfOtherNodesAreRefused) {
  const Lifted valley(0.01);
  const EdgeOptions options;
  const Index none = valley.mesh.n_nodes();
  for (const NodeConstraints& constraints :
       {NodeConstraints{.fixed = {none}}, NodeConstraints{.sliding = {{none, Vec3::UnitX()}}},
        NodeConstraints{.anchored = {none}}})
    EXPECT_THROW(SurfaceMover(test::only(valley.surface), {&options, 1}, constraints), InputError);
}
