// SPDX-License-Identifier: BSD-3-Clause
// How curved elements follow a rough surface, and what is done where they would be inverted.
#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/move_volume.hpp"

#include "curved_quality.hpp"
#include "p2_harmonic.hpp"
#include "support/curved.hpp"
#include "support/files.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"

using namespace roughmesh;

namespace {

std::vector<detail::ElementOfMesh> cells_of(const Mesh& mesh) {
  std::vector<detail::ElementOfMesh> cells;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (Index e = 0;
         dimension(mesh.blocks[b].type.shape) == dimension(mesh) && e < mesh.blocks[b].size(); ++e)
      cells.push_back({static_cast<Index>(b), e});
  return cells;
}

std::vector<std::uint8_t> corners(const Mesh& mesh) {
  std::vector<std::uint8_t> is_corner(mesh.nodes.size(), 0);
  for (const detail::ElementOfMesh& cell : cells_of(mesh))
    for (int k = 0; k < n_corners(cell.type(mesh).shape); ++k) is_corner[cell.nodes(mesh)[k]] = 1;
  return is_corner;
}

/// Nodes that are no corners: given below y = 1/2, else unknown.
detail::NodeRoles half_given(const Mesh& mesh) {
  const auto is_corner = corners(mesh);
  detail::NodeRoles roles;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const bool is_given = mesh.nodes[i].y() < 0.4;
    roles.given.push_back(!is_corner[i] && is_given ? roles.n_given++ : -1);
    roles.unknown.push_back(!is_corner[i] && !is_given ? roles.n_unknown++ : -1);
  }
  return roles;
}

/// Points and weights of Gauss' rule with four points on each axis, brought to the reference
/// element by collapsing sides: exact beyond the degree of any integrand here.
std::vector<std::pair<Vec3, double>> quadrature(ElementShape shape) {
  constexpr std::array<double, 4> at = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                        0.9305681557970263};
  constexpr std::array<double, 4> of = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                        0.1739274225687269};
  std::vector<std::pair<Vec3, double>> points;
  const bool is_volume = dimension(shape) == 3;
  const bool has_triangles = shape != ElementShape::quadrangle && shape != ElementShape::hexahedron;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < (is_volume ? 4 : 1); ++k) {
        Vec3 x(at[i], at[j], is_volume ? at[k] : 0);
        double weight = of[i] * of[j] * (is_volume ? of[k] : 1);
        if (shape == ElementShape::tetrahedron) {
          weight *= (1 - x[0]) * (1 - x[0]) * (1 - x[1]);
          x = Vec3(x[0], (1 - x[0]) * x[1], (1 - x[0]) * (1 - x[1]) * x[2]);
        } else if (has_triangles) {
          weight *= 1 - x[0];
          x[1] *= 1 - x[0];
        }
        points.emplace_back(x, weight);
      }
  return points;
}

/// sum 1/V integral |grad w|^2 over affine elements, from textbook shape functions.
double energy(const Mesh& mesh, const std::vector<Vec3>& w) {
  double total = 0;
  for (const detail::ElementOfMesh& cell : cells_of(mesh)) {
    const ElementType type = cell.type(mesh);
    const auto nodes = cell.nodes(mesh);
    const std::vector<Vec3> reference = test::reference_nodes(type);
    double integral = 0, volume = 0;
    for (const auto& [x, weight] : quadrature(type.shape)) {
      Eigen::Matrix3d map = Eigen::Matrix3d::Identity(), slope = Eigen::Matrix3d::Zero();
      for (int axis = 0; axis < dimension(type.shape); ++axis) {
        map.col(axis).setZero();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          const double d =
              2 * (test::shape_function(type, reference[i], x + 0.25 * Vec3::Unit(axis)) -
                   test::shape_function(type, reference[i], x - 0.25 * Vec3::Unit(axis)));
          map.col(axis) += d * mesh.nodes[nodes[i]];
          slope.col(axis) += d * w[nodes[i]];
        }
      }
      const double measure = weight * std::abs(map.determinant());
      integral += measure * (slope * map.inverse()).squaredNorm();
      volume += measure;
    }
    total += integral / volume;
  }
  return total;
}

