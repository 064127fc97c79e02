// SPDX-License-Identifier: BSD-3-Clause
// Scaled Jacobians, and elements that turn over.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/error.hpp"

#include "parallel.hpp"
#include "support/cells.hpp"
#include "support/folded_plate.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

constexpr std::array all_shapes = {ElementShape::triangle,    ElementShape::quadrangle,
                                   ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism,       ElementShape::pyramid};

std::vector<Vec3> jittered(std::vector<Vec3> nodes, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  for (Vec3& x : nodes) x += Vec3(uniform(random), uniform(random), uniform(random));
  return nodes;
}

Mesh distorted(ElementShape shape) {
  return test::single_element(shape, jittered(test::ideal_corners(shape), 0.1, 3));
}

double signed_volume(const std::vector<Vec3>& nodes, std::span<const Index> t) {
  return (nodes[t[1]] - nodes[t[0]])
             .cross(nodes[t[2]] - nodes[t[0]])
             .dot(nodes[t[3]] - nodes[t[0]]) /
         6;
}

// Numbers of the tetrahedra whose volume is negative, counted independently of the library.
std::vector<Tag> negative_tetrahedra(const Mesh& mesh, const std::vector<Vec3>& nodes) {
  std::vector<Tag> tags;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.shape != ElementShape::tetrahedron) continue;
    for (Index e = 0; e < block.size(); ++e)
      if (signed_volume(nodes, block.element(e)) < 0) tags.push_back(block.tags[e]);
  }
  return tags;
}

}  // namespace

// A product of a few unit vectors: some ten roundings of 1e-16.
TEST(Check, IdealElementsHaveQualityOne) {
  for (const ElementShape shape : all_shapes) {
    const Mesh mesh = test::single_element(shape, test::ideal_corners(shape));
    EXPECT_NEAR(min_quality(mesh), 1, 2e-15) << name(mesh.blocks[0].type);
    const MeshCheck check = check_mesh(mesh, mesh.nodes);
    EXPECT_TRUE(check.valid());
    EXPECT_EQ(check.min_quality, min_quality(mesh));
  }
}

// Corner of a cube: edges of 1, 1, 1 at its own corner, of 1, sqrt 2, sqrt 2 at the three others.
TEST(Check, QualityOfKnownElements) {
  const Mesh corner =
      test::single_element(ElementShape::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_NEAR(min_quality(corner), std::sqrt(2.0) / 2, 1e-15);
  const Mesh right =
      test::single_element(ElementShape::triangle, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_NEAR(min_quality(right), std::sin(std::atan(1.0)) * 2 / std::sqrt(3.0), 1e-15);
  const Mesh rhombus = test::single_element(ElementShape::quadrangle,
                                            {{0, 0, 0}, {1, 0, 0}, {1.6, 0.8, 0}, {0.6, 0.8, 0}});
  EXPECT_NEAR(min_quality(rhombus), 0.8, 1e-15);
  EXPECT_EQ(min_quality(Mesh{}), 1);
}

TEST(Check, QualityDoesNotDependOnPlaceDirectionAndUnit) {
  const Eigen::AngleAxisd rotation(1.1, Vec3(3, -1, 2).normalized());
  const Eigen::Affine3d motion = Eigen::Translation3d(3, 4, -5) * rotation;
  const Eigen::Affine3d scale(Eigen::Scaling(1024.0)), small(Eigen::Scaling(1e-9));
  for (const ElementShape shape : all_shapes) {
    const Mesh mesh = distorted(shape);
    const double quality = min_quality(mesh);
    EXPECT_LT(quality, 1);
    // Coordinates up to 8 round to 1e-15, edges are about 1.
    EXPECT_NEAR(min_quality(test::transformed(mesh, motion)), quality, 2e-14);
    EXPECT_EQ(min_quality(test::transformed(mesh, scale)), quality);
    EXPECT_NEAR(min_quality(test::transformed(mesh, small)), quality, 1e-14);
  }
}

TEST(Check, OrientationOfTheFileDoesNotMatter) {
  Mesh mesh = test::ball_in_box(4);
  const double quality = min_quality(mesh);
  for (Index e = 0; e < mesh.blocks[3].size(); e += 2) test::turn_element(mesh.blocks[3], e);
  EXPECT_NEAR(min_quality(mesh), quality, 1e-15);
  EXPECT_TRUE(check_mesh(mesh, mesh.nodes).valid());
  EXPECT_GT(min_quality(mesh), 0);
}

TEST(Check, AMirrorImageTurnsEveryElementOver) {
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid}) {
    const Mesh mesh = test::cell_box(shape, 2);
    const Eigen::Affine3d mirror(Eigen::Scaling(1.0, -1.0, 1.0));
    const MeshCheck check = check_mesh(mesh, test::transformed(mesh, mirror).nodes);
    EXPECT_EQ(check.inverted_elements, n_elements(mesh, 3));
    EXPECT_LT(check.min_quality, 0);
    EXPECT_EQ(check.findings.size(), std::min<std::size_t>(10, n_elements(mesh, 3)));
  }
}

