// SPDX-License-Identifier: BSD-3-Clause
// Thin walls and gaps of a surface: which heights close them, and where they have.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"

#include "support/cells.hpp"
#include "support/meshes.hpp"
#include "support/moved_surfaces.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "surface_motion.hpp"

using namespace roughmesh;
using namespace roughmesh::test;

namespace {

// Two plates that change places without touching each other anywhere.
TEST(ThinWalls, SheetsThatChangePlacesCloseAWall) {
  const Mesh mesh = two_plates(4, 0.5);
  for (const double height : {0.2, 0.3}) {
    std::vector<Vec3> moved = mesh.nodes;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i].z() += i < 25 ? height : -height;
    const SurfaceCheck result = check(mesh, moved);
    EXPECT_EQ(result.self_intersections, 0);
    EXPECT_EQ(result.closed_walls, height > 0.25 ? 50 : 0);
    if (height < 0.25) continue;
    ASSERT_FALSE(result.findings.empty());
    EXPECT_EQ(result.findings.front().defect, SurfaceDefect::closed_wall);
    EXPECT_NEAR(result.findings.front().passing_share, 0.25 / 0.3, 1e-12);
  }
}

TEST(ThinWalls, CurvesThatChangePlacesCloseAWall) {
  const Mesh mesh = test::strip(10, 2, 4.0);
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& x : moved)
    if (std::abs(x.y()) == 1) x.y() *= -0.5;
  const SurfaceCheck result = check(mesh, "lower", moved);
  EXPECT_EQ(result.closed_walls, 22);
  ASSERT_FALSE(result.findings.empty());
  EXPECT_NEAR(result.findings.back().passing_share, 1 / 1.5, 1e-12);
}

// Valid surfaces at the rough end, with sharp edges, corners and a wedge: no wall is closed where
// nothing intersects.
TEST(ThinWalls, NoWallIsClosedInARoughBody) {
  for (const double size : {0.05, 0.1, 0.15}) {
    const Mesh box = test::cell_box(ElementShape::tetrahedron, 8);
    const SurfaceCheck result = check(box, jittered(box.nodes, size, 3));
    EXPECT_EQ(result.self_intersections > 0 ? 0 : result.closed_walls, 0);
  }
  Mesh wedge = test::without_faces(test::cell_box(ElementShape::tetrahedron, 8));
  for (Vec3& x : wedge.nodes) x.z() *= 0.5 * x.x() + 1e-3;  // some 27 degrees
  std::vector<Vec3> moved = wedge.nodes;
  for (Vec3& x : moved) x -= Vec3(0.2, 0, 0.03 * std::sin(9 * x.y()));
  EXPECT_EQ(check(wedge, moved).closed_walls, 0);
}

// Of a slab the thickness, from its points to the other side; of two slabs the gap.
TEST(ThinWalls, ThinnestWallOfASlab) {
  Mesh slab = test::without_faces(test::cell_box(ElementShape::tetrahedron, 4));
  for (Vec3& x : slab.nodes) x.z() *= 0.1;
  const Surface surface = all_of(slab);
  const SurfaceChecker checker(slab, test::only(surface));
  EXPECT_FALSE(checker.thinnest_wall(surface, 0.0499));
  const auto wall = checker.thinnest_wall(surface, 0.0625);
  ASSERT_TRUE(wall);
  EXPECT_FALSE(wall->is_gap);
  EXPECT_LE(wall->passing_share, 0.1 / 0.125 + 1e-12);
  EXPECT_GT(wall->passing_share, 0.1 / 0.125 / 2);  // normals at edges lean
  EXPECT_GE(wall->element, 10'001);                 // a side of a tetrahedron
}

TEST(ThinWalls, ThinnestGapBetweenPlates) {
  Mesh mesh = two_plates(4, 0.25);
  mesh.blocks[1].physical_groups = {2};
  mesh.groups.push_back({2, 2, "upper"});
  const Surface both = all_of(mesh), one = select_surface(mesh, {.groups = {"surface"}});
  const auto gap = SurfaceChecker(mesh, test::only(both)).thinnest_wall(both, 0.2);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->distance, 0.25, 1e-15);
  EXPECT_NEAR(gap->passing_share, 0.25 / 0.4, 1e-15);
  // Against a sheet that stays, heights of one side count.
  const SurfaceChecker against(mesh, test::only(one));
  EXPECT_FALSE(against.thinnest_wall(one, 0.2));
  EXPECT_NEAR(against.thinnest_wall(one, 0.5)->passing_share, 0.5, 1e-15);
  EXPECT_TRUE(against.thinnest_wall(one, 0.5)->is_gap);
}

TEST(ThinWalls, EveryConnectedPartIsSampled) {
  Mesh mesh = test::plate(10);
  for (int k = 1; k <= 3; ++k) mesh = joined(mesh, moved_by(test::icosphere(0), {3.0 * k, 0, 0}));
  const detail::CheckedFaces faces = detail::collect_faces(mesh, 2);
  for (const std::size_t step : {1, 7, 1000}) {
    const std::vector<Index> sample = faces.sample(step);
    EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
    EXPECT_GE(sample.size(), faces.nodes.size() / step);
    for (int part = 0; part <= 3; ++part)
      EXPECT_TRUE(std::any_of(sample.begin(), sample.end(), [&](Index point) {
        return std::lround(faces.before[point].x() / 3) == part;
      })) << step;
  }
}

}  // namespace
