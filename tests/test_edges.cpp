// SPDX-License-Identifier: BSD-3-Clause
// Sharp edges and corners: every face keeps its height up to its rim, and none folds.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/pipeline.hpp"

#include "edge_taper.hpp"
#include "least_displacement.hpp"
#include "support/blocks.hpp"
#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;

namespace {

constexpr double pi = std::numbers::pi;
using test::cube;
using test::cylinder;
using test::l_block;
using test::leaning;
using test::mapped;

SurfaceOptions everything() { return {.groups = {"all"}}; }

std::vector<double> constant(const Surface& surface, double height) {
  return std::vector<double>(surface.points.size(), height);
}

std::vector<double> heights_at(const Surface& surface, const std::function<double(Vec3)>& f) {
  std::vector<double> heights;
  for (const Vec3& x : surface.points) heights.push_back(f(x));
  return heights;
}

double bumps(const Vec3& x) { return 0.05 * std::sin(9 * x.x() + 7 * x.y() - 8 * x.z() + 1); }

/// Displacements of points; nodes are distinct here.
std::vector<Vec3> move(const Surface& surface, const std::vector<double>& heights,
                       EdgeRule rule = EdgeRule::offset) {
  const EdgeOptions options{.rule = rule};
  const std::vector<Vec3> u =
      SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1}).displacements;
  std::vector<Vec3> at_points(surface.points.size());
  for (std::size_t i = 0; i < u.size(); ++i) at_points[surface.point_of_node[i]] = u[i];
  return at_points;
}

Vec3 normal_of(const Surface& surface, Index face, const std::vector<Vec3>& positions) {
  std::vector<Vec3> corners;
  for (const Index point : surface.face(face)) corners.push_back(positions[point]);
  return area_vector(corners);
}

/// Largest difference between the heights and what the corners of all faces move by across them.
double largest_miss(const Surface& surface, const std::vector<double>& heights,
                    const std::vector<Vec3>& u) {
  double largest = 0;
  for (Index f = 0; f < surface.n_faces(); ++f)
    for (const Index point : surface.face(f))
      largest = std::max(largest,
                         std::abs(normal_of(surface, f, surface.points).normalized().dot(u[point]) -
                                  heights[point]));
  return largest;
}

/// Smallest area of a moved face, seen along its normal, over its area before.
double smallest_face(const Surface& surface, const std::vector<Vec3>& u) {
  double smallest = 1e300;
  const std::vector<Vec3> moved = moved_points(surface, u);
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const Vec3 before = normal_of(surface, f, surface.points);
    smallest = std::min(smallest, normal_of(surface, f, moved).dot(before) / before.squaredNorm());
  }
  return smallest;
}

/// Round-off of some thousand operations on numbers of size 1.
constexpr double round_off = 1e-12;

}  // namespace

// Each plane moves by d: the body between them is the exact offset of the polyhedron.
TEST(Edges, AConstantHeightMovesEveryPlaneByIt) {
  const int n = 6;
  for (const Mesh& mesh : {cube(n), l_block(n), leaning(n, pi / 3)})
    for (const double d : {0.3, -0.05}) {
      const Surface surface = select_surface(mesh, everything());
      const std::vector<double> heights = constant(surface, d);
      EXPECT_LT(largest_miss(surface, heights, move(surface, heights)), round_off);
    }
}

TEST(Edges, TheOffsetCubeHasTheRightSide) {
  const Surface surface = select_surface(cube(5), everything());
  for (const double d : {0.4, -0.1}) {
    const auto moved = moved_points(surface, move(surface, constant(surface, d)));
    EXPECT_NEAR(enclosed_volume(surface, moved), std::pow(1 + 2 * d, 3), round_off);
    EXPECT_GT(smallest_face(surface, move(surface, constant(surface, d))), 0);
  }
}

// Also where heights differ from point to point.
TEST(Edges, EveryFaceHasItsHeightAtEveryPoint) {
  for (const Mesh& mesh : {cube(6), l_block(6), leaning(6, pi / 3), leaning(5, pi / 4)}) {
    const Surface surface = select_surface(mesh, everything());
    const std::vector<double> heights = heights_at(surface, bumps);
    EXPECT_LT(largest_miss(surface, heights, move(surface, heights)), round_off);
    EXPECT_GT(largest_miss(surface, heights, move(surface, heights, EdgeRule::average)), 0.01);
  }
}