/// Layers of a box of different heights, so that its elements are affine, but not equal.
Mesh graded_box(ElementShape shape, int divisions) {
  Mesh mesh = test::cell_box(shape, divisions);
  for (Vec3& x : mesh.nodes) x.z() *= (1 + x.z()) / 2;
  return mesh;
}

std::vector<Mesh> affine_meshes() {
  std::vector<Mesh> meshes;
  for (const bool complete : {false, true}) {
    for (const ElementShape shape :
         {ElementShape::tetrahedron, ElementShape::hexahedron, ElementShape::prism})
      meshes.push_back(test::second_order(graded_box(shape, 2), complete));
    meshes.push_back(test::second_order(test::strip(6, 4, 3, 0.5), complete));
  }
  Eigen::Affine3d skew = Eigen::Affine3d::Identity();
  skew.linear() << 1, 0.3, 0, 0.1, 0.8, 0, 0, 0, 1.2;
  for (Mesh& mesh : meshes) mesh = test::transformed(std::move(mesh), skew);
  return meshes;
}

double least_curved(const Mesh& mesh, const std::vector<Vec3>& nodes) {
  double least = 1;
  for (const detail::ElementOfMesh& cell : cells_of(mesh))
    if (const auto quality = detail::curved_quality(cell.type(mesh), cell.nodes(mesh), nodes, {}))
      least = std::min(least, quality->value);
  return least;
}

/// Heights on a group of nodes in the middle of edges only, by a wave far shorter than the mesh can
/// carry.
std::vector<Vec3> bulges(const Mesh& mesh, const Surface& surface, double size) {
  const auto is_corner = corners(mesh);
  std::vector<Vec3> told;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
    const Vec3& x = mesh.nodes[surface.nodes[i]];
    const double height =
        is_corner[surface.nodes[i]] ? 0 : size * std::sin(37 * x.x() + 23 * x.y());
    told.push_back(height * surface.normals[surface.point_of_node[i]]);
  }
  return told;
}

}  // namespace

TEST(QuadraticExtension, TheStiffnessIsSymmetricAndPositiveDefinite) {
  for (const Mesh& mesh : affine_meshes()) {
    const detail::QuadraticExtension extension(mesh, cells_of(mesh), half_given(mesh));
    const Eigen::MatrixXd stiffness = extension.stiffness();
    EXPECT_LE((stiffness - stiffness.transpose()).cwiseAbs().maxCoeff(),
              1e-14 * stiffness.cwiseAbs().maxCoeff());
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(stiffness).info(), Eigen::Success);
  }
}

// Nodes that move alike, also those of one element: with C their sums, the stiffness is C^T K C.
TEST(QuadraticExtension, NodesThatMoveAlikeAreOneUnknown) {
  for (const Mesh& mesh : affine_meshes()) {
    detail::NodeRoles roles = half_given(mesh);
    const Eigen::MatrixXd apart =
        detail::QuadraticExtension(mesh, cells_of(mesh), roles).stiffness();
    const Index n = (roles.n_unknown + 1) / 2;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(apart.cols(), n);
    for (Index i = 0; i < roles.n_unknown; ++i) sums(i, i / 2) = 1;
    for (Index& unknown : roles.unknown) unknown = unknown < 0 ? -1 : unknown / 2;
    roles.n_unknown = n;
    const Eigen::MatrixXd alike =
        detail::QuadraticExtension(mesh, cells_of(mesh), roles).stiffness();
    const Eigen::MatrixXd expected = sums.transpose() * apart * sums;
    EXPECT_LE((alike - expected).cwiseAbs().maxCoeff(), 1e-14 * apart.cwiseAbs().maxCoeff());
  }
}

