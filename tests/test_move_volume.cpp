// SPDX-License-Identifier: BSD-3-Clause
// The interior follows the surface.
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"

#include "parallel.hpp"
#include "support/cells.hpp"
#include "support/contact.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"

using namespace roughmesh;

namespace {

constexpr std::array volume_shapes = {ElementShape::tetrahedron, ElementShape::hexahedron,
                                      ElementShape::prism, ElementShape::pyramid};

Surface ball(const Mesh& mesh) { return select_surface(mesh, {.groups = {"surface"}}); }

std::vector<double> bumps(const Surface& surface, double size) {
  std::vector<double> heights;
  for (const Vec3& x : surface.points)
    heights.push_back(size * std::sin(7 * x.x() + 1) * std::cos(5 * x.y() - 6 * x.z()));
  return heights;
}

std::vector<Vec3> constant(const Surface& surface, const Vec3& value) {
  return std::vector<Vec3>(surface.points.size(), value);
}

bool on_box(const Vec3& x) { return x.lpNorm<Eigen::Infinity>() > 1 - 1e-12; }

// sum over tetrahedra of 1/V * integral |grad u|^2 = sum |grad u|^2, from the definition: grad u
// solves the three differences of u along edges.
double energy(const Mesh& mesh, const std::vector<Vec3>& displacements) {
  double sum = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.shape != ElementShape::tetrahedron) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto t = block.element(e);
      Eigen::Matrix3d edges, differences;
      for (int k = 0; k < 3; ++k) {
        edges.col(k) = mesh.nodes[t[k + 1]] - mesh.nodes[t[0]];
        differences.col(k) = displacements[t[k + 1]] - displacements[t[0]];
      }
      sum += (differences * edges.inverse()).squaredNorm();
    }
  }
  return sum;
}

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> result(a);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] -= b[i];
  return result;
}

}  // namespace

TEST(MoveVolume, ZeroDisplacementChangesNoBit) {
  for (const Mesh& mesh : {test::ball_in_box(8), test::icosphere(2)}) {
    const Surface surface = ball(mesh);
    EXPECT_EQ(VolumeMover(mesh, test::only(surface))
                  .move(test::at_nodes(surface, constant(surface, Vec3::Zero())))
                  .nodes,
              mesh.nodes);
  }
}

TEST(MoveVolume, SurfaceNodesMoveAsToldAndOuterNodesStay) {
  const Mesh mesh = test::shuffled(test::ball_in_box(8), 4);
  const Surface surface = ball(mesh);
  const std::vector<Vec3> displacements = displace(surface, bumps(surface, 0.03));
  const VolumeMover mover(mesh, test::only(surface));
  EXPECT_TRUE(mover.moves_interior());
  EXPECT_EQ(mover.wall_nodes().size(), 0U);
  const std::vector<Vec3> moved = mover.move(test::at_nodes(surface, displacements)).nodes;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    EXPECT_EQ(moved[surface.nodes[i]],
              mesh.nodes[surface.nodes[i]] + displacements[surface.point_of_node[i]]);
  const std::set<Index> on_surface(surface.nodes.begin(), surface.nodes.end());
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    if (on_box(mesh.nodes[node])) {
      EXPECT_EQ(moved[node], mesh.nodes[node]);
    } else if (!on_surface.contains(node)) {
      EXPECT_NE(moved[node], mesh.nodes[node]);
    }
  }
}

// All interior volumes depend on the interface alone, the sum on nothing. Each of 3,072 volumes is
// rounded to 1e-16 of the cube of its coordinates.
TEST(MoveVolume, VolumesAreThoseOfTheMovedSurface) {
  const Mesh mesh = test::ball_in_box(8);
  const Surface surface = ball(mesh);
  const VolumeMover mover(mesh, test::only(surface));
  const std::vector<Vec3> displacements = displace(surface, bumps(surface, 0.03));
  const std::vector<Vec3> moved = mover.move(test::at_nodes(surface, displacements)).nodes;
  EXPECT_NEAR(test::tetrahedron_volume(mesh, moved), 8, 1e-12);
  EXPECT_NEAR(test::tetrahedron_volume(mesh, moved, 1),
              enclosed_volume(surface, moved_points(surface, displacements)), 1e-12);

  const std::vector<double> up(surface.points.size(), 0.02);
  const std::vector<Vec3> grown = mover.move(test::at_nodes(surface, displace(surface, up))).nodes;
  EXPECT_GT(test::tetrahedron_volume(mesh, grown, 1),
            test::tetrahedron_volume(mesh, mesh.nodes, 1));
  EXPECT_NEAR(test::tetrahedron_volume(mesh, grown), 8, 1e-12);
}

