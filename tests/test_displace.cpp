// SPDX-License-Identifier: BSD-3-Clause
// Heights along the normals, and where several surfaces meet.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"

#include "support/cells.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "support/second_order.hpp"

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

namespace {

/// Two plates of 4 by 4 squares that share the edge x = 1, z = 0; the second one rises by `angle`.
Mesh hinge(double angle) {
  Mesh mesh = test::plate(4);
  const Mesh other = test::plate(4);
  std::vector<Index> place;
  for (const Vec3& x : other.nodes) {
    if (x.x() == 0) {
      place.push_back(static_cast<Index>(5 * std::lround(4 * x.y()) + 4));
      continue;
    }
    place.push_back(mesh.n_nodes());
    mesh.nodes.emplace_back(1 + x.x() * std::cos(angle), x.y(), x.x() * std::sin(angle));
  }
  std::vector<Index> faces;
  for (const Index node : other.blocks[0].nodes) faces.push_back(place[node]);
  mesh.blocks.push_back(test::make_block(test::triangle_type, 2, {2}, faces, 101));
  mesh.groups = {{2, 1, "flat"}, {2, 2, "risen"}};
  test::number_nodes(mesh);
  return mesh;
}

std::vector<Surface> both(const Mesh& mesh) {
  return {select_surface(mesh, {.groups = {"flat"}}), select_surface(mesh, {.groups = {"risen"}})};
}

// So small beside the faces (1/4) that none folds and nothing slides.
std::vector<std::vector<double>> some_heights(const std::vector<Surface>& surfaces) {
  std::vector<std::vector<double>> heights;
  for (const Surface& surface : surfaces) {
    heights.emplace_back();
    for (const Vec3& x : surface.points)
      heights.back().push_back(
          0.02 * std::sin(5 * x.x() + 9 * x.y() + 3.0 * static_cast<double>(heights.size())));
  }
  return heights;
}

double height_at(const Surface& surface, const std::vector<double>& heights, Index node) {
  const auto at = std::lower_bound(surface.nodes.begin(), surface.nodes.end(), node);
  return heights[surface.point_of_node[at - surface.nodes.begin()]];
}

bool has(const Surface& surface, Index node) {
  return std::binary_search(surface.nodes.begin(), surface.nodes.end(), node);
}

}  // namespace

// Two normals that are far from parallel leave room for both heights.
TEST(Displace, WhereSurfacesMeetEachHasItsHeight) {
  for (const double degrees : {45.0, 90.0, 135.0, -90.0}) {
    const std::vector<Surface> surfaces = both(hinge(degrees / 180 * std::numbers::pi));
    const std::vector<std::vector<double>> heights = some_heights(surfaces);
    const std::vector<Index> nodes = moved_nodes(surfaces);
    EXPECT_EQ(nodes.size(), 45u);
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    const std::vector<Vec3> u = displace_nodes(surfaces, heights);
    int n_common = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      n_common += has(surfaces[0], nodes[i]) && has(surfaces[1], nodes[i]);
      for (std::size_t s = 0; s < 2; ++s)
        if (has(surfaces[s], nodes[i])) {
          EXPECT_NEAR(u[i].dot(surfaces[s].normals[0]),
                      height_at(surfaces[s], heights[s], nodes[i]), 1e-14);
        }
      EXPECT_NEAR(u[i].y(), 0, 1e-15);  // the smallest has no component along the edge
    }
    EXPECT_EQ(n_common, 5);
  }
}

// Along an edge that is none, two independent heights cannot both be met: their mean is taken.
TEST(Displace, WhereSurfacesContinueEachOtherTheMeanIsTaken) {
  for (const double degrees : {0.0, 1.0, 20.0}) {
    const double angle = degrees / 180 * std::numbers::pi;
    const std::vector<Surface> surfaces = both(hinge(angle));
    const std::vector<std::vector<double>> heights = some_heights(surfaces);
    const std::vector<Index> nodes = moved_nodes(surfaces);
    const std::vector<Vec3> u = displace_nodes(surfaces, heights);
    const Vec3 middle = (surfaces[0].normals[0] + surfaces[1].normals[0]).normalized();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!has(surfaces[0], nodes[i]) || !has(surfaces[1], nodes[i])) continue;
      const double mean = (height_at(surfaces[0], heights[0], nodes[i]) +
                           height_at(surfaces[1], heights[1], nodes[i])) /
                          2;
      // Least squares with u = c (n_1 + n_2) / |..| only: c cos(angle / 2) is the mean.
      EXPECT_NEAR((u[i] - mean / std::cos(angle / 2) * middle).norm(), 0, 1e-14);
    }
  }
}

// Eq. 36: |u| is at most three times the largest height, however close to parallel or opposite.
TEST(Displace, WhereSurfacesMeetNothingExplodes) {
  for (int degrees = -175; degrees <= 175; degrees += 5) {
    const std::vector<Surface> surfaces = both(hinge(degrees / 180.0 * std::numbers::pi));
    std::vector<std::vector<double>> heights = {std::vector<double>(25, 0.02),
                                                std::vector<double>(25, -0.02)};
    for (const Vec3& u : displace_nodes(surfaces, heights)) EXPECT_LE(u.norm(), 0.06 + 1e-14);
  }
}