// E(w + v) = E(w) + E(v) for every v that is zero where w is given or at a corner.
TEST(QuadraticExtension, TheOffsetMinimizesTheWeightedEnergy) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  for (const Mesh& mesh : affine_meshes()) {
    const detail::NodeRoles roles = half_given(mesh);
    std::vector<Vec3> given(static_cast<std::size_t>(roles.n_given));
    for (Vec3& each : given) each = any();
    const auto found = detail::QuadraticExtension(mesh, cells_of(mesh), roles).extend(given);
    std::vector<Vec3> w(mesh.nodes.size(), Vec3::Zero()), v = w, sum = w;
    for (std::size_t i = 0; i < w.size(); ++i) {
      if (roles.given[i] >= 0) w[i] = given[roles.given[i]];
      if (roles.unknown[i] >= 0) w[i] = found[roles.unknown[i]], v[i] = any();
      sum[i] = w[i] + v[i];
    }
    const double ew = energy(mesh, w), ev = energy(mesh, v);
    EXPECT_GT(ew, 1);
    // Coefficients of the quadrature have 16 digits, the solution 12.
    EXPECT_NEAR(energy(mesh, sum), ew + ev, 1e-10 * (ew + ev)) << name(mesh.blocks.back().type);
  }
}

// What the mover adds to straight edges is that minimum: no other offset of nodes that may move has
// less energy.
TEST(CurvedElements, OffsetsMinimizeTheWeightedEnergy) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron}) {
    const Mesh mesh = test::second_order(graded_box(shape, 4), true);
    const Surface surface = select_surface(mesh, {.groups = {"middle"}});
    const std::vector<Vec3> moved = VolumeMover(mesh, test::only(surface), VolumeMethod::harmonic)
                                        .move(bulges(mesh, surface, 0.05))
                                        .nodes;
    const auto is_corner = corners(mesh);
    std::vector<Vec3> w(mesh.nodes.size(), Vec3::Zero()), v = w, sum = w;
    for (std::size_t i = 0; i < w.size(); ++i) {
      const Vec3& x = mesh.nodes[i];
      w[i] = moved[i] - x;  // corners stay, so that all of it is offset
      const bool is_free = !is_corner[i] && x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9 &&
                           !std::binary_search(surface.nodes.begin(), surface.nodes.end(), i);
      if (is_free) v[i] = Vec3(uniform(random), uniform(random), uniform(random));
      sum[i] = w[i] + v[i];
      if (is_corner[i]) {
        EXPECT_EQ(w[i], Vec3::Zero());
      }
    }
    const double ew = energy(mesh, w), ev = energy(mesh, v);
    EXPECT_GT(ew, 0.01);
    EXPECT_NEAR(energy(mesh, sum), ew + ev, 1e-10 * (ew + ev));
  }
}

// The better, the larger the roughness; where elements would be inverted, they are not; corners,
// walls and nodes of the surface are where they would be without.
TEST(CurvedElements, FollowBulgesOfEveryShape) {
  int n_inverted = 0;
  for (const Mesh& mesh : {test::second_order(test::cell_box(ElementShape::tetrahedron, 4), false),
                           test::second_order(test::cell_box(ElementShape::hexahedron, 4), false),
                           test::second_order(test::cell_box(ElementShape::hexahedron, 4), true),
                           test::second_order(test::cell_box(ElementShape::prism, 4), true),
                           test::second_order(test::ring(32, false), false),
                           test::second_order(test::ring(32, true), false),
                           test::second_order(test::ring(32, true), true)}) {
    const bool is_planar = dimension(mesh) == 2;
    Surface surface = select_surface(mesh, {.groups = {is_planar ? "interface" : "middle"}});
    const double h = is_planar ? 0.09 : 0.25;
    std::vector<Vec3> told = bulges(mesh, surface, 0.35 * h);
    for (std::size_t i = 0; i < told.size(); ++i) {  // the rim stays
      const Vec3& x = mesh.nodes[surface.nodes[i]];
      if (!is_planar && (x.head<2>().minCoeff() < 1e-9 || x.head<2>().maxCoeff() > 1 - 1e-9))
        told[i].setZero();
    }
    const auto surfaces = test::only(surface);
    const std::vector<Vec3> spread =
        VolumeMover(mesh, surfaces, VolumeMethod::harmonic).move(told).nodes;
    const std::vector<Vec3> mended = VolumeMover(mesh, surfaces).move(told).nodes;
    EXPECT_TRUE(check_mesh(mesh, mended).valid());
    EXPECT_GE(least_curved(mesh, mended), least_curved(mesh, spread))
        << name(mesh.blocks.back().type);
    EXPECT_GE(least_curved(mesh, mended), 0.02) << name(mesh.blocks.back().type);
    n_inverted += least_curved(mesh, spread) <= 0;
    const auto is_corner = corners(mesh);
    for (std::size_t i = 0; i < surface.nodes.size(); ++i)
      EXPECT_EQ(mended[surface.nodes[i]], mesh.nodes[surface.nodes[i]] + told[i]);
    for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
      const Vec3& x = mesh.nodes[node];
      const bool is_wall = !is_planar && (x.minCoeff() < 1e-9 || x.maxCoeff() > 1 - 1e-9);
      if (is_corner[node] || is_wall) {
        EXPECT_EQ(mended[node], spread[node]);
      }
      if (is_planar) {
        EXPECT_EQ(mended[node].z(), 0);
      }
    }
  }
  EXPECT_GE(n_inverted, 3);
}

