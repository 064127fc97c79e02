// SPDX-License-Identifier: BSD-3-Clause
// The foldover-free map: its energy, and that it turns inverted elements back.
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"

#include "distortion.hpp"
#include "foldover_free.hpp"
#include "parallel.hpp"
#include "support/cells.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"

using namespace roughmesh;
using detail::Distortion;
using detail::NodeFlags;

namespace {

constexpr std::array volume_shapes = {ElementShape::tetrahedron, ElementShape::hexahedron,
                                      ElementShape::prism, ElementShape::pyramid};

// Two simplices with a common face, the ideal one and its mirror image.
template <int dim>
std::vector<typename Distortion<dim>::Point> two_simplices() {
  std::vector<typename Distortion<dim>::Point> points;
  for (const Vec3& x :
       test::ideal_corners(dim == 2 ? ElementShape::triangle : ElementShape::tetrahedron))
    points.push_back(x.head<dim>());
  typename Distortion<dim>::Point last = points[0] + points[1];
  last[dim - 1] = -0.9;
  points.push_back(last);
  return points;
}

template <int dim>
std::vector<typename Distortion<dim>::Corners> two_corners() {
  if constexpr (dim == 2)
    return {{0, 1, 2}, {1, 0, 3}};
  else
    return {{0, 1, 2, 3}, {1, 0, 2, 4}};
}

template <int dim>
Distortion<dim> two_distorted(double scale = 1) {
  auto points = two_simplices<dim>();
  for (auto& x : points) x *= scale;
  std::vector<typename Distortion<dim>::Matrix> rest;
  for (const auto& corners : two_corners<dim>()) {
    auto& shape = rest.emplace_back();
    for (int k = 0; k < dim; ++k) shape.col(k) = points[corners[k + 1]] - points[corners[0]];
  }
  return {rest, two_corners<dim>(), points, static_cast<Index>(points.size())};
}

Eigen::VectorXd disturbed(Eigen::VectorXd x, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  for (double& value : x) value += uniform(random);
  return x;
}

// Central differences with step s err by s^2/6 of the third derivative and by round-off of 1e-16 /
// s; epsilon = 0.3 keeps derivatives of order 1e4.
template <int dim>
void expect_gradient() {
  auto distortion = two_distorted<dim>();
  distortion.set_epsilon(0.3);
  bool some_inverted = false;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Eigen::VectorXd x = disturbed(distortion.free_points(), 0.6, seed), gradient, unused;
    some_inverted = some_inverted || distortion.determinants(x).smallest < 0;
    distortion(x, gradient);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      constexpr double step = 1e-5;
      const double at = x[i];
      x[i] = at + step;
      const double after = distortion(x, unused);
      x[i] = at - step;
      const double before = distortion(x, unused);
      x[i] = at;
      EXPECT_NEAR(gradient[i], (after - before) / (2 * step), 1e-5 * (1 + gradient.norm()));
    }
  }
  EXPECT_TRUE(some_inverted);
}

template <int dim>
void expect_invariance() {
  using Matrix = typename Distortion<dim>::Matrix;
  auto distortion = two_distorted<dim>(), large = two_distorted<dim>(3);
  const Eigen::VectorXd x = disturbed(distortion.free_points(), 0.3, 1);
  Eigen::VectorXd turned = x, gradient, turned_gradient;
  Matrix rotation = Matrix::Identity();
  rotation.template topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  if constexpr (dim == 3) rotation = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()) * rotation;
  for (Eigen::Index i = 0; i < x.size(); i += dim)
    turned.segment<dim>(i) = rotation * x.segment<dim>(i) + Distortion<dim>::Point::Constant(0.5);
  const double value = distortion(x, gradient);
  EXPECT_NEAR(distortion(turned, turned_gradient), value, 1e-13 * std::abs(value));
  EXPECT_NEAR(turned_gradient.norm(), gradient.norm(), 1e-12 * gradient.norm());
  EXPECT_NEAR(large(3 * x, gradient), 3 * value, 1e-13 * std::abs(value));  // h is a length
}

template <int dim>
void expect_least_at_rest() {
  auto distortion = two_distorted<dim>();
  distortion.set_epsilon(0);
  const Eigen::VectorXd rest = distortion.free_points();
  Eigen::VectorXd gradient;
  EXPECT_NEAR(distortion(rest, gradient), 0, 1e-14);
  EXPECT_NEAR(gradient.norm(), 0, 1e-14);
  for (unsigned seed = 0; seed < 20; ++seed)
    EXPECT_GT(distortion(disturbed(rest, 0.1, seed), gradient), 1e-4);
}