TEST(Check, InvertedElementsAreCountedAndFound) {
  const Mesh mesh = test::shuffled(test::ball_in_box(4), 1);
  for (const double size : {0.15, 0.3, 0.6}) {
    const std::vector<Vec3> moved = jittered(mesh.nodes, size, 11);
    const std::vector<Tag> negative = negative_tetrahedra(mesh, moved);
    ASSERT_FALSE(negative.empty());
    const MeshCheck check = check_mesh(mesh, moved);
    EXPECT_EQ(check.inverted_elements, static_cast<std::int64_t>(negative.size()));
    EXPECT_FALSE(check.valid());
    ASSERT_EQ(check.findings.size(), std::min<std::size_t>(10, negative.size()));
    EXPECT_EQ(check.findings.front().value, check.min_quality);
    for (std::size_t i = 0; i < check.findings.size(); ++i) {
      const Finding& finding = check.findings[i];
      EXPECT_EQ(finding.what, "inverted tetrahedron");
      EXPECT_EQ(std::count(negative.begin(), negative.end(), finding.element), 1);
      EXPECT_LT(finding.value, finding.limit);
      EXPECT_GE(finding.value, check.findings[i > 0 ? i - 1 : 0].value);
    }
  }
}

// One node of a regular tetrahedron pushed through the opposite face, to its mirror image.
TEST(Check, AFindingNamesElementPlaceAndValue) {
  Mesh mesh = test::single_element(ElementShape::tetrahedron,
                                   test::ideal_corners(ElementShape::tetrahedron));
  mesh.blocks[0].tags = {77};
  std::vector<Vec3> moved = mesh.nodes;
  moved[3].z() = -moved[3].z();
  const MeshCheck check = check_mesh(mesh, moved);
  ASSERT_EQ(check.findings.size(), 1U);
  EXPECT_EQ(check.findings[0].element, 77);
  EXPECT_NEAR(check.findings[0].value, -1, 1e-15);
  EXPECT_EQ(check.findings[0].limit, 0);
  const Vec3 centroid(0.5, std::sqrt(3.0) / 6, -std::sqrt(2.0 / 3) / 4);
  EXPECT_NEAR((check.findings[0].place - centroid).norm(), 0, 1e-15);
}

// One corner of a hexahedron pushed past the plane of its three neighbours: only corners see it.
TEST(Check, OneCornerIsEnough) {
  const Mesh cube =
      test::single_element(ElementShape::hexahedron, test::ideal_corners(ElementShape::hexahedron));
  std::vector<Vec3> moved = cube.nodes;
  moved[0] = Vec3(0.3, 0.3, 0.3);
  EXPECT_TRUE(check_mesh(cube, moved).valid());
  moved[0] = Vec3(0.4, 0.4, 0.4);
  EXPECT_EQ(check_mesh(cube, moved).inverted_elements, 1);
}

