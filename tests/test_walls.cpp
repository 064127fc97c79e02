// SPDX-License-Identifier: BSD-3-Clause
// Walls beside rough surfaces keep their planes and outlines.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/walls.hpp"

#include "support/rough_boxes.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;
using test::add_group;
using test::box;
using test::Height;
using test::hilly;
using test::is_on_side;
using test::move;
using test::Moved;
using test::turned;
using test::waves;

namespace {

// Rectangle [0, 2] x [0, 1] of squares, two triangles each; lines "top" (1) above and, where it is
// asked for, "rest" (2) around.
Mesh rectangle(int divisions, bool with_rest) {
  const int row = 2 * divisions + 1;
  Mesh mesh;
  for (int j = 0; j <= divisions; ++j)
    for (int i = 0; i < row; ++i) mesh.nodes.push_back(Vec3(i, j, 0) / divisions);
  std::vector<Index> cells, top, rest;
  for (int j = 0; j < divisions; ++j)
    for (int i = 0; i + 1 < row; ++i) {
      const Index a = j * row + i, b = a + 1, c = b + row, d = a + row;
      cells.insert(cells.end(), {a, b, c, a, c, d});
      if (j == 0) rest.insert(rest.end(), {a, b});
      if (j + 1 == divisions) top.insert(top.end(), {c, d});
      if (i == 0) rest.insert(rest.end(), {d, a});
      if (i + 2 == row) rest.insert(rest.end(), {b, c});
    }
  mesh.blocks = {test::make_block(test::line_type, 1, {1}, std::move(top), 1),
                 test::make_block(test::triangle_type, 1, {1}, std::move(cells), 10'001)};
  mesh.groups = {{1, 1, "top"}, {2, 1, "domain"}};
  if (with_rest) {
    mesh.blocks.push_back(test::make_block(test::line_type, 2, {2}, std::move(rest), 1001));
    mesh.groups.push_back({1, 2, "rest"});
  }
  test::number_nodes(mesh);
  return mesh;
}

}  // namespace

// Heights of 1.5 cells: the foldover-free map takes part.
TEST(Walls, SidesKeepTheirPlanesToTheBitAndTheBottomStays) {
  const Moved moved = move(hilly(box(8)), "top", [](const Vec3& x) { return 0.17 * waves(x); });
  EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
  EXPECT_EQ(moved.method, VolumeMethod::foldover_free);
  const std::set<Index> rough(moved.surface.nodes.begin(), moved.surface.nodes.end());
  EXPECT_EQ(moved.walls.torn.size(), 0U);
  int n_sliding = 0;
  for (Index node = 0; node < moved.mesh.n_nodes(); ++node) {
    const Vec3 &before = moved.mesh.nodes[node], &after = moved.nodes[node];
    for (const int axis : {0, 1})
      if (before[axis] == 0 || before[axis] == 1) {
        EXPECT_EQ(after[axis], before[axis]);
      }
    if (before.z() == 0) {
      EXPECT_EQ(after, before);
    }
    n_sliding += is_on_side(before) && !rough.contains(node) && after != before;
  }
  EXPECT_EQ(n_sliding, 4 * 8 * 7);  // all of the sides but rim and bottom
  EXPECT_LE(moved.error(), 1e-12);
}

// Elements of every shape, with nodes in the middle of edges and faces as well, on both sides of a
// rough interface.
TEST(Walls, SidesKeepTheirPlanesForEveryShapeAndOrder) {
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid})
    for (const bool second : {false, true}) {
      SCOPED_TRACE(name(test::first_order(shape)) + (second ? " of order 2" : ""));
      const Mesh cells = hilly(test::cell_box(shape, 6));
      const Moved moved = move(second ? test::second_order(cells, true) : cells, "middle",
                               [](const Vec3& x) { return 0.05 * waves(x); });
      EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
      EXPECT_TRUE(moved.walls.torn.empty());
      int n_sliding = 0;
      for (Index node = 0; node < moved.mesh.n_nodes(); ++node) {
        const Vec3& x = moved.mesh.nodes[node];
        for (const int axis : {0, 1}) {
          if (x[axis] == 0 || x[axis] == 1) {
            EXPECT_EQ(moved.nodes[node][axis], x[axis]);
          }
        }
        n_sliding += is_on_side(x) && moved.nodes[node] != x;
      }
      const int per_cell = second ? 2 : 1, rim = 4 * 6 * per_cell;
      EXPECT_EQ(n_sliding, rim * (6 * per_cell - 1));  // all of the sides but bottom and top
    }
}