NodeFlags inside(const Mesh& mesh, const std::function<bool(const Vec3&)>& is_inside) {
  NodeFlags flags;
  for (const Vec3& x : mesh.nodes) flags.push_back(is_inside(x) ? 1 : 0);
  return flags;
}

bool in_box(const Vec3& x) { return x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9; }

// Free nodes anywhere near where they were.
std::vector<Vec3> scrambled(const Mesh& mesh, const NodeFlags& is_free, double size,
                            const Vec3& mask = Vec3::Ones()) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vec3> result = mesh.nodes;
  for (std::size_t node = 0; node < result.size(); ++node)
    if (is_free[node])
      result[node] += mask.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
  return result;
}

detail::Simplices simplices_of(const Mesh& mesh, const std::vector<detail::Simplex>& all) {
  return {mesh.nodes, all};
}

}  // namespace

TEST(FoldoverFree, TheGradientIsThatOfTheEnergy) {
  expect_gradient<2>();
  expect_gradient<3>();
}

TEST(FoldoverFree, RotationsAndShiftsChangeNothingAndScalingTheUnit) {
  expect_invariance<2>();
  expect_invariance<3>();
}

TEST(FoldoverFree, TheRestShapeHasTheLeastEnergy) {
  expect_least_at_rest<2>();
  expect_least_at_rest<3>();
}

// chi is positive and falls with the determinant, so that the energy of an inverted simplex is
// finite and grows as it is turned further.
TEST(FoldoverFree, InvertedSimplicesCostTheMoreTheFurtherTheyAreTurned) {
  auto distortion = two_distorted<3>();
  distortion.set_epsilon(0.1);
  Eigen::VectorXd x = distortion.free_points(), gradient;
  double previous = 0;
  for (const double height : {0.5, 0.1, 0.0, -0.1, -1.0, -3.0}) {
    x[11] = height;  // z of the tip of the first tetrahedron
    const double value = distortion(x, gradient);
    EXPECT_TRUE(std::isfinite(value));
    EXPECT_GT(value, previous);
    previous = value;
  }
}

TEST(FoldoverFree, NodesAtRestStay) {
  for (const ElementShape shape : volume_shapes) {
    const Mesh mesh = test::cell_box(shape, 4);
    const NodeFlags is_free = inside(mesh, in_box);
    const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
    std::vector<Vec3> positions = mesh.nodes;
    EXPECT_TRUE(detail::untangle(simplices_of(mesh, simplices), is_free, positions));
    for (std::size_t node = 0; node < positions.size(); ++node)
      EXPECT_NEAR((positions[node] - mesh.nodes[node]).norm(), 0, 1e-9);
  }
}

TEST(FoldoverFree, ScrambledVolumesAreRepaired) {
  for (const ElementShape shape : volume_shapes) {
    const Mesh mesh = test::cell_box(shape, 6);
    const NodeFlags is_free = inside(mesh, in_box);
    const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
    std::vector<Vec3> positions = scrambled(mesh, is_free, 0.3);
    const std::vector<Vec3> before = positions;
    EXPECT_GT(check_mesh(mesh, positions).inverted_elements, n_elements(mesh, 3) / 3);
    EXPECT_TRUE(detail::untangle(simplices_of(mesh, simplices), is_free, positions));
    EXPECT_TRUE(check_mesh(mesh, positions).valid());
    for (std::size_t node = 0; node < positions.size(); ++node)
      EXPECT_TRUE(is_free[node] || positions[node] == before[node]);
  }
}

// In a plane that lies askew. What is across it stays to round-off.
TEST(FoldoverFree, ScrambledPlanesAreRepaired) {
  const Eigen::Affine3d tilt(Eigen::AngleAxisd(0.6, Vec3(1, 2, -1).normalized()));
  for (const bool quadrangles : {false, true}) {
    const Mesh flat = test::ring(40, quadrangles), mesh = test::transformed(flat, tilt);
    const NodeFlags is_free =
        inside(flat, [](const Vec3& x) { return x.norm() > 0.26 && x.norm() < 0.99; });
    const auto simplices = detail::deforming_simplices(mesh, 2, is_free);
    std::vector<Vec3> positions;
    for (const Vec3& x : scrambled(flat, is_free, 0.2, {1, 1, 0})) positions.push_back(tilt * x);
    const Vec3 normal = tilt.linear() * Vec3::UnitZ();
    EXPECT_GT(check_mesh(mesh, positions).inverted_elements, n_elements(mesh, 2) / 4);
    EXPECT_TRUE(detail::untangle({mesh.nodes, simplices, normal}, is_free, positions));
    EXPECT_TRUE(check_mesh(mesh, positions).valid());
    for (const Vec3& x : positions) EXPECT_NEAR(x.dot(normal), 0, 1e-14);
  }
}