// The gradient of a constant is zero on every tetrahedron, so that constants are solutions. The
// residual of 1e-12 is amplified by at most the condition number, below 1e2 here.
TEST(MoveVolume, ConstantsAreReproduced) {
  for (const ElementShape shape : volume_shapes) {
    const Mesh mesh = test::without_faces(test::cell_box(shape, 4));
    const Surface boundary = select_surface(mesh);
    const Vec3 shift(0.3, -0.2, 0.1);
    const VolumeMover mover(mesh, test::only(boundary));
    EXPECT_EQ(mover.wall_nodes().size(), 0U);
    const std::vector<Vec3> moved =
        mover.move(test::at_nodes(boundary, constant(boundary, shift))).nodes;
    for (Index node = 0; node < mesh.n_nodes(); ++node)
      EXPECT_NEAR((moved[node] - mesh.nodes[node] - shift).norm(), 0, 1e-10);
  }
}

// With equal volumes the weights are equal and the equations those of linear elements for the
// Laplace equation, which linear functions solve. (Where volumes differ they do not: the weight
// jumps from one tetrahedron to the next.)
TEST(MoveVolume, LinearFieldsAreReproducedWhereVolumesAreEqual) {
  const Mesh mesh = test::without_faces(test::cell_box(ElementShape::tetrahedron, 4));
  const Surface boundary = select_surface(mesh);
  Eigen::Matrix3d gradient;
  gradient << 0.1, 0.2, -0.1, 0.05, -0.15, 0.1, 0.0, 0.2, 0.1;
  std::vector<Vec3> displacements;
  for (const Vec3& x : boundary.points) displacements.push_back(gradient * x);
  const std::vector<Vec3> moved =
      VolumeMover(mesh, test::only(boundary)).move(test::at_nodes(boundary, displacements)).nodes;
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_NEAR((moved[node] - mesh.nodes[node] - gradient * mesh.nodes[node]).norm(), 0, 1e-10);
}

// E is quadratic, so at its minimum u and for v that vanishes where u is given, Pythagoras holds:
// E(u + v) = E(u) + E(v). A wrong weight, sign or node breaks it at first order.
TEST(MoveVolume, TheDisplacementMinimizesTheWeightedEnergy) {
  const Mesh mesh = test::ball_in_box(8);
  const Surface surface = ball(mesh);
  const std::vector<Vec3> moved =
      VolumeMover(mesh, test::only(surface), VolumeMethod::harmonic)
          .move(test::at_nodes(surface, displace(surface, bumps(surface, 0.05))))
          .nodes;
  const std::vector<Vec3> u = difference(moved, mesh.nodes);
  const std::set<Index> on_surface(surface.nodes.begin(), surface.nodes.end());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  std::vector<Vec3> v(u.size(), Vec3::Zero()), sum(u);
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    if (on_box(mesh.nodes[node]) || on_surface.contains(node)) continue;
    v[node] = Vec3(uniform(random), uniform(random), uniform(random));
    sum[node] += v[node];
  }
  const double eu = energy(mesh, u), ev = energy(mesh, v);
  EXPECT_NEAR(energy(mesh, sum), eu + ev, 1e-9 * (eu + ev));
}

// The top sinks by more than the size of a cell, which the cells below it share.
TEST(MoveVolume, EveryShapeMovesWithItsTop) {
  for (const ElementShape shape : volume_shapes) {
    const Mesh mesh = test::cell_box(shape, 6);
    const Surface top = select_surface(mesh, {.groups = {"top"}});
    std::vector<Vec3> displacements;
    for (const Vec3& x : top.points)
      displacements.emplace_back(0, 0, -3.2 * x.x() * (1 - x.x()) * x.y() * (1 - x.y()));
    const std::vector<Vec3> moved =
        VolumeMover(mesh, test::only(top)).move(test::at_nodes(top, displacements)).nodes;
    EXPECT_TRUE(check_mesh(mesh, moved).valid()) << name(mesh.blocks[2].type);
    std::vector<Vec3> top_only = mesh.nodes;
    for (Index node = 0; node < mesh.n_nodes(); ++node) {
      const Vec3& x = mesh.nodes[node];
      if (x.z() == 1) top_only[node] = moved[node];
      // Nodes of the walls, of the unselected faces between the volumes and below them stay.
      const bool is_free = x.x() > 0 && x.x() < 1 && x.y() > 0 && x.y() < 1 && x.z() > 0.5;
      EXPECT_EQ(moved[node].z() < x.z(), is_free);
    }
    EXPECT_FALSE(check_mesh(mesh, top_only).valid());
  }
}