TEST(Walls, SlidingKeepsElementsValidWhereWallsThatStayDoNot) {
  const Height height = [](const Vec3& x) { return 0.19 * waves(x); };
  const Moved sliding = move(box(8), "top", height);
  const Moved staying = move(box(8), "top", height, {.can_slide = false});
  EXPECT_TRUE(check_mesh(sliding.mesh, sliding.nodes).valid());
  EXPECT_FALSE(check_mesh(staying.mesh, staying.nodes).valid());
  EXPECT_EQ(staying.walls.torn.size(), 32U);
  EXPECT_TRUE(staying.walls.sliding.empty());
}

// Rotation and translation change no decision, and results by round-off only; that of planes is
// some 1e-16 of coordinates below 5.
TEST(Walls, ObliquePlanesAreKeptToRoundOff) {
  const Mesh straight = hilly(box(8));
  const Moved moved = move(test::transformed(straight, turned), "top",
                           [](const Vec3& x) { return 0.06 * waves(turned.inverse() * x); });
  const Moved upright = move(straight, "top", [](const Vec3& x) { return 0.06 * waves(x); });
  EXPECT_EQ(moved.method, VolumeMethod::harmonic);
  EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
  EXPECT_LE(moved.error(), 1e-12);
  for (Index node = 0; node < moved.mesh.n_nodes(); ++node) {
    const Vec3 shift = turned.linear().transpose() * moved.shift(node);
    EXPECT_NEAR((shift - upright.shift(node)).norm(), 0, 1e-10);
    for (const int axis : {0, 1}) {
      if (straight.nodes[node][axis] == 0 || straight.nodes[node][axis] == 1) {
        EXPECT_NEAR(shift[axis], 0, 1e-14);
      }
    }
  }
}

// u = c z e_z is linear, satisfies m . u = 0 on the sides, is given on top and bottom, and has no
// normal derivative across the sides: with equal volumes it solves the equations (eq. 16), in any
// direction of space. The residual of 1e-12 is amplified by at most the condition number, below
// 1e2.
TEST(Walls, ALinearDisplacementAlongTheWallsIsReproduced) {
  const Eigen::Affine3d unchanged = Eigen::Affine3d::Identity();
  for (const Eigen::Affine3d& map : {unchanged, turned}) {
    const Mesh straight = box(6);
    const Moved moved = move(
        test::transformed(straight, map), "top", [](const Vec3&) { return 0.3; }, {},
        VolumeMethod::harmonic);
    const Vec3 up = map.linear() * Vec3::UnitZ();
    for (Index node = 0; node < moved.mesh.n_nodes(); ++node)
      EXPECT_NEAR((moved.shift(node) - 0.3 * straight.nodes[node].z() * up).norm(), 0, 1e-10);
  }
}

// Sides at x = 0 and 1 lean by 0.4: the rim moves along them by z (0.4, 0, 1), and so all of the
// top does, since that is what it slides by.
TEST(Walls, ARimSlidesAlongLeaningWalls) {
  Eigen::Affine3d lean = Eigen::Affine3d::Identity();
  lean.linear()(0, 2) = 0.4;
  const Mesh straight = box(6);
  const double z = 0.2;
  const Moved moved =
      move(test::transformed(straight, lean), "top", [&](const Vec3&) { return z; });
  EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
  EXPECT_LE(moved.error(), 1e-12);
  const Vec3 across = Vec3(1, 0, -0.4).normalized();
  for (Index node = 0; node < moved.mesh.n_nodes(); ++node) {
    const Vec3& x = straight.nodes[node];
    if (x.x() == 0 || x.x() == 1) {
      EXPECT_NEAR(across.dot(moved.shift(node)), 0, 1e-14);
    }
    if (x.y() == 0 || x.y() == 1) {
      EXPECT_NEAR(moved.shift(node).y(), 0, 1e-14);
    }
    if (x.z() == 1) {
      EXPECT_NEAR(moved.shift(node).z(), z, 1e-14);
    }
    if (x.z() == 1 && (x.x() == 0 || x.x() == 1)) {
      EXPECT_NEAR((moved.shift(node) - z * Vec3(0.4, 0, 1)).norm(), 0, 1e-14);
    }
  }
}