// The rim of a face moves in by almost three mesh sizes. Where nothing else does, its triangles
// turn over; a cube that shrinks keeps them all. The smooth extension shrinks by at most 3/2 of the
// mean, 2 d over the side, which leaves a factor of 0.1 on each axis.
TEST(Edges, FacesShrinkWithTheirRims) {
  const Surface surface = select_surface(cube(10), everything());
  const double d = -0.29;
  EXPECT_GT(smallest_face(surface, move(surface, constant(surface, d))), 0.1 * 0.1);
  std::vector<Vec3> rigid = move(surface, constant(surface, d));
  for (std::size_t i = 0; i < rigid.size(); ++i) {
    const Vec3& x = surface.points[i];
    const auto n_inner = std::count_if(x.begin(), x.end(), [](double c) { return c > 0 && c < 1; });
    if (n_inner == 2) rigid[i] = d * surface.normals[i];
  }
  EXPECT_LT(smallest_face(surface, rigid), 0);
}

// Eq. 36: at an edge of angle a both heights d want d / sin(a / 2).
TEST(Edges, AmplificationIsExactUntilItIsCapped) {
  for (int degrees = 5; degrees < 180; degrees += 5) {
    const double half = degrees * pi / 360;
    const std::array<Vec3, 2> normals = {Vec3(-std::sin(half), std::cos(half), 0),
                                         Vec3(-std::sin(half), -std::cos(half), 0)};
    const Vec3 u = detail::LeastDisplacement(normals, {}).solve(normals[0] + normals[1], 1);
    const bool is_cut = std::tan(half) < 0.2;  // ratio of the singular values
    const double expected = is_cut ? 0 : std::min(3.0, 1 / std::sin(half));
    EXPECT_NEAR((u - Vec3(-expected, 0, 0)).norm(), 0, round_off) << degrees;
  }
}

TEST(Edges, AWallIsNeverLeft) {
  const Vec3 n(0, 0, 1), m(1, 0, 1);
  const detail::LeastDisplacement least(std::array{n}, std::array{m});
  const Vec3 u = least.solve(0.5 * n, 0.5);
  EXPECT_NEAR(u.dot(n), 0.5, round_off);
  EXPECT_NEAR(u.dot(m), 0, round_off);
  EXPECT_NEAR(least.free_part(Vec3(1, 2, 3)).cross(Vec3(0, 1, 0)).norm(), 0, round_off);
  EXPECT_TRUE(detail::LeastDisplacement(std::array{n}, std::array{m, Vec3(0, 2, 0)}).is_rigid());
  // Three planes that are not parallel leave nothing.
  const std::array<Vec3, 3> all = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  EXPECT_EQ(detail::LeastDisplacement(std::array{n}, all).solve(n, 1), Vec3::Zero());
}

TEST(Edges, NodesOnAWallSlideInIt) {
  const Surface surface = select_surface(test::plate(8));
  NodeConstraints constraints;
  const Vec3 wall(1, 0, 0.5);
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    if (surface.points[surface.point_of_node[i]].x() == 0)
      constraints.sliding.push_back({surface.nodes[i], wall});
  const EdgeOptions options;
  const std::vector<double> heights = constant(surface, 0.1);
  const SurfaceMover mover(test::only(surface), {&options, 1}, constraints);
  const std::vector<Vec3> u = mover.move({&heights, 1}).displacements;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double x = surface.points[surface.point_of_node[i]].x();
    EXPECT_NEAR(u[i].z(), 0.1, round_off);
    if (x == 0) {
      EXPECT_NEAR(u[i].dot(wall), 0, round_off);
    }
    if (x == 1) {
      EXPECT_NEAR(u[i].x(), 0, round_off);
    }
    if (x == 0.125) {
      EXPECT_LE(u[i].x(), 0);  // the rows behind follow
    }
  }
  constraints.sliding.push_back({1000, wall});
  EXPECT_THROW(SurfaceMover(test::only(surface), {&options, 1}, constraints), InputError);
}

// The side of a barrel stretches with its rims, within itself.
TEST(Edges, CurvedFacesKeepTheirHeights) {
  Mesh barrel = cylinder(40, 6);
  for (Vec3& x : barrel.nodes) x.head<2>() *= 1 + 0.8 * x.z() * (1 - x.z());
  const Surface surface = select_surface(barrel);
  const std::vector<double> heights = heights_at(surface, bumps);
  const std::vector<Vec3> u = move(surface, heights);
  double stretch = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vec3& x = surface.points[i];
    if (x.z() == 0 || x.z() == 1) {
      EXPECT_NEAR(u[i].z(), x.z() == 1 ? heights[i] : -heights[i], round_off);
    } else {
      EXPECT_NEAR(u[i].dot(surface.normals[i]), heights[i], round_off);
      stretch = std::max(stretch, std::abs(u[i].z()));
    }
  }
  EXPECT_GT(stretch, 0.01);
}