// The rim of the top lies on the four walls, whether these are elements or only the boundary.
TEST(MoveVolume, WallNodesAreCounted) {
  Mesh mesh = test::cell_box(ElementShape::hexahedron, 4);
  const Surface top = select_surface(mesh, {.groups = {"top"}});
  EXPECT_EQ(VolumeMover(mesh, test::only(top)).wall_nodes().size(), 16U);
  const Surface middle = select_surface(mesh, {.groups = {"middle"}});
  EXPECT_EQ(VolumeMover(mesh, test::only(middle)).wall_nodes().size(), 16U);
  const Mesh plate = test::plate(4);
  EXPECT_EQ(VolumeMover(plate, test::only(select_surface(plate))).wall_nodes().size(), 0U);
}

// Volumes on either side of a crack have nodes of their own at equal positions.
TEST(MoveVolume, BothSidesOfACrackMoveTogether) {
  Mesh mesh = test::ball_in_box(8);
  test::detach(mesh, 3, 0);
  const Surface surface = select_surface(mesh, {.groups = {"surface", "far side"}});
  const std::vector<Vec3> moved =
      VolumeMover(mesh, test::only(surface))
          .move(test::at_nodes(surface, displace(surface, bumps(surface, 0.03))))
          .nodes;
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
  EXPECT_NEAR(test::tetrahedron_volume(mesh, moved), 8, 1e-11);
}

// What makes an initial gap: the far side stays, and with it the whole body behind.
TEST(MoveVolume, OneSideOfAContactMovesAlone) {
  for (const ElementShape shape : volume_shapes) {
    Mesh mesh = test::cell_box(shape, 4);
    test::detach(mesh, 3, 0);
    const ElementBlock &lower = mesh.blocks[2], &upper = mesh.blocks[3];
    const Surface surface = select_surface(mesh, {.groups = {"middle"}});
    const VolumeMover mover(mesh, test::only(surface));
    EXPECT_EQ(mover.wall_nodes().size(), 16U);  // the rim lies on the sides of the lower body
    const std::vector<Vec3> moved =
        mover.move(test::at_nodes(surface, constant(surface, Vec3(0.01, 0, -0.05)))).nodes;
    EXPECT_TRUE(check_mesh(mesh, moved).valid());
    for (const Index node : upper.nodes) EXPECT_EQ(moved[node], mesh.nodes[node]);
    for (const Index node : lower.nodes) {
      const Vec3& x = mesh.nodes[node];
      const bool is_inner = x.x() > 0 && x.x() < 1 && x.y() > 0 && x.y() < 1 && x.z() > 0;
      EXPECT_EQ(moved[node].z() < x.z(), is_inner || x.z() == 0.5);
    }
  }
}

// Files list an element once per group that it is in.
TEST(MoveVolume, TheBoundaryOfRepeatedElementsStays) {
  for (const ElementShape shape : volume_shapes) {
    Mesh mesh = test::cell_box(shape, 4);
    ElementBlock again = mesh.blocks[3];
    for (Index e = 0; shape == ElementShape::tetrahedron && e < again.size(); ++e)
      test::turn_element(again, e);  // the same corners, in another order
    mesh.blocks.push_back(again);
    const Surface top = select_surface(mesh, {.groups = {"top"}});
    const VolumeMover mover(mesh, test::only(top));
    EXPECT_EQ(mover.wall_nodes().size(), 16U);
    const std::vector<Vec3> moved =
        mover.move(test::at_nodes(top, constant(top, Vec3(0, 0, -0.05)))).nodes;
    for (Index node = 0; node < mesh.n_nodes(); ++node) {
      const Vec3& x = mesh.nodes[node];
      const bool is_inner = x.x() > 0 && x.x() < 1 && x.y() > 0 && x.y() < 1 && x.z() > 0.5;
      EXPECT_EQ(moved[node] != x, is_inner || x.z() == 1);
    }
    EXPECT_EQ(select_surface(test::without_faces(mesh)).n_border_edges, 0);
  }
}

