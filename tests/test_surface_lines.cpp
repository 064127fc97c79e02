// SPDX-License-Identifier: BSD-3-Clause
// Curves of planar meshes: which lines, which way, normals, lengths.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/resolution.hpp"

#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/planar.hpp"
#include "support/same_surface.hpp"

using namespace roughmesh;

namespace {

Eigen::Affine3d any_plane() {
  return Eigen::Translation3d(3, -2, 5) * Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized());
}

Surface curve(const Mesh& mesh, const std::string& group) {
  return select_surface(mesh, {.groups = {group}});
}

/// Every line of this group that lies to the right of the plane x = 0 only.
Mesh right_half(Mesh mesh, Tag group) {
  for (ElementBlock& block : mesh.blocks) {
    if (block.type.shape != ElementShape::line || block.physical_groups.front() != group) continue;
    ElementBlock half = block;
    half.nodes.clear();
    half.tags.clear();
    for (Index e = 0; e < block.size(); ++e) {
      const auto line = block.element(e);
      if (mesh.nodes[line[0]].x() + mesh.nodes[line[1]].x() < 0) continue;
      half.nodes.insert(half.nodes.end(), line.begin(), line.end());
      half.tags.push_back(block.tags[e]);
    }
    block = half;
  }
  return mesh;
}

std::string message_of(const Mesh& mesh, std::vector<std::string> groups) {
  return test::message_of([&] { select_surface(mesh, {.groups = groups}); });
}

}  // namespace

// Eq. 35 is exact on circles; each of the few operations on numbers up to 3 rounds to 1e-16, and
// the shortest line, a tenth of the radius, magnifies that tenfold.
TEST(Curve, NormalsOfACircleAreExactWhateverTheLengths) {
  const double radius = 3;
  for (const bool tilted : {false, true}) {
    Mesh mesh = test::polyline(test::circle_points(test::uneven_angles(40), radius), true);
    const Vec3 centre = tilted ? Vec3(any_plane() * Vec3::Zero()) : Vec3::Zero();
    if (tilted) mesh = test::transformed(mesh, any_plane());
    const Surface circle = select_surface(mesh);
    EXPECT_EQ(circle.dimension, 1);
    EXPECT_GT(circle.mesh_size.max, 3 * circle.mesh_size.min);
    for (Index i = 0; i < circle.n_points(); ++i)
      EXPECT_NEAR((circle.normals[i] - (circle.points[i] - centre) / radius).norm(), 0, 1e-13);
  }
}

TEST(Curve, ASquareHasFourCornersAndLooksOutward) {
  Mesh mesh = test::polyline({{0, 0, 7}, {0, 1, 7}, {0, 2, 7}, {2, 2, 7}, {2, 0, 7}}, true);
  for (const bool turned : {false, true}) {
    if (turned) std::reverse(mesh.blocks[0].nodes.begin(), mesh.blocks[0].nodes.end());
    const Surface square = select_surface(mesh);
    EXPECT_EQ(square.n_sharp_edges, 4);
    EXPECT_EQ(square.n_border_edges, 0);
    EXPECT_EQ(square.n_components, 1);
    EXPECT_EQ(square.n_faces(), 5);
    EXPECT_EQ(square.n_elements, 5);
    EXPECT_DOUBLE_EQ(square.area, 8);
    EXPECT_DOUBLE_EQ(enclosed_volume(square, square.points), 4);
    EXPECT_EQ(square.mesh_size.min, 1);
    EXPECT_EQ(square.mesh_size.median, 2);
    EXPECT_EQ(square.points[0], Vec3(0, 0, 7));
    EXPECT_DOUBLE_EQ(square.areas[0], 1.5);  // half of 1 and half of 2
    EXPECT_NEAR((square.normals[1] - Vec3(-1, 0, 0)).norm(), 0, 1e-15);
  }
  EXPECT_LT(
      [&] {
        const Surface inward = select_surface(mesh, {.flip = true});
        return enclosed_volume(inward, inward.points);
      }(),
      0);
}