// Each flat strip beside a rim has a right angle there, however its squares are split: of strips
// of equal width the normal between them is the radius.
TEST(Edges, NormalsAtEdgesDoNotDependOnDiagonals) {
  Mesh mesh = cylinder(24, 4);
  for (std::size_t i = 2; i < mesh.nodes.size(); ++i) {
    const double turn = 2 * pi * static_cast<double>((i - 2) % 24) / 24;
    mesh.nodes[i] = Vec3(std::cos(turn), std::sin(turn), mesh.nodes[i].z());
  }
  const Surface surface = select_surface(mesh);
  const std::vector<Vec3> u = move(surface, constant(surface, 0.1));
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vec3 radius(surface.points[i].x(), surface.points[i].y(), 0);
    const bool is_rim = radius.norm() > 0.5 && surface.points[i].z() == 1;
    if (is_rim) {
      EXPECT_NEAR((u[i] - 0.1 * (radius + Vec3(0, 0, 1))).norm(), 0, round_off);
    }
  }
}

TEST(Edges, AverageMovesPointsAlongTheirNormals) {
  for (const Mesh& mesh : {cube(4), l_block(4)}) {
    const Surface surface = select_surface(mesh, everything());
    const std::vector<double> heights = heights_at(surface, bumps);
    EXPECT_EQ(move(surface, heights, EdgeRule::average), displace(surface, heights));
  }
}

// Also beside another surface; points that both have are none of this.
TEST(Edges, AverageIsTheSameAmongSeveralSurfaces) {
  const Mesh mesh = cube(4);
  const std::vector<Surface> surfaces = {select_surface(mesh, {.groups = {"x-", "z-"}}),
                                         select_surface(mesh, {.groups = {"x+", "z+"}})};
  const std::vector<EdgeOptions> options(2, EdgeOptions{.rule = EdgeRule::average});
  std::vector<std::vector<double>> heights;
  heights.reserve(surfaces.size());
  for (const Surface& surface : surfaces) heights.push_back(heights_at(surface, bumps));
  const SurfaceMover mover(surfaces, options);
  const std::vector<Vec3> u = mover.move(heights).displacements;
  const Surface& one = surfaces[0];
  const std::vector<Vec3> expected = test::at_nodes(one, displace(one, heights[0]));
  for (std::size_t i = 0; i < one.nodes.size(); ++i) {
    if (std::binary_search(surfaces[1].nodes.begin(), surfaces[1].nodes.end(), one.nodes[i]))
      continue;
    const auto at = std::lower_bound(mover.nodes().begin(), mover.nodes().end(), one.nodes[i]);
    EXPECT_EQ(u[at - mover.nodes().begin()], expected[i]);
  }
}

TEST(Edges, FixHoldsPointsAtSharpEdgesOnly) {
  const Surface surface = select_surface(cube(4), everything());
  const std::vector<double> heights = heights_at(surface, bumps);
  const std::vector<Vec3> u = move(surface, heights, EdgeRule::fix);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vec3& x = surface.points[i];
    const auto n_inner = std::count_if(x.begin(), x.end(), [](double c) { return c > 0 && c < 1; });
    EXPECT_EQ(u[i], n_inner < 2 ? Vec3(0, 0, 0) : Vec3(heights[i] * surface.normals[i]));
  }
}

TEST(Edges, SmoothSurfacesMoveAlongTheirNormalsBitForBit) {
  const Surface surface = select_surface(test::icosphere(3));
  const std::vector<double> heights = heights_at(surface, bumps);
  EXPECT_EQ(move(surface, heights), displace(surface, heights));
  const EdgeOptions options{.rule = EdgeRule::offset, .sharp_angle = 1e-3};  // all edges are sharp
  EXPECT_NE(SurfaceMover(test::only(select_surface(test::icosphere(3), {.sharp_angle = 1e-3})),
                         {&options, 1})
                .move({&heights, 1})
                .displacements,
            test::at_nodes(surface, displace(surface, heights)));
}

TEST(Edges, PointsThatAMaskHoldsStay) {
  const Surface surface = select_surface(cube(6), everything());
  std::vector<double> heights = heights_at(surface, bumps);
  EdgeOptions options;
  for (std::size_t i = 0; i < heights.size(); ++i)
    options.weights.push_back(surface.points[i].x() > 0.4 ? 1 : 0);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] *= options.weights[i];
  const std::vector<Vec3> u =
      SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1}).displacements;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Index point = surface.point_of_node[i];
    if (options.weights[point] == 0) {
      EXPECT_EQ(u[i], Vec3::Zero());
    }
  }
}