TEST(MoveVolume, ASurfaceMeshMovesItsSurfaceOnly) {
  Mesh mesh = test::plate(4);
  const std::vector<Index> all = mesh.blocks[0].nodes;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  mesh.blocks = {test::make_block(test::triangle_type, 1, {1}, {all.begin(), middle}, 1),
                 test::make_block(test::triangle_type, 2, {2}, {middle, all.end()}, 101)};
  mesh.groups.push_back({2, 2, "rest"});
  const Surface surface = ball(mesh);
  const VolumeMover mover(mesh, test::only(surface));
  EXPECT_FALSE(mover.moves_interior());
  EXPECT_EQ(mover.wall_nodes().size(), 5U);
  const std::vector<Vec3> moved =
      mover.move(test::at_nodes(surface, constant(surface, Vec3::UnitZ()))).nodes;
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_EQ(moved[node].z(), mesh.nodes[node].y() <= 0.5 ? 1 : 0);
}

TEST(MoveVolume, OnDemandTheInteriorStays) {
  const Mesh mesh = test::ball_in_box(8);
  const Surface surface = ball(mesh);
  const VolumeMover mover(mesh, test::only(surface), VolumeMethod::none);
  EXPECT_FALSE(mover.moves_interior());
  const std::vector<Vec3> moved =
      mover.move(test::at_nodes(surface, constant(surface, Vec3::UnitX()))).nodes;
  const std::set<Index> on_surface(surface.nodes.begin(), surface.nodes.end());
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_EQ(moved[node], mesh.nodes[node] + Vec3(on_surface.contains(node) ? 1 : 0, 0, 0));
}

// Flat elements have no weight 1 / V; a node in nothing else has no equation and stays.
TEST(MoveVolume, FlatElementsDoNoHarm) {
  Mesh mesh = test::ball_in_box(8);
  const Index a = mesh.n_nodes();
  mesh.nodes.emplace_back(0.7, 0.7, 0.7);
  test::number_nodes(mesh);
  auto& block = mesh.blocks[3];
  const Index inner = block.nodes[0];
  block.nodes.insert(block.nodes.end(), {inner, inner, block.nodes[1], a});
  block.tags.push_back(99999);
  const Surface surface = ball(mesh);
  const std::vector<Vec3> moved =
      VolumeMover(mesh, test::only(surface))
          .move(test::at_nodes(surface, displace(surface, bumps(surface, 0.03))))
          .nodes;
  for (const Vec3& x : moved) EXPECT_TRUE(x.allFinite());
  EXPECT_EQ(moved[a], mesh.nodes[a]);
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
}

TEST(MoveVolume, DoesNotDependOnTheNumberOfThreads) {
  const Mesh mesh = test::ball_in_box(16);  // several ranges of rows
  const Surface surface = ball(mesh);
  const std::vector<Vec3> displacements = displace(surface, bumps(surface, 0.02));
  const auto run = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return VolumeMover(mesh, test::only(surface))
        .move(test::at_nodes(surface, displacements))
        .nodes;
  };
  EXPECT_EQ(run(1), run(2));
}

// Powers of two change exponents only: not even the number of iterations.
TEST(MoveVolume, ScalingBy1024IsExact) {
  const Mesh mesh = test::ball_in_box(8);
  const Mesh large = test::transformed(mesh, Eigen::Affine3d(Eigen::Scaling(1024.0)));
  const auto run = [](const Mesh& m, double size) {
    const Surface surface = ball(m);
    return VolumeMover(m, test::only(surface))
        .move(test::at_nodes(surface,
                             displace(surface, std::vector<double>(surface.points.size(), size))))
        .nodes;
  };
  const std::vector<Vec3> a = run(mesh, 0.05), b = run(large, 0.05 * 1024);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(b[i], 1024 * a[i]);
}

TEST(MoveVolume, ElementsOfHigherOrderAreRefusedWhereTheyWouldMove) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const Mesh linear = mesh;
  const auto add_cubic = [&](Index corner) {
    mesh = linear;
    std::vector<Index> nodes = {corner};
    for (int i = 1; i < 20; ++i) {
      nodes.push_back(mesh.n_nodes());
      mesh.nodes.emplace_back(2 + i, i * i, i % 3);
    }
    mesh.blocks.push_back(test::make_block({ElementShape::tetrahedron, 3, 20}, 3, {}, nodes, 777));
    test::number_nodes(mesh);
  };
  add_cubic(0);  // at the bottom, which stays
  const Surface top = select_surface(mesh, {.groups = {"top"}});
  EXPECT_TRUE(VolumeMover(mesh, test::only(top)).moves_interior());
  add_cubic(top.nodes.front());
  try {
    const VolumeMover mover(mesh, test::only(top));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 777 is a tetrahedron of order 3"),
              std::string::npos);
    EXPECT_NE(std::string(error.what()).find("-order 1"), std::string::npos);
  }
}