// A node of the surface told to fold its own edge: no other node can help. It stays where it was
// told to be, and the check says so.
TEST(CurvedElements, WhatTheSurfaceItselfInvertsIsFound) {
  const Mesh mesh = test::second_order(test::cell_box(ElementShape::tetrahedron, 4), false);
  const Surface surface = select_surface(mesh, {.groups = {"middle"}});
  std::vector<Vec3> told(surface.nodes.size(), Vec3::Zero());
  const auto at = std::find_if(surface.nodes.begin(), surface.nodes.end(), [&](Index node) {
    return (mesh.nodes[node] - Vec3(0.375, 0.5, 0.5)).norm() < 1e-12;
  });
  ASSERT_NE(at, surface.nodes.end());
  told[static_cast<std::size_t>(at - surface.nodes.begin())] = 0.09 * Vec3::UnitX();  // of h = 0.25
  const std::vector<Vec3> moved = VolumeMover(mesh, test::only(surface)).move(told).nodes;
  EXPECT_EQ(moved[*at], mesh.nodes[*at] + 0.09 * Vec3::UnitX());
  const MeshCheck check = check_mesh(mesh, moved);
  EXPECT_GT(check.inverted_elements, 0);
  EXPECT_LT(check.min_quality, 0);
}

// The rough sphere of the benchmark. The bars are those of a prototype with the harmonic extension
// alone; Gmsh's elastic analogy reached 0.86, 0.64, 0.27.
TEST(CurvedElements, OfARoughSphereInABoxAreValid) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  ASSERT_EQ(test::run("cd " + folder.path().string() +
                      " && timeout 100 gmsh -3 -order 2 -o a.msh " ROUGHMESH_SOURCE_DIR
                      "/benchmarks/sphere_in_box.geo > log 2>&1"),
            0);
  const Mesh mesh = read_mesh((folder / "a.msh").string());
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const auto surfaces = test::only(surface);
  const double h = 2 * surface.mesh_size.median;  // that of the surface is between all its nodes
  const FieldSampler sampler(
      Correlation(surface.points, Autocorrelation({.family = Family::gaussian, .length = 1.77 * h}),
                  Distance::euclidean()),
      {});
  const VolumeMover mover(mesh, surfaces);
  for (const auto& [ratio, bar] : {std::pair{0.1, 0.84}, {0.3, 0.58}, {0.5, 0.24}}) {
    std::vector<double> heights = sampler.heights(0, 0);
    for (double& z : heights) z *= ratio * h;
    const std::vector<Vec3> moved = mover.move(displace_nodes(surfaces, {&heights, 1})).nodes;
    EXPECT_TRUE(check_mesh(mesh, moved).valid()) << ratio;
    EXPECT_GE(least_curved(mesh, moved), bar) << ratio;
  }
}