// To be flattened is to lose the sign; to have had none leaves nothing to lose.
TEST(Check, ZeroJacobians) {
  const Mesh mesh =
      test::single_element(ElementShape::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  std::vector<Vec3> flat = mesh.nodes;
  flat[3] = Vec3(1, 1, 0);
  EXPECT_EQ(check_mesh(mesh, flat).inverted_elements, 1);
  EXPECT_EQ(check_mesh(mesh, flat).min_quality, 0);
  const Mesh flat_mesh = test::single_element(ElementShape::tetrahedron, flat);
  EXPECT_TRUE(check_mesh(flat_mesh, mesh.nodes).valid());
  const std::vector<Vec3> collapsed(4, Vec3::Zero());
  EXPECT_EQ(check_mesh(mesh, collapsed).min_quality, 0);
}

// In the plane a triangle is folded when its corners run clockwise.
TEST(Check, FoldedTrianglesOfASurfaceMesh) {
  const auto [mesh, moved, n_clockwise] = test::folded_plate();
  ASSERT_GT(n_clockwise, 0);
  const MeshCheck check = check_mesh(mesh, moved);
  EXPECT_EQ(check.inverted_elements, n_clockwise);
  EXPECT_EQ(check.findings.front().what, "inverted triangle");
  EXPECT_LT(check.min_quality, 0);
}

// Heights over a plane turn normals by less than 90 degrees, however steep.
TEST(Check, AHeightFieldOverAPlaneIsNeverFolded) {
  const Mesh mesh = test::plate(6);
  std::vector<Vec3> moved = mesh.nodes;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i].z() = i % 2 == 0 ? 5 : -5;
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
}

TEST(Check, AConcaveQuadrangleIsFolded) {
  const Mesh mesh =
      test::single_element(ElementShape::quadrangle, test::ideal_corners(ElementShape::quadrangle));
  std::vector<Vec3> moved = mesh.nodes;
  moved[2] = Vec3(0.4, 0.4, 0);
  const MeshCheck check = check_mesh(mesh, moved);
  EXPECT_EQ(check.inverted_elements, 1);
  EXPECT_EQ(check.findings.front().what, "inverted quadrangle");
}

// Faces of a volume mesh and lines of a surface mesh are not what is checked.
TEST(Check, OnlyTheLargestDimensionCounts) {
  Mesh mesh = test::ball_in_box(4);
  const double quality = min_quality(mesh);
  mesh.blocks[0].nodes[1] = mesh.blocks[0].nodes[0];
  EXPECT_EQ(min_quality(mesh), quality);
}

// A shell of two triangles that hangs on an edge of the volume: neither is a face of an element.
TEST(Check, FacesBesideTheVolumeAreChecked) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 2);
  const Index a = mesh.n_nodes();
  mesh.nodes.insert(mesh.nodes.end(), {{-0.5, 0, 0}, {-0.5, 0.5, 0}});
  mesh.blocks.push_back(
      test::make_block(test::triangle_type, 5, {}, {0, 3, a, 3, a + 1, a}, 901));  // 3: (0, 0.5, 0)
  test::number_nodes(mesh);
  std::vector<Vec3> moved = mesh.nodes;
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
  moved[a] = Vec3(0.3, 0.3, 0);  // over the edge that both hang on
  const MeshCheck check = check_mesh(mesh, moved);
  EXPECT_EQ(check.inverted_elements, 1);
  ASSERT_EQ(check.findings.size(), 1U);
  EXPECT_EQ(check.findings[0].what, "folded triangle");
  EXPECT_EQ(check.findings[0].element, 901);
  EXPECT_EQ(check.min_quality, min_quality(mesh));  // of the volume, which did not move
}

TEST(Check, PositionsMustBeFiniteAndComplete) {
  const Mesh mesh = test::plate(2);
  std::vector<Vec3> moved = mesh.nodes;
  EXPECT_THROW(check_mesh(mesh, std::span(moved).first(3)), InputError);
  moved[4].y() = std::nan("");
  EXPECT_THROW(check_mesh(mesh, moved), NumericalError);
  moved[4].y() = INFINITY;
  EXPECT_THROW(check_mesh(mesh, moved), NumericalError);
}

TEST(Check, DoesNotDependOnTheNumberOfThreads) {
  const Mesh mesh = test::ball_in_box(12);  // several ranges of elements
  const std::vector<Vec3> moved = jittered(mesh.nodes, 0.1, 2);
  const auto run = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return check_mesh(mesh, moved);
  };
  const MeshCheck one = run(1), two = run(2);
  EXPECT_EQ(one.inverted_elements, two.inverted_elements);
  EXPECT_EQ(one.min_quality, two.min_quality);
  ASSERT_EQ(one.findings.size(), two.findings.size());
  for (std::size_t i = 0; i < one.findings.size(); ++i)
    EXPECT_EQ(one.findings[i].element, two.findings[i].element);
}
