// SPDX-License-Identifier: BSD-3-Clause
// Walls beside rough surfaces keep their planes and outlines, and images stay images.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/periodic.hpp"
#include "roughmesh/pipeline.hpp"
#include "roughmesh/walls.hpp"

#include "support/cells.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/process.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;

namespace {

using Height = std::function<double(const Vec3&)>;

// A surface that moves by heights, walls that follow, and the interior.
struct Moved {
  Mesh mesh;
  Surface surface;
  Walls walls;
  std::vector<Vec3> nodes;
  VolumeMethod method = VolumeMethod::none;

  double error() const { return *Enclosure(mesh).volume_error(mesh, nodes); }
  Vec3 shift(Index node) const { return nodes[node] - mesh.nodes[node]; }
};

Moved move(Mesh mesh, const char* group, const Height& height, const WallOptions& options = {},
           VolumeMethod last = VolumeMethod::split) {
  Moved moved{std::move(mesh), {}, {}, {}, {}};
  moved.surface = select_surface(moved.mesh, {.groups = {group}});
  const PeriodicPartners partners = periodic_partners(moved.mesh, moved.surface, options.period);
  moved.surface = with_partner_normals(moved.surface, partners);
  const auto surfaces = test::only(moved.surface);
  moved.walls = find_walls(moved.mesh, surfaces, options);
  std::vector<double> heights;
  for (const Index master : partners.master)
    heights.push_back(height(moved.surface.points[master]));
  std::vector<EdgeOptions> edges(1);
  edges[0].images = partners.master;
  const SurfaceMover surface_mover(
      surfaces, edges, {.fixed = {}, .sliding = sliding_on_surfaces(moved.walls, surfaces)});
  const std::vector<Vec3> displacements = surface_mover.move({&heights, 1});
  const MovedVolume volume =
      VolumeMover(moved.mesh, surfaces, moved.walls, last).move(displacements);
  EXPECT_EQ(volume.split, nullptr);
  moved.nodes = volume.nodes;
  moved.method = volume.method;
  return moved;
}

double waves(const Vec3& x) {
  return std::sin(7 * x.x() + 1) * std::cos(6 * x.y() - x.x()) + 0.3 * std::sin(5 * x.z());
}

// The box without faces in its middle, which would stay.
Mesh box(int divisions) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, divisions);
  mesh.blocks.erase(mesh.blocks.begin());
  std::erase_if(mesh.groups, [](const PhysicalGroup& group) { return group.name == "middle"; });
  return mesh;
}

// A top of hills, of period 1, whose normals lead off the sides.
Mesh hilly(Mesh mesh) {
  using std::numbers::pi;
  for (Vec3& x : mesh.nodes)
    x.z() *= 1 + 0.06 * std::sin(2 * pi * x.x() + 1) * std::cos(2 * pi * x.y() - 0.5);
  return mesh;
}

bool is_on_side(const Vec3& x) {
  return x.head<2>().minCoeff() == 0 || x.head<2>().maxCoeff() == 1;
}

const Eigen::Affine3d turned(Eigen::Translation3d(3, -2, 1) *
                             Eigen::AngleAxisd(0.7, Vec3(1, 2, 0.5).normalized()));