// A roof whose ridge ends at both sides of a periodic cell, with other triangles at each.
TEST(Edges, ImagesMoveAlike) {
  constexpr int n = 8;
  std::vector<Vec3> nodes;
  std::vector<Index> faces;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      nodes.emplace_back(i / 8.0, j / 8.0, j == n / 2 ? 0.5 + 0.1 * std::sin(i * pi / 4) : 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Index p = i * (n + 1) + j, q = p + n + 1, r = q + 1, s = p + 1;
      if (i > 2)
        faces.insert(faces.end(), {p, q, r, p, r, s});
      else
        faces.insert(faces.end(), {p, q, s, q, r, s});
    }
  const Surface surface = select_surface(test::surface_mesh(nodes, faces));
  const std::vector<double> heights = heights_at(
      surface, [](const Vec3& x) { return 0.1 * std::cos(2 * pi * x.x()) + 0.1 * x.y(); });
  EdgeOptions options;
  const auto moved = [&] {
    return SurfaceMover(test::only(surface), {&options, 1}).move({&heights, 1}).displacements;
  };
  const std::vector<Vec3> apart = moved();
  for (const Vec3& x : surface.points)  // one number for x = 0 and x = 1
    options.images.push_back(
        static_cast<Index>(std::lround(x.x() == 1 ? 8 * x.y() : 9 * 8 * x.x() + 8 * x.y())));
  const std::vector<Vec3> alike = moved();
  EXPECT_NE(apart[n / 2], apart[n * (n + 1) + n / 2]);
  EXPECT_EQ(alike[n / 2], alike[n * (n + 1) + n / 2]);
}

// Numbers of the file change no bit; turning the body turns the displacements; a unit scales them.
TEST(Edges, NumbersDirectionsAndUnitsDoNotMatter) {
  const Mesh mesh = l_block(6);
  const Surface surface = select_surface(mesh, everything());
  const std::vector<Vec3> u = move(surface, heights_at(surface, bumps));
  const Surface other = select_surface(test::shuffled(mesh, 7), everything());
  EXPECT_EQ(move(other, heights_at(other, bumps)), u);

  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Surface turned = select_surface(mapped(mesh, turn), everything());
  const std::vector<Vec3> u_turned =
      move(turned, heights_at(turned, [&](const Vec3& x) { return bumps(turn.transpose() * x); }));
  const Surface scaled =
      select_surface(mapped(mesh, 1e6 * Eigen::Matrix3d::Identity()), everything());
  const std::vector<Vec3> u_scaled =
      move(scaled, heights_at(scaled, [](const Vec3& x) { return 1e6 * bumps(x / 1e6); }));
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_NEAR((u_scaled[i] - 1e6 * u[i]).norm(), 0, 1e6 * round_off);
    const auto same = std::find_if(turned.points.begin(), turned.points.end(), [&](const Vec3& x) {
      return (x - turn * surface.points[i]).norm() < 1e-9;
    });
    EXPECT_NEAR((u_turned[same - turned.points.begin()] - turn * u[i]).norm(), 0, round_off);
  }
}

// Six surfaces that meet are the same system as one surface with sharp edges.
TEST(Edges, SurfacesThatMeetAreLikeFacesOfOne) {
  const Mesh mesh = cube(5);
  const Surface whole = select_surface(mesh, everything());
  const std::vector<std::vector<double>> heights = {heights_at(whole, bumps)};
  std::vector<Surface> sides;
  std::vector<std::vector<double>> side_heights;
  for (const char* name : {"x-", "x+", "y-", "y+", "z-", "z+"}) {
    sides.push_back(select_surface(mesh, {.groups = {name}}));
    side_heights.push_back(heights_at(sides.back(), bumps));
  }
  ASSERT_EQ(moved_nodes(sides), whole.nodes);
  const std::vector<Vec3> u = displace_nodes(test::only(whole), heights);
  const std::vector<Vec3> v = displace_nodes(sides, side_heights);
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR((u[i] - v[i]).norm(), 0, round_off);
}

// Nodes in the middle of edges of elements of order 2 obey the same rule.
TEST(Edges, SecondOrderFacesKeepTheirHeights) {
  const Surface surface = select_surface(test::second_order(cube(3), false), everything());
  const std::vector<double> heights = heights_at(surface, bumps);
  EXPECT_LT(largest_miss(surface, heights, move(surface, heights)), round_off);
}