// An unselected face inside, from the bottom to the top, and one that ends in the middle of the
// box, whose upper edge keeps its line.
TEST(Walls, InnerWallsKeepTheirPlaneAndOutline) {
  Mesh mesh = box(8);
  add_group(mesh, 5, "whole", [](const Vec3& x) { return x.x() == 0.5; });
  add_group(
      mesh, 6, "part", [](const Vec3& x) { return x.y() == 0.5; },
      [](const Vec3& x) { return x.x() > 0.5 && x.x() < 0.75; });
  const Moved moved = move(mesh, "top", [](const Vec3& x) { return 0.1 * waves(x); });
  EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3 &x = mesh.nodes[node], shift = moved.shift(node);
    if (x.z() == 1) continue;
    if (x.x() == 0.5) {
      EXPECT_EQ(shift.x(), 0);
    }
    if (x.x() >= 0.5 && x.x() <= 0.75 && x.y() == 0.5) {
      EXPECT_EQ(shift.y(), 0);
    }
    if (x.x() == 0.75 && x.y() == 0.5) {
      EXPECT_EQ(shift.x(), 0);
    }
    if (x.x() == 0.5 && x.z() > 0) {
      EXPECT_NE(shift.z(), 0);
    }
  }
}

// Two groups side by side in one plane: nodes on the line between them stay on it. A line across
// the wall ends the motion: its nodes stay on it too, and so does a named point.
TEST(Walls, GroupsLinesAndPointsInAWallKeepTheirShape) {
  Mesh mesh = box(8);
  const auto is_low = [](const Vec3& x) { return x.z() <= 0.75; };
  const auto on_wall = [](const Vec3& x) { return x.x() == 0; };
  add_group(mesh, 5, "left", on_wall, [](const Vec3& x) { return x.y() < 0.25; });
  add_group(mesh, 6, "right", on_wall, [](const Vec3& x) { return x.y() > 0.25; });
  std::vector<Index> line(9, -1), point;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3& x = mesh.nodes[node];
    if (x.x() == 1 && x.z() == 0.5) line[static_cast<std::size_t>(std::lround(8 * x.y()))] = node;
    if (x == Vec3(0.5, 0, 0.75)) point.push_back(node);
  }
  std::vector<Index> lines;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    lines.insert(lines.end(), {line[i], line[i + 1]});
  mesh.blocks.push_back(test::make_block(test::line_type, 7, {7}, lines, 700'000));
  mesh.blocks.push_back(test::make_block(test::point_type, 8, {8}, point, 800'000));
  const std::vector<Vec3> flat = mesh.nodes;
  for (Vec3& x : mesh.nodes)
    if (!is_low(x)) x = hilly({{x}, {}, {}, {}, {}, {}, {}}).nodes[0];
  const Moved moved = move(mesh, "top", [](const Vec3& x) { return 0.1 * waves(x); });
  EXPECT_TRUE(check_mesh(moved.mesh, moved.nodes).valid());
  int n_on_border = 0;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3& x = flat[node];
    if (x.x() == 0 && x.y() == 0.25) {
      EXPECT_EQ(moved.shift(node).y(), 0);
      n_on_border += moved.shift(node).z() != 0;
    }
  }
  EXPECT_EQ(n_on_border, 8);  // all but the one at the bottom; one on the rim
  for (const Index node : line) EXPECT_EQ(moved.shift(node).z(), 0);
  EXPECT_NE(moved.shift(line[4]).y(), 0);
  EXPECT_EQ(moved.shift(point.front()), Vec3::Zero());
}

// The bottom stays; the other end of the line would follow the waves to its side.
TEST(Walls, ALineToANodeThatStaysKeepsItsDirection) {
  Mesh mesh = box(8);
  std::vector<Index> line;
  for (const double z : {0.0, 0.125})
    for (Index node = 0; node < mesh.n_nodes(); ++node)
      if (mesh.nodes[node] == Vec3(1, 0.375, z)) line.push_back(node);
  ASSERT_EQ(line.size(), 2);
  const auto shift_at_end = [&] {
    return move(mesh, "top", [](const Vec3& x) { return 0.1 * waves(x); }).shift(line[1]);
  };
  const auto hill = [&](Mesh& m) {
    for (Vec3& x : m.nodes)
      if (x.z() > 0.75) x = hilly({{x}, {}, {}, {}, {}, {}, {}}).nodes[0];
  };
  hill(mesh);
  EXPECT_NE(shift_at_end().y(), 0);
  mesh.blocks.push_back(test::make_block(test::line_type, 7, {7}, line, 700'000));
  EXPECT_EQ(shift_at_end().y(), 0);
  EXPECT_NE(shift_at_end().z(), 0);
}

// Beside a rough part of the top, the rest of it goes on in the same plane: it cannot slide, and
// does what it did before.
TEST(Walls, AWallThatContinuesTheSurfaceStays) {
  Mesh mesh = box(8);
  for (ElementBlock& block : mesh.blocks)
    if (block.physical_groups == std::vector<Tag>{2} && dimension(block.type.shape) == 2)
      block.physical_groups = {9};
  mesh.groups.push_back({2, 9, "plane"});
  add_group(
      mesh, 5, "part", [](const Vec3& x) { return x.z() == 1; },
      [](const Vec3& x) { return x.x() < 0.5; });
  std::erase_if(mesh.blocks, [](const ElementBlock& block) {
    return block.physical_groups == std::vector<Tag>{9};
  });
  const Moved moved = move(mesh, "part", [](const Vec3& x) { return 0.05 * waves(x); });
  EXPECT_EQ(moved.walls.torn.size(), 9U);
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3& x = mesh.nodes[node];
    if (x.z() == 1 && x.x() > 0.5) {
      EXPECT_EQ(moved.nodes[node], x);
    }
    if (x.x() == 0 || x.x() == 1) {
      EXPECT_EQ(moved.nodes[node].x(), x.x());
    }
  }
}

// Vertical facets around a disc: nodes on their edges slide along these. A twisted barrel has no
// such edges, and its rim moves as if there were no wall.
TEST(Walls, FacetedCylindersSlideAlongTheirLinesAndBarrelsStay) {
  for (const double bulge : {0.0, 0.3}) {
    const Height height = [](const Vec3& x) { return 0.05 * waves(x); };
    Mesh mesh = box(8);
    for (Vec3& x : mesh.nodes) {
      const Eigen::Vector2d square = 2 * x.head<2>() - Eigen::Vector2d::Ones();
      const double edge = square.lpNorm<Eigen::Infinity>();
      const double radius = edge * (1 + bulge * x.z() * (1 - x.z()));
      if (edge > 0)
        x.head<2>() = Eigen::Rotation2Dd(bulge * x.z()) * (radius * square.normalized());
    }
    const Moved moved = move(mesh, "top", height);
    EXPECT_EQ(moved.walls.torn.size(), bulge > 0 ? 32U : 0U);
    int n_sliding = 0;
    for (Index node = 0; node < mesh.n_nodes(); ++node) {
      const Vec3& x = mesh.nodes[node];
      if (x.head<2>().norm() < 1 - 1e-12) continue;
      if (x.z() == 1) {
        EXPECT_NEAR((moved.shift(node) - height(x) * Vec3::UnitZ()).norm(), 0, 1e-15);
        continue;
      }
      EXPECT_NEAR(moved.shift(node).head<2>().norm(), 0, 1e-15);
      n_sliding += moved.shift(node).z() != 0;
    }
    EXPECT_EQ(n_sliding, bulge > 0 ? 0 : 32 * 7);
  }
}

// Where the roughness ends before the walls, these are as before.
TEST(Walls, WallsStayWhereNoNodeOnThemMoves) {
  const Mesh mesh = box(8);
  const Surface top = select_surface(mesh, {.groups = {"top"}});
  WallOptions options;
  options.moving.assign(mesh.nodes.size(), 0);
  const Height fading = [](const Vec3& x) {
    return x.head<2>().minCoeff() == 0 || x.head<2>().maxCoeff() == 1 ? 0 : 0.1 * waves(x);
  };
  for (const Index node : top.nodes)
    if (fading(mesh.nodes[node]) != 0) options.moving[node] = 1;
  const Moved moved = move(mesh, "top", fading, options);
  EXPECT_TRUE(moved.walls.sliding.empty());
  EXPECT_TRUE(moved.walls.torn.empty());
  EXPECT_EQ(moved.nodes, move(mesh, "top", fading, {.can_slide = false}).nodes);
}

// Corners of the domain slide along the sides or stay; nodes in between as well.
TEST(Walls, SidesOfAPlanarDomainStayStraight) {
  for (const bool with_rest : {false, true}) {
    const Mesh mesh = rectangle(10, with_rest);
    const Moved moved = move(mesh, "top", [](const Vec3& x) { return 0.15 * waves(x); });
    EXPECT_TRUE(check_mesh(mesh, moved.nodes).valid());
    EXPECT_LE(moved.error(), 1e-12);
    EXPECT_TRUE(moved.walls.torn.empty());
    int n_sliding = 0;
    for (Index node = 0; node < mesh.n_nodes(); ++node) {
      const Vec3& x = mesh.nodes[node];
      EXPECT_EQ(moved.nodes[node].z(), 0);
      if (x.y() == 0) {
        EXPECT_EQ(moved.nodes[node], x);
      }
      if (x.x() != 0 && x.x() != 2) continue;
      EXPECT_EQ(moved.nodes[node].x(), x.x());
      n_sliding += x.y() < 1 && moved.nodes[node] != x;
    }
    EXPECT_EQ(n_sliding, 18);
  }
}