// Faces of the box on which `is_on` holds, as elements of a group of their own.
void add_group(
    Mesh& mesh, Tag tag, const std::string& name, const std::function<bool(const Vec3&)>& is_on,
    const std::function<bool(const Vec3&)>& is_in = [](const Vec3&) { return true; }) {
  std::vector<Index> triangles;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.shape != ElementShape::tetrahedron) continue;
    for (Index e = 0; e < block.size(); ++e)
      for (const auto& face : local_faces(ElementShape::tetrahedron)) {
        Vec3 middle = Vec3::Zero();
        bool all_on = true;
        for (const int corner : face) {
          const Vec3& x = mesh.nodes[block.element(e)[corner]];
          middle += x / 3;
          all_on = all_on && is_on(x);
        }
        if (!all_on || !is_in(middle)) continue;
        for (const int corner : face) triangles.push_back(block.element(e)[corner]);
      }
  }
  mesh.blocks.push_back(
      test::make_block(test::triangle_type, tag, {tag}, std::move(triangles), 100'000 * tag));
  mesh.groups.push_back({2, tag, name});
}

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

// The box as a periodic cell: links of the sides x = 1 and y = 1 to those at 0, for the corners to
// both.
Mesh periodic_box(int divisions) {
  Mesh mesh = box(divisions);
  std::map<std::array<long, 3>, Index> node_at;
  const auto key = [&](const Vec3& x) {
    return std::array{std::lround(x.x() * divisions), std::lround(x.y() * divisions),
                      std::lround(x.z() * divisions)};
  };
  for (Index node = 0; node < mesh.n_nodes(); ++node) node_at[key(mesh.nodes[node])] = node;
  for (const int axis : {0, 1}) {
    PeriodicLink link{2, 100 + axis, 200 + axis, {}, {}};
    for (const auto& [at, node] : node_at) {
      auto of_master = at;
      if (std::exchange(of_master[static_cast<std::size_t>(axis)], 0) == divisions)
        link.nodes.emplace_back(node, node_at[of_master]);
    }
    mesh.periodic_links.push_back(std::move(link));
  }
  return mesh;
}

// Of period 1 along x and y.
double periodic_waves(const Vec3& x) {
  using std::numbers::pi;
  return std::sin(2 * pi * x.x() + 1) * std::cos(2 * pi * x.y()) + 0.4 * std::cos(4 * pi * x.x());
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

// Images move by the same vector, on the surface, in the sides, and after the foldover-free map;
// differences of coordinates are those of the input but for one rounding of a number below 2.
TEST(Walls, ImagesStayImages) {
  const Mesh mesh = hilly(periodic_box(8));
  for (const double height : {0.03, 0.17}) {
    const Moved moved =
        move(mesh, "top", [&](const Vec3& x) { return height * periodic_waves(x); });
    EXPECT_TRUE(check_mesh(mesh, moved.nodes).valid());
    EXPECT_EQ(moved.method, height > 0.1 ? VolumeMethod::foldover_free : VolumeMethod::harmonic);
    int n_moved = 0;
    for (const PeriodicLink& link : mesh.periodic_links)
      for (const auto& [slave, master] : link.nodes) {
        const Vec3 apart = moved.nodes[slave] - moved.nodes[master];
        const Vec3 before = mesh.nodes[slave] - mesh.nodes[master];
        EXPECT_LE((apart - before).cwiseAbs().maxCoeff(), 0x1p-52);
        n_moved += moved.nodes[slave] != mesh.nodes[slave];
      }
    EXPECT_EQ(n_moved, 2 * 9 * 8);
  }
}

// Without links, but with a period, nodes at equal positions modulo the period are images.
TEST(Walls, APeriodJoinsNodesByPosition) {
  Mesh mesh = periodic_box(8);
  const Height height = [](const Vec3& x) { return 0.1 * periodic_waves(x); };
  const Moved linked = move(mesh, "top", height);
  mesh.periodic_links.clear();
  const Moved placed = move(mesh, "top", height, {.period = Vec3(1, 1, 0)});
  EXPECT_EQ(placed.nodes, linked.nodes);
  EXPECT_NE(move(mesh, "top", height).nodes, linked.nodes);
}

// A node linked by a rotation has no displacement that its image could share: both stay.
TEST(Walls, NodesLinkedByRotationsStay) {
  Mesh mesh = box(8);
  PeriodicLink link{2, 1, 2, {}, {}};  // the side x = 0 is the side y = 0 turned about the z axis
  for (Index a = 0; a < mesh.n_nodes(); ++a)
    for (Index b = 0; b < mesh.n_nodes(); ++b) {
      const Vec3 &x = mesh.nodes[a], &y = mesh.nodes[b];
      if (x.x() == 0 && y.y() == 0 && x.y() == y.x() && x.z() == y.z() && x.z() < 1)
        link.nodes.emplace_back(a, b);
    }
  ASSERT_EQ(link.nodes.size(), 72U);
  mesh.periodic_links = {link};
  const Moved moved = move(mesh, "top", [](const Vec3& x) { return 0.03 * waves(x); });
  for (const auto& [slave, master] : link.nodes) {
    EXPECT_EQ(moved.nodes[slave], mesh.nodes[slave]);
    EXPECT_EQ(moved.nodes[master], mesh.nodes[master]);
  }
}

namespace {

// Sixty degrees around the z axis, between the radii 1 and 2, whose ends "first" and "last" are
// linked by a rotation.
Mesh sector(int divisions) {
  using std::numbers::pi;
  Mesh mesh = box(divisions);
  add_group(mesh, 5, "first", [](const Vec3& x) { return x.x() == 0; });
  add_group(mesh, 6, "last", [](const Vec3& x) { return x.x() == 1; });
  const double c = 0.5, d = std::sqrt(0.75);
  PeriodicLink link{2, 6, 5, {c, d, 0, 0, -d, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {}};
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (mesh.nodes[node].x() == 1) link.nodes.emplace_back(node, node - divisions);
  mesh.periodic_links = {link};
  for (Vec3& x : mesh.nodes) {
    const double angle = -pi / 3 * x.x(), radius = 1 + x.y();
    x = Vec3(radius * std::cos(angle), radius * std::sin(angle), x.z());
  }
  return mesh;
}

// Rough up to both ends, the roughness cannot be; where it fades before, ends stay images.
void expect_sector(const Mesh& mesh, RoughenOptions options, const std::vector<std::string>& fade) {
  const auto run = [&](const Deliver& deliver) { roughen(mesh, options, deliver); };
  EXPECT_THROW(run([](const RoughMesh&, Report&) {}), InputError);
  options.surfaces[0].fade = fade;
  run([&](const RoughMesh& rough, Report&) {
    EXPECT_NE(rough.mesh.nodes, mesh.nodes);
    EXPECT_TRUE(rough.check.valid());
    for (const PeriodicLink& link : mesh.periodic_links) {
      const Eigen::Affine3d to_slave(
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(link.affine.data()));
      for (const auto& [slave, master] : link.nodes)
        EXPECT_NEAR((rough.mesh.nodes[slave] - to_slave * rough.mesh.nodes[master]).norm(), 0,
                    1e-14);
    }
  });
}

}  // namespace

TEST(Walls, EndsOfASectorStayImagesWhereTheRoughnessFades) {
  RoughenOptions options;
  options.surfaces[0].group = {"top"};
  options.surfaces[0].rms = 0.05;
  options.surfaces[0].length = {0.4};
  expect_sector(sector(8), options, {"0.3:first", "0.3:last"});
}

// A file of other people, whose elements of order 3 are taken at their corners.
TEST(Walls, ASectorOfATorusStaysOne) {
  const char* data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  Mesh mesh = read_mesh(std::filesystem::path(data) / "meshes/periodic-torus-sector.msh");
  for (ElementBlock& block : mesh.blocks) {
    ElementBlock corners = block;
    corners.type = test::first_order(block.type.shape);
    corners.nodes.clear();
    for (Index e = 0; e < block.size(); ++e)
      for (int k = 0; k < corners.type.n_nodes; ++k)
        corners.nodes.push_back(block.element(e)[static_cast<std::size_t>(k)]);
    block = std::move(corners);
  }
  ASSERT_EQ(mesh.periodic_links.size(), 5U);
  RoughenOptions options;
  options.surfaces[0].group = {"3"};
  options.surfaces[0].rms = 0.02;
  options.surfaces[0].length = {1};
  expect_sector(mesh, options, {"0.5:1", "0.5:2"});
}

// ---- Meshes of gmsh ----

namespace {

constexpr const char* slab_script =
    "SetFactory(\"OpenCASCADE\"); h = 0.08; Box(1) = {0, 0, 0, 1, 1, 0.5};\n"
    "Mesh.CharacteristicLengthMin = h; Mesh.CharacteristicLengthMax = h;\n"
    "Physical Surface(\"top\", 1) = {6}; Physical Surface(\"sides\", 2) = {1:4};\n"
    "Physical Surface(\"bottom\", 3) = {5}; Physical Volume(\"slab\", 1) = {1};\n";

Mesh gmsh_slab(const std::string& options, const std::string& more = "") {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "slab.geo", slab_script + more);
  EXPECT_EQ(test::run_in(folder, "gmsh -3 slab.geo -v 1 -o slab.msh " + options).exit_code, 0);
  return read_mesh(folder / "slab.msh");
}

RoughenOptions slab_options(double rms, double length) {
  RoughenOptions options;
  options.surfaces = {Roughness{}};
  options.surfaces[0].group = {"top"};
  options.surfaces[0].rms = rms;
  options.surfaces[0].length = {length};
  return options;
}

}  // namespace

// Rq/h = 0.7 and l = 1.77 h, where every slab with walls that stay has inverted elements.
TEST(Walls, TenRoughSlabsAreValidWithPlaneWalls) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh = gmsh_slab("-format msh41");
  RoughenOptions options = slab_options(0.7 * 0.08, 1.77 * 0.08);
  const Enclosure enclosure(mesh);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    options.surfaces[0].seed = seed;
    const Report report = roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
      EXPECT_TRUE(rough.surface_check.valid());
      EXPECT_TRUE(rough.check.valid());
      EXPECT_LE(enclosure.volume_error(rough.mesh, rough.mesh.nodes), 1e-12);
      for (Index node = 0; node < mesh.n_nodes(); ++node) {
        const Vec3& x = mesh.nodes[node];
        for (const int axis : {0, 1})
          if (x[axis] == 0 || x[axis] == 1) {
            EXPECT_EQ(rough.mesh.nodes[node][axis], x[axis]);
          }
        if (x.z() == 0) {
          EXPECT_EQ(rough.mesh.nodes[node], x);
        }
      }
    });
    for (const std::string& warning : report.warnings)
      EXPECT_EQ(warning.find("cannot slide"), warning.npos) << warning;
  }
}