TEST(Edges, CornersOfCurvesKeepTheHeightsOfTheirLines) {
  std::vector<Vec3> points;
  const std::array<Vec3, 5> corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0),
                                       Vec3(0.5, 0.6, 0), Vec3(0, 1, 0)};
  for (std::size_t k = 0; k < corners.size(); ++k)
    for (int i = 0; i < 8; ++i)
      points.push_back(corners[k] + i / 8.0 * (corners[(k + 1) % corners.size()] - corners[k]));
  const Surface surface = select_surface(test::polyline(points, true));
  for (const bool is_constant : {true, false}) {
    const std::vector<double> heights =
        is_constant ? constant(surface, -0.06) : heights_at(surface, bumps);
    const std::vector<Vec3> u = move(surface, heights);
    for (Index f = 0; f < surface.n_faces(); ++f) {
      const auto line = surface.face(f);
      const Vec3 along = surface.points[line[1]] - surface.points[line[0]];
      const Vec3 normal = along.cross(surface.plane_normal).normalized();
      for (const Index point : line) EXPECT_NEAR(normal.dot(u[point]), heights[point], round_off);
      if (is_constant) {
        EXPECT_GT(along.dot(along + u[line[1]] - u[line[0]]), 0);
      }
    }
  }
}

// Eq. 57: nothing at the edge, all from where the wall is ten Rq thick.
TEST(Edges, AcuteEdgesTaper) {
  const double angle = pi / 6, rq = 0.02;
  const Surface surface = select_surface(leaning(20, angle), everything());
  const EdgeOptions options;
  const double reach = 10 * rq / (2 * std::tan(angle / 2));
  const detail::EdgeTaper taper =
      detail::taper_acute_edges(test::only(surface), {&options, 1}, {&rq, 1});
  EXPECT_NEAR(taper.sharpest[0].angle, angle, round_off);
  const Vec3 a(0, 0, 0), b(1 + 1 / std::tan(angle), 1, 0);  // the two acute edges run along z
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vec3 x(surface.points[i].x(), surface.points[i].y(), 0);
    const double t = std::min((x - a).norm(), (x - b).norm()) / reach;
    const double expected = t >= 1 ? 1 : t * t * t * (10 + t * (6 * t - 15));
    EXPECT_NEAR(taper.factors[0][i], expected, round_off);
  }
  for (const EdgeRule rule : {EdgeRule::average, EdgeRule::fix}) {
    const EdgeOptions others{.rule = rule};
    EXPECT_TRUE(
        detail::taper_acute_edges(test::only(surface), {&others, 1}, {&rq, 1}).factors[0].empty());
  }
  const Surface blunt = select_surface(leaning(8, pi / 3.9), everything());
  EXPECT_TRUE(
      detail::taper_acute_edges(test::only(blunt), {&options, 1}, {&rq, 1}).factors[0].empty());
}

namespace {

RoughenOptions run_options(EdgeRule rule) {
  RoughenOptions options;
  options.surfaces[0].group = {"all"};
  options.surfaces[0].rms = 0.01;
  options.surfaces[0].length = {0.2};
  options.surfaces[0].edges = rule;
  return options;
}

bool warns(const Report& report, const std::string& text) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const std::string& each) { return each.find(text) != each.npos; });
}

}  // namespace

TEST(Edges, ARunTellsOfTapersAndAverages) {
  const Mesh mesh = leaning(12, pi / 6);
  const auto drop = [](const RoughMesh&, Report&) {};
  const Report offset = roughen(mesh, run_options(EdgeRule::offset), drop);
  EXPECT_TRUE(warns(offset, "heights are lowered at"));
  EXPECT_TRUE(warns(offset, "30 degrees"));
  EXPECT_GT(offset.surfaces[0].masked_nodes, 26);
  EXPECT_LT(offset.realizations[0].surfaces[0].sq_expected, 0.0099);
  const Report average = roughen(mesh, run_options(EdgeRule::average), drop);
  EXPECT_TRUE(warns(average, "along averaged normals"));
  EXPECT_EQ(average.surfaces[0].masked_nodes, 0);
  const Report fix = roughen(mesh, run_options(EdgeRule::fix), drop);
  EXPECT_EQ(fix.surfaces[0].masked_nodes, 8 + 10 * 11);  // two edges of 150 degrees are not sharp
}

// All four points of a flat tetrahedron are on acute edges.
TEST(Edges, ABodyOfAcuteEdgesOnlyIsRefused) {
  const Mesh flat = test::surface_mesh({{0, 0, 0}, {1, 1, 0}, {1, 0, 0.1}, {0, 1, 0.1}},
                                       {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
  const std::string message = test::message_of(
      [&] { roughen(flat, run_options(EdgeRule::offset), [](const RoughMesh&, Report&) {}); });
  EXPECT_NE(message.find("no height fits into the wall"), message.npos) << message;
}