// Both surfaces move, what lies between follows both, and a wall is what neither has.
TEST(MoveVolume, SeveralSurfacesMoveAtOnce) {
  const Mesh mesh = test::cell_box(ElementShape::prism, 4);
  const std::vector<Surface> surfaces = {select_surface(mesh, {.groups = {"top"}}),
                                         select_surface(mesh, {.groups = {"middle"}})};
  const VolumeMover mover(mesh, surfaces);
  EXPECT_EQ(mover.wall_nodes().size(), 32U);
  const std::vector<std::vector<double>> heights = {std::vector<double>(25, 0.05),
                                                    std::vector<double>(25, -0.05)};
  const std::vector<Vec3> moved = mover.move(displace_nodes(surfaces, heights)).nodes;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Vec3& x = mesh.nodes[node];
    const bool is_inside = x.x() > 0 && x.x() < 1 && x.y() > 0 && x.y() < 1;
    const double shift = moved[node].z() - x.z();
    if (x.z() == 1 || x.z() == 0.5) {
      EXPECT_NEAR(shift, x.z() == 1 ? 0.05 : -0.05, 1e-15);
    } else if (is_inside && x.z() < 0.5 && x.z() > 0) {
      EXPECT_LT(shift, 0);
    }
  }
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
}

// Together the interface and the box have no wall; apart they are what one selection of both is.
TEST(MoveVolume, TwoSurfacesAreLikeOneOfBoth) {
  const Mesh mesh = test::ball_in_box(8);
  const std::vector<Surface> apart = {select_surface(mesh, {.groups = {"surface"}}),
                                      select_surface(mesh, {.groups = {"outer"}})};
  const Surface together = select_surface(mesh, {.groups = {"surface", "outer"}});
  const VolumeMover mover(mesh, apart);
  EXPECT_EQ(mover.wall_nodes().size(), 0U);
  EXPECT_EQ(moved_nodes(apart), together.nodes);
  std::vector<Vec3> told;
  for (const Index node : together.nodes)
    told.push_back(0.01 * Vec3(std::sin(5 * mesh.nodes[node].y()), 1, 0));
  EXPECT_EQ(mover.move(told).nodes, VolumeMover(mesh, test::only(together)).move(told).nodes);
}

TEST(MoveVolume, AFaceInTwoSurfacesIsRefused) {
  Mesh mesh = test::ball_in_box(4);
  const auto message = [&](std::vector<std::string> a, std::vector<std::string> b) -> std::string {
    const std::vector<Surface> surfaces = {select_surface(mesh, {.groups = std::move(a)}),
                                           select_surface(mesh, {.groups = std::move(b)})};
    try {
      const VolumeMover mover(mesh, surfaces);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({"surface"}, {"outer"}), "accepted");
  EXPECT_EQ(message({"surface"}, {"outer", "surface"}).find("element 1 at"), 0u);
  EXPECT_EQ(message({"outer"}, {"outer"}).find("element 49 at"), 0u);
  mesh = test::without_faces(mesh);
  EXPECT_EQ(message({}, {}).find("a face of the boundary at"), 0u);
}

// Elements behind a wall have no part in the system: cubic ones there do not matter.
TEST(MoveVolume, BehindUnselectedFacesNothingMoves) {
  const Mesh mesh = test::ball_in_box(8);
  const Surface outer = select_surface(mesh, {.groups = {"outer"}});
  const std::vector<Vec3> moved =
      VolumeMover(mesh, test::only(outer))
          .move(test::at_nodes(outer, constant(outer, Vec3(0.01, 0, 0))))
          .nodes;
  const std::set<Index> inside(mesh.blocks[2].nodes.begin(), mesh.blocks[2].nodes.end());
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_EQ(moved[node] == mesh.nodes[node], inside.contains(node));
}

TEST(MoveVolume, NonsenseIsRefused) {
  const Mesh mesh = test::ball_in_box(4);
  const Surface surface = ball(mesh);
  const VolumeMover mover(mesh, test::only(surface));
  EXPECT_THROW(mover.move({}), InputError);
  EXPECT_THROW(VolumeMover(mesh, {}), InputError);
  const Mesh other = test::plate(1);
  EXPECT_THROW(VolumeMover(other, test::only(surface)), InputError);
  std::vector<Vec3> displacements = constant(surface, Vec3::Zero());
  displacements[3].x() = std::nan("");
  EXPECT_THROW(mover.move(test::at_nodes(surface, displacements)), InputError);
  // The square of the load overflows, and no residual is small beside infinity.
  EXPECT_THROW(mover.move(test::at_nodes(surface, constant(surface, Vec3::Constant(1e200)))),
               NumericalError);
}