// Partitions, with faces between them and ghosts, change no coordinate: the same mesh becomes the
// same rough mesh.
TEST(Walls, PartitionsChangeNothing) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const auto rough_nodes = [](const Mesh& mesh, const char* group) {
    RoughenOptions options = slab_options(0.04, 0.15);
    options.surfaces[0].group = {group};
    std::vector<Vec3> nodes;
    roughen(mesh, options, [&](const RoughMesh& rough, Report&) { nodes = rough.mesh.nodes; });
    return nodes;
  };
  const Mesh whole = gmsh_slab("-format msh41");
  for (const char* format : {"msh41", "msh22"})
    for (const char* ghosts : {"", " -part_ghosts"}) {
      SCOPED_TRACE(std::string(format) + ghosts);
      const Mesh parts = gmsh_slab(std::string("-part 3 -format ") + format + ghosts);
      ASSERT_EQ(parts.n_nodes(), whole.n_nodes());
      EXPECT_EQ(n_elements(parts, 3), n_elements(whole, 3));
      for (const char* group : {"top", "all"}) {
        std::map<std::array<double, 3>, Vec3> rough_of;
        const std::vector<Vec3> expected = rough_nodes(whole, group);
        for (Index node = 0; node < whole.n_nodes(); ++node) {
          const Vec3& x = whole.nodes[node];
          rough_of[{x.x(), x.y(), x.z()}] = expected[node];
        }
        const std::vector<Vec3> nodes = rough_nodes(parts, group);
        for (Index node = 0; node < parts.n_nodes(); ++node) {
          const Vec3& x = parts.nodes[node];
          EXPECT_NEAR((nodes[node] - rough_of[{x.x(), x.y(), x.z()}]).norm(), 0, 1e-10);
        }
      }
    }
}

// The links of gmsh, with the transformations that it writes: slaves are where these put them.
TEST(Walls, ImagesOfAGmshCellStayImages) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh = gmsh_slab("-format msh41",
                              "Periodic Surface {2} = {1} Translate {1, 0, 0};\n"
                              "Periodic Surface {4} = {3} Translate {0, 1, 0};\n");
  ASSERT_GT(mesh.periodic_links.size(), 1U);
  RoughenOptions options = slab_options(0.056, 0.2);
  options.realizations = 3;
  roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
    EXPECT_TRUE(rough.check.valid());
    for (const PeriodicLink& link : mesh.periodic_links)
      for (const auto& [slave, master] : link.nodes)
        EXPECT_LE(((rough.mesh.nodes[slave] - rough.mesh.nodes[master]) -
                   (mesh.nodes[slave] - mesh.nodes[master]))
                      .cwiseAbs()
                      .maxCoeff(),
                  0x1p-52);
  });
}