TEST(Curve, AnOpenLineLooksAsMostOfItsLengthDoesInTheFile) {
  Mesh mesh = test::polyline({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}}, false);
  for (const Vec3& normal : select_surface(mesh).normals) EXPECT_EQ(normal, Vec3(0, -1, 0));
  std::swap(mesh.blocks[0].nodes[0], mesh.blocks[0].nodes[1]);  // one of five
  for (const Vec3& normal : select_surface(mesh).normals) EXPECT_EQ(normal, Vec3(0, -1, 0));
  std::swap(mesh.blocks[0].nodes[4], mesh.blocks[0].nodes[5]);  // four of five
  const Surface line = select_surface(mesh);
  for (const Vec3& normal : line.normals) EXPECT_EQ(normal, Vec3(0, 1, 0));
  EXPECT_EQ(line.n_border_edges, 2);
  EXPECT_EQ(line.n_sharp_edges, 0);
  EXPECT_EQ(line.areas, (std::vector<double>{0.5, 1, 2, 1.5}));
}

// A straight line lies in many planes; what it is moved in is the one closest to z = const.
TEST(Curve, AStraightLineInSpaceHasAPlane) {
  const Surface along_z = select_surface(test::polyline({{0, 0, 0}, {0, 0, 2}}, false));
  EXPECT_EQ(along_z.plane_normal, Vec3(0, 1, 0));
  const Surface slanted = select_surface(test::polyline({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, false));
  EXPECT_NEAR(slanted.plane_normal.dot(Vec3(1, 1, 1)), 0, 1e-15);
  EXPECT_NEAR(slanted.plane_normal.z(), std::sqrt(2.0 / 3), 1e-15);
}

// Of a ring with two faces, like BetweenTwoVolumesItLooksOutOfTheLowerNumber.
TEST(Curve, OpenPartsLookOutOfTheirFaces) {
  const auto outward = [](const Mesh& mesh, const std::string& group) {
    const Surface half = curve(mesh, group);
    EXPECT_EQ(half.n_border_edges, 2);
    int sign = 0;
    for (Index i = 0; i < half.n_points(); ++i)
      sign += half.normals[i].dot(half.points[i]) > 0 ? 1 : -1;
    EXPECT_EQ(std::abs(sign), half.n_points());
    return sign > 0;
  };
  for (const bool quadrangles : {false, true})
    for (const unsigned seed : {1u, 2u, 3u}) {
      Mesh mesh = test::ring(16, quadrangles);
      for (const Tag group : {1, 2, 3}) mesh = right_half(mesh, group);
      mesh = test::shuffled(mesh, seed);
      if (seed == 2)
        for (ElementBlock& block : mesh.blocks)
          if (block.type.shape == ElementShape::line)
            std::reverse(block.nodes.begin(), block.nodes.end());
      EXPECT_FALSE(outward(mesh, "hole"));
      EXPECT_TRUE(outward(mesh, "interface"));
      EXPECT_TRUE(outward(mesh, "rim"));
      for (ElementBlock& block : mesh.blocks)
        if (block.type.shape != ElementShape::line) block.entity = 3 - block.entity;
      EXPECT_FALSE(outward(mesh, "interface"));
    }
}

TEST(Curve, DoesNotDependOnNumbersAndOrder) {
  for (const bool tilted : {false, true}) {
    Mesh mesh = test::ring(16);
    if (tilted) mesh = test::transformed(mesh, any_plane());
    for (const unsigned seed : {1u, 2u}) {
      const Mesh other = test::shuffled(mesh, seed);
      for (const std::string group : {"hole", "interface", "rim", "all"}) {
        test::expect_same_surface(curve(mesh, group), curve(other, group));
        EXPECT_EQ(curve(mesh, group).plane_normal, curve(other, group).plane_normal);
      }
    }
  }
}

TEST(Curve, MovesWithTheBody) {
  const Mesh mesh = test::ring(16);
  const Surface flat = curve(mesh, "interface");
  const Surface tilted = curve(test::transformed(mesh, any_plane()), "interface");
  EXPECT_NEAR(tilted.area, flat.area, 1e-13);
  EXPECT_NEAR(enclosed_volume(tilted, tilted.points), enclosed_volume(flat, flat.points), 1e-13);
  EXPECT_NEAR(std::abs(tilted.plane_normal.dot(any_plane().linear() * Vec3::UnitZ())), 1, 1e-14);
  const Vec3 centre = any_plane() * Vec3::Zero();
  for (Index i = 0; i < tilted.n_points(); ++i)
    EXPECT_GT(tilted.normals[i].dot(tilted.points[i] - centre), 0.99 * 0.625);
}

TEST(Curve, ABranchIsAccepted) {
  Mesh mesh = test::polyline({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, false);
  mesh.blocks[0].nodes = {0, 1, 1, 2, 1, 3};
  const Surface branch = select_surface(mesh);
  EXPECT_EQ(branch.n_nonmanifold_edges, 1);
  EXPECT_EQ(branch.n_border_edges, 3);
  EXPECT_EQ(branch.n_components, 1);
}

TEST(Curve, CollapsedAndDoubleLinesAreTakenOut) {
  Mesh mesh = test::polyline({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}}, false);
  mesh.blocks[0].nodes.insert(mesh.blocks[0].nodes.end(), {1, 0});
  mesh.blocks[0].tags.push_back(4);
  const Surface line = select_surface(mesh);
  EXPECT_EQ(line.n_faces(), 2);
  EXPECT_EQ(line.n_duplicate_faces, 1);
  EXPECT_EQ(line.n_points(), 3);
  EXPECT_EQ(line.nodes.size(), 4u);
}

// Four lines that leave a point along the axes: their normals cancel.
TEST(Curve, APointWithoutNormalIsRefused) {
  Mesh mesh = test::polyline({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, false);
  mesh.blocks[0].nodes = {0, 1, 0, 2, 0, 3, 0, 4};
  EXPECT_EQ(
      message_of(mesh, {}),
      "node 1 at (0, 0, 0) has no normal: its lines have no length or cancel each other; mend "
      "the mesh there");
}

TEST(Curve, GroupsOfAPlanarMesh) {
  const Mesh mesh = test::ring(16);
  EXPECT_EQ(curve(mesh, "2").groups, std::vector<std::string>{"interface"});
  EXPECT_EQ(curve(mesh, "2").dimension, 1);
  EXPECT_EQ(curve(mesh, "all").n_faces(), 3 * 16);
  EXPECT_EQ(curve(mesh, "all").n_components, 3);
  const Surface plate = curve(mesh, "shell");  // asked for by its name: it moves out of the plane
  EXPECT_EQ(plate.dimension, 2);
  EXPECT_NEAR(std::abs(plate.normals[0].z()), 1, 1e-15);
  const std::string choice =
      "groups of lines: hole (1), interface (2), rim (3); surface groups, which move out of the "
      "plane: core (1), shell (2)";
  EXPECT_EQ(
      message_of(mesh, {}),
      "several groups could become rough; choose with --group, more than once or `all`; " + choice);
  EXPECT_EQ(message_of(mesh, {"gold"}), "there is no physical group 'gold'; " + choice);
  EXPECT_EQ(message_of(mesh, {"rim", "shell"}),
            "physical groups rim and shell (2) have dimensions 1 and 2; choose groups of one "
            "dimension");
  Mesh one = mesh;
  std::erase_if(one.blocks, [](const ElementBlock& b) {
    return b.type == test::line_type && b.physical_groups.front() != 2;
  });
  EXPECT_EQ(select_surface(one).groups, std::vector<std::string>{"interface"});
  for (ElementBlock& block : one.blocks) block.physical_groups.clear();
  EXPECT_EQ(message_of(one, {}),
            "lines or faces of this planar mesh could become rough, choose; the mesh has no group "
            "of lines; use all for every line");
  Mesh plain = mesh;
  std::erase_if(plain.blocks, [](const ElementBlock& b) { return b.type == test::line_type; });
  EXPECT_EQ(select_surface(plain, {.groups = {"all"}}).dimension, 2);
}

TEST(Curve, LinesOutOfAPlaneAreRefusedWithTheReason) {
  Mesh mesh = test::ring(16);
  mesh.nodes[5].z() = 0.1;
  EXPECT_EQ(message_of(mesh, {"rim"})
                .find("physical group 'rim' has dimension 1, not 2: lines "
                      "become rough in planar meshes only, and node "),
            0u);
  EXPECT_EQ(select_surface(mesh, {.groups = {"core"}}).dimension, 2);
  const Mesh helix = test::polyline({{1, 0, 0}, {0, 1, 0.3}, {-1, 0, 0.6}, {0, -1, 1}}, false);
  EXPECT_NE(message_of(helix, {}).find("lines become rough in planar meshes only"),
            std::string::npos);
  EXPECT_NE(message_of(helix, {"line"}).find("lines become rough in planar meshes only"),
            std::string::npos);
  Mesh box = test::cell_box(ElementShape::tetrahedron, 2);
  box.blocks.push_back(test::make_block(test::line_type, 1, {7}, {0, 1}, 5));
  box.groups.push_back({1, 7, "edge"});
  EXPECT_NE(message_of(box, {"edge"}).find("this one has volumes"), std::string::npos);
}

TEST(Curve, CoordinatesMustBeFinite) {
  for (const int axis : {0, 1, 2}) {
    Mesh mesh = test::ring(16);
    mesh.nodes[3][axis] = std::nan("");
    EXPECT_THROW(curve(mesh, "hole"), InputError);
  }
}

// Half an edge of a polygon of n points on the circle turns by pi/n: heights c scale it by 1 + c.
TEST(Curve, AConstantHeightInflatesACircle) {
  const Surface circle =
      select_surface(test::polyline(test::circle_points(test::uneven_angles(30), 1), true));
  const double before = enclosed_volume(circle, circle.points);
  const std::vector<double> heights(circle.points.size(), 0.25);
  const auto grown = moved_points(circle, displace(circle, heights));
  EXPECT_NEAR(enclosed_volume(circle, grown), before * 1.25 * 1.25, 1e-13);
}

// E|d'|^2 is a mean over lines; on evenly spaced points of a line it is one number. No points of a
// straight line have a curvature.
TEST(Curve, ResolutionIsThatOfALine) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 50; ++i) points.emplace_back(0.1 * i, 0, 0);
  const Surface line = select_surface(test::polyline(points, false));
  const Autocorrelation rho({.family = Family::gaussian, .length = 0.5});
  const Resolution r =
      assess_resolution(line, Correlation(line.points, rho, Distance::euclidean()));
  EXPECT_NEAR(r.rms_slope, std::sqrt(2 * (1 - rho.rho(0.1))) / 0.1, 1e-12);
  EXPECT_NEAR(*r.field_slope, 2, 1e-12);
  EXPECT_NEAR(r.spectrum_share_above_nyquist,
              std::erfc(std::numbers::pi / 0.1 * 0.5 / std::numbers::sqrt2), 1e-12);
  EXPECT_TRUE(std::isinf(r.min_curvature_radius));
  const Surface circle =
      select_surface(test::polyline(test::circle_points(test::uneven_angles(60), 2), true));
  EXPECT_NEAR(assess_resolution(circle, Correlation(circle.points, rho, Distance::euclidean()))
                  .min_curvature_radius,
              2, 1e-12);
}