TEST(Displace, OneSurfaceIsTheSpecialCase) {
  const Mesh mesh = test::shuffled(hinge(1), 3);
  const std::vector<Surface> surfaces = {select_surface(mesh, {.groups = {"flat"}})};
  const std::vector<std::vector<double>> heights = some_heights(surfaces);
  const std::vector<Vec3> u = displace_nodes(surfaces, heights);
  EXPECT_EQ(moved_nodes(surfaces), surfaces[0].nodes);
  EXPECT_EQ(u, test::at_nodes(surfaces[0], displace(surfaces[0], heights[0])));
}

// Nodes of the two sides of a slit are one point of "flat"; "risen" begins at one of them. Both
// obey both.
TEST(Displace, NodesAtOnePointMoveTogether) {
  Mesh mesh = hinge(1.5);
  // Faces of "flat" at the edge get nodes of their own for it, but one face keeps the old ones.
  std::map<Index, Index> copies;
  auto& flat = mesh.blocks[0].nodes;
  for (std::size_t k = 3; k < flat.size(); ++k) {
    if (mesh.nodes[flat[k]].x() != 1 || k / 3 == 6) continue;
    const auto [at, is_new] = copies.try_emplace(flat[k], mesh.n_nodes());
    if (is_new) mesh.nodes.push_back(Vec3(mesh.nodes[flat[k]]));
    flat[k] = at->second;
  }
  test::number_nodes(mesh);
  const std::vector<Surface> surfaces = both(mesh);
  const std::vector<Index> nodes = moved_nodes(surfaces);
  const std::vector<Vec3> u = displace_nodes(surfaces, some_heights(surfaces));
  int n_pairs = 0;
  const auto place = [&](Index node) {
    return std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
  };
  for (const auto& [node, copy] : copies) {
    if (!has(surfaces[0], node) || !has(surfaces[0], copy) || !has(surfaces[1], node)) continue;
    ++n_pairs;
    EXPECT_EQ(u[place(node)], u[place(copy)]);
    EXPECT_NE(u[place(node)].x(), 0);
  }
  EXPECT_GT(n_pairs, 0);
}

TEST(Displace, AListOfHeightsPerSurfaceIsNeeded) {
  const std::vector<Surface> surfaces = both(hinge(1));
  std::vector<std::vector<double>> heights = some_heights(surfaces);
  heights[1].pop_back();
  EXPECT_THROW(displace_nodes(surfaces, heights), InputError);
  heights.pop_back();
  EXPECT_THROW(displace_nodes(surfaces, heights), InputError);
}

// Every node of a surface of order 2 and of a curve has a height of its own, with the covariance
// that was asked for between all of them. Isserlis, as in test_field.cpp: the sample covariance of
// n realizations has the standard error sqrt((1 + rho^2) / n); six of them.
TEST(Displace, NodesOfSecondOrderAndOfCurvesHaveTheCovariance) {
  Mesh sphere = test::second_order(test::icosphere(2), true);
  for (Vec3& x : sphere.nodes) x.normalize();
  Mesh circle = test::second_order(
      test::polyline(test::circle_points(test::uneven_angles(100), 1), true), true);
  for (Vec3& x : circle.nodes) x.normalize();
  const Autocorrelation rho({.family = Family::gaussian, .length = 0.4});
  for (const Mesh* const mesh : {&sphere, &circle}) {
    const std::vector<Surface> surfaces = {select_surface(*mesh)};
    ASSERT_EQ(surfaces[0].n_points(), mesh->n_nodes());
    const FieldSampler sampler(Correlation(surfaces[0].points, rho, Distance::euclidean()));
    constexpr int n_realizations = 4000;
    constexpr Index n = 200;
    const Index stride = mesh->n_nodes() / n;  // corners and others
    Eigen::MatrixXd heights(n, n_realizations);
    constexpr double rms = 0x1p-8;  // so small that no face folds
    for (int k = 0; k < n_realizations; ++k) {
      std::vector<double> z = sampler.heights(1, static_cast<unsigned>(k));
      for (double& each : z) each *= rms;
      const std::vector<Vec3> u = displace_nodes(surfaces, {&z, 1});
      for (Index i = 0; i < n; ++i)
        heights(i, k) = u[i * stride].dot(mesh->nodes[i * stride]) / rms;
    }
    const Eigen::MatrixXd covariance = heights * heights.transpose() / n_realizations;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j <= i; ++j) {
        const double expected = rho.rho((mesh->nodes[i * stride] - mesh->nodes[j * stride]).norm());
        ASSERT_NEAR(covariance(i, j), expected,
                    6 * std::sqrt((1 + expected * expected) / n_realizations));
      }
  }
}