// An element may be listed in either orientation.
TEST(FoldoverFree, TurnedElementsKeepTheirSign) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  for (Index e = 0; e < mesh.blocks[2].size(); e += 2) test::turn_element(mesh.blocks[2], e);
  const NodeFlags is_free = inside(mesh, in_box);
  const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  std::vector<Vec3> positions = scrambled(mesh, is_free, 0.3);
  EXPECT_TRUE(detail::untangle(simplices_of(mesh, simplices), is_free, positions));
  EXPECT_TRUE(check_mesh(mesh, positions).valid());
}

TEST(FoldoverFree, DoesNotDependOnTheNumberOfThreads) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 16);  // several ranges
  const NodeFlags is_free = inside(mesh, in_box);
  const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  const auto run = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    std::vector<Vec3> positions = scrambled(mesh, is_free, 0.06);
    detail::untangle(simplices_of(mesh, simplices), is_free, positions);
    return positions;
  };
  const std::vector<Vec3> one = run(1);
  EXPECT_EQ(run(2), one);
  EXPECT_EQ(run(7), one);
}

TEST(FoldoverFree, ScalingBy1024IsExact) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const NodeFlags is_free = inside(mesh, in_box);
  const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  std::vector<Vec3> positions = scrambled(mesh, is_free, 0.2), large = positions;
  for (Vec3& x : large) x *= 1024;
  const Mesh large_mesh = test::transformed(mesh, Eigen::Affine3d(Eigen::Scaling(1024.0)));
  detail::untangle(simplices_of(mesh, simplices), is_free, positions);
  detail::untangle(simplices_of(large_mesh, simplices), is_free, large);
  for (std::size_t i = 0; i < large.size(); ++i) EXPECT_EQ(large[i], 1024 * positions[i]);
}

// A box whose lid lies below its bottom holds no valid mesh.
TEST(FoldoverFree, TheImpossibleEnds) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const NodeFlags is_free = inside(mesh, in_box);
  const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  std::vector<Vec3> positions = mesh.nodes;
  for (Vec3& x : positions)
    if (x.z() == 1) x.z() = -0.2;
  EXPECT_FALSE(detail::untangle(simplices_of(mesh, simplices), is_free, positions));
  for (const Vec3& x : positions) EXPECT_TRUE(x.allFinite());
}

TEST(FoldoverFree, WhatIsNotFiniteEnds) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const NodeFlags is_free = inside(mesh, in_box);
  const auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300})
    for (const bool at_free : {true, false}) {
      std::vector<Vec3> positions = mesh.nodes;
      const auto node = std::find(is_free.begin(), is_free.end(), at_free ? 1 : 0);
      positions[static_cast<std::size_t>(node - is_free.begin())].x() = value;
      if (at_free) positions[0] = mesh.nodes[0];
      const bool is_valid = detail::untangle(simplices_of(mesh, simplices), is_free, positions);
      EXPECT_TRUE(!is_valid || check_mesh(mesh, positions).valid());
    }
}

TEST(FoldoverFree, FlatRestShapesAndLooseNodesDoNoHarm) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  NodeFlags is_free = inside(mesh, in_box);
  auto simplices = detail::deforming_simplices(mesh, 3, is_free);
  const Index a = simplices[0][0], b = simplices[0][1];
  simplices.push_back({a, b, a, b});
  mesh.nodes.emplace_back(0.5, 0.5, 0.4);
  is_free.push_back(1);
  std::vector<Vec3> positions = scrambled(mesh, is_free, 0.2);
  const Vec3 loose = positions.back();
  EXPECT_TRUE(detail::untangle(simplices_of(mesh, simplices), is_free, positions));
  EXPECT_EQ(positions.back(), loose);
  EXPECT_TRUE(detail::untangle(simplices_of(mesh, {}), is_free, positions));
}
