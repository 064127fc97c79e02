// SPDX-License-Identifier: BSD-3-Clause
// The faces of a planar mesh follow its curves.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/move_volume.hpp"

#include "support/cells.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;

namespace {

Surface curve(const Mesh& mesh, const std::vector<std::string>& groups) {
  return select_surface(mesh, {.groups = groups});
}

std::vector<double> bumps(const Surface& surface, double size) {
  std::vector<double> heights;
  for (Index i = 0; i < surface.n_points(); ++i) heights.push_back(size * std::sin(2.4 * i + 1));
  return heights;
}

std::vector<Vec3> roughened(const Mesh& mesh, const Surface& surface, double size) {
  const std::vector<double> heights = bumps(surface, size);
  return VolumeMover(mesh, test::only(surface))
      .move(displace_nodes(test::only(surface), {&heights, 1}))
      .nodes;
}

double area_of_triangles(const Mesh& mesh, const std::vector<Vec3>& nodes, Tag entity) {
  double sum = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type != test::triangle_type || (entity != 0 && block.entity != entity)) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto t = block.element(e);
      sum += std::abs((nodes[t[1]] - nodes[t[0]]).cross(nodes[t[2]] - nodes[t[0]]).z()) / 2;
    }
  }
  return sum;
}

// sum over triangles of 1/A * integral |grad u|^2 = sum |grad u|^2, from the definition: in the
// plane, grad u solves the two differences of u along edges.
double energy(const Mesh& mesh, const std::vector<Vec3>& u) {
  double sum = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type != test::triangle_type) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto t = block.element(e);
      Eigen::Matrix2d edges, differences;
      for (int k = 0; k < 2; ++k) {
        edges.col(k) = (mesh.nodes[t[k + 1]] - mesh.nodes[t[0]]).head<2>();
        differences.col(k) = (u[t[k + 1]] - u[t[0]]).head<2>();
      }
      sum += (differences * edges.inverse()).squaredNorm();
    }
  }
  return sum;
}

bool on_curve(const Vec3& x, double radius) { return std::abs(x.norm() - radius) < 1e-9; }

}  // namespace

// Heights of 40 % of the radial edge: without the inner nodes quadrangles and triangles invert.
TEST(MovePlane, TheInteriorFollowsAndTheBoundaryStays) {
  for (const bool quadrangles : {false, true})
    for (const std::string group : {"hole", "interface"}) {
      const Mesh mesh = test::ring(32, quadrangles);
      const Surface surface = curve(mesh, {group});
      const VolumeMover mover(mesh, test::only(surface));
      EXPECT_TRUE(mover.moves_interior());
      EXPECT_EQ(mover.wall_nodes().size(), 0U);
      const std::vector<Vec3> moved = roughened(mesh, surface, 0.04);
      const MeshCheck check = check_mesh(mesh, moved);
      EXPECT_TRUE(check.valid());
      EXPECT_GT(check.min_quality, 0.1);
      EXPECT_EQ(check.n_corners_only, 0);
      const double radius = group == "hole" ? 0.25 : 0.625;
      for (Index node = 0; node < mesh.n_nodes(); ++node) {
        const Vec3& x = mesh.nodes[node];
        EXPECT_EQ(moved[node].z(), 0);
        const bool stays =
            !on_curve(x, radius) && (on_curve(x, 0.25) || on_curve(x, 0.625) || on_curve(x, 1));
        // Beside the hole the other side of the interface is out of reach.
        const bool is_out_of_reach = group == "hole" && x.norm() > 0.625;
        EXPECT_EQ(moved[node] == x, stays || is_out_of_reach) << x.transpose();
      }
    }
}

// What the curve sweeps is what one face gains and the other loses.
TEST(MovePlane, AreasAreThoseOfTheMovedCurve) {
  const Mesh mesh = test::ring(32);
  const Surface surface = curve(mesh, {"interface"});
  const std::vector<double> heights = bumps(surface, 0.03);
  const std::vector<Vec3> moved = roughened(mesh, surface, 0.03);
  EXPECT_NEAR(area_of_triangles(mesh, moved, 0), area_of_triangles(mesh, mesh.nodes, 0), 1e-13);
  const double gain = enclosed_volume(surface, moved_points(surface, displace(surface, heights))) -
                      enclosed_volume(surface, surface.points);
  EXPECT_GT(std::abs(gain), 1e-5);
  EXPECT_NEAR(area_of_triangles(mesh, moved, 1) - area_of_triangles(mesh, mesh.nodes, 1), gain,
              1e-13);
}

// As TheDisplacementMinimizesTheWeightedEnergy of volumes: E(u + v) = E(u) + E(v).
TEST(MovePlane, TheDisplacementMinimizesTheWeightedEnergy) {
  const Mesh mesh = test::ring(32);
  std::vector<Vec3> u = roughened(mesh, curve(mesh, {"interface"}), 0.04);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  std::vector<Vec3> v(u.size(), Vec3::Zero()), sum;
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] -= mesh.nodes[i];
    const Vec3& x = mesh.nodes[i];
    if (!on_curve(x, 0.25) && !on_curve(x, 0.625) && !on_curve(x, 1))
      v[i] = Vec3(uniform(random), uniform(random), 0);
    sum.push_back(u[i] + v[i]);
  }
  const double eu = energy(mesh, u), ev = energy(mesh, v);
  EXPECT_NEAR(energy(mesh, sum), eu + ev, 1e-9 * (eu + ev));
}

// The equations know distances only. A tilt rounds to 1e-16 of coordinates of 10, the solver stops
// at 1e-12 of the load.
TEST(MovePlane, AnyPlaneWillDo) {
  const Eigen::Affine3d tilt =
      Eigen::Translation3d(3, -2, 5) * Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized());
  for (const bool complete : {false, true}) {
    const Mesh flat = test::second_order(test::ring(32, complete), complete);
    const Mesh tilted = test::transformed(flat, tilt);
    const Surface a = curve(flat, {"interface"}), b = curve(tilted, {"interface"});
    const auto shifts = [&](const Mesh& mesh, const Surface& surface) {
      std::vector<std::vector<double>> heights(1);
      for (const Vec3& x : surface.points) {
        const Vec3 y = &mesh == &flat ? x : Vec3(tilt.inverse() * x);
        heights[0].push_back(0.03 * std::sin(9 * y.x() + 4 * y.y()));
      }
      return VolumeMover(mesh, test::only(surface))
          .move(displace_nodes(test::only(surface), heights))
          .nodes;
    };
    const std::vector<Vec3> moved = shifts(flat, a), moved_tilted = shifts(tilted, b);
    for (std::size_t i = 0; i < moved.size(); ++i)
      EXPECT_NEAR((tilt * moved[i] - moved_tilted[i]).norm(), 0, 1e-10);
    EXPECT_TRUE(check_mesh(tilted, moved_tilted).valid());
    EXPECT_EQ(check_mesh(tilted, moved_tilted).n_corners_only, 0);
  }
}

TEST(MovePlane, SeveralCurvesAtOnce) {
  const Mesh mesh = test::ring(32);
  const Surface all = curve(mesh, {"all"});
  EXPECT_EQ(all.n_components, 3);
  const VolumeMover mover(mesh, test::only(all));
  EXPECT_EQ(mover.wall_nodes().size(), 0U);
  EXPECT_TRUE(check_mesh(mesh, roughened(mesh, all, 0.02)).valid());
  const std::vector<Surface> apart = {curve(mesh, {"hole"}), curve(mesh, {"rim"})};
  const std::vector<std::vector<double>> heights = {bumps(apart[0], 0.02), bumps(apart[1], 0.02)};
  const std::vector<Vec3> moved =
      VolumeMover(mesh, apart).move(displace_nodes(apart, heights)).nodes;
  EXPECT_TRUE(check_mesh(mesh, moved).valid());
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_EQ(moved[node] == mesh.nodes[node], on_curve(mesh.nodes[node], 0.625));
}

// A node on an open curve that ends inside the domain; its ends are free.
TEST(MovePlane, AnOpenInnerCurve) {
  Mesh mesh = test::ring(32);
  ElementBlock& block = mesh.blocks[1];
  block.nodes.resize(12 * 2);
  block.tags.resize(12);
  const Surface open = curve(mesh, {"interface"});
  EXPECT_EQ(open.n_border_edges, 2);
  EXPECT_EQ(VolumeMover(mesh, test::only(open)).wall_nodes().size(), 0U);
  EXPECT_TRUE(check_mesh(mesh, roughened(mesh, open, 0.03)).valid());
}

// Three of the four lines of a corner are chosen: where they end the domain's boundary stays.
TEST(MovePlane, WallNodesAreWhereOtherLinesBegin) {
  Mesh mesh = test::ring(32);
  ElementBlock rest = mesh.blocks[2];
  rest.nodes.erase(rest.nodes.begin(), rest.nodes.begin() + 10 * 2);
  rest.tags.erase(rest.tags.begin(), rest.tags.begin() + 10);
  mesh.blocks[2].nodes.resize(10 * 2);
  mesh.blocks[2].tags.resize(10);
  EXPECT_EQ(VolumeMover(mesh, test::only(curve(mesh, {"rim"}))).wall_nodes().size(),
            2U);  // no elements
  rest.physical_groups = {9};
  mesh.blocks.push_back(rest);
  mesh.groups.push_back({1, 9, "rest"});
  EXPECT_EQ(VolumeMover(mesh, test::only(curve(mesh, {"rim"}))).wall_nodes().size(), 2U);
  EXPECT_EQ(VolumeMover(mesh, test::only(curve(mesh, {"rim", "rest"}))).wall_nodes().size(), 0U);
}

// The sign of a triangle is seen along the normal of the plane, whichever way it runs in the file.
TEST(MovePlane, InvertedTrianglesAreFound) {
  Mesh mesh = test::ring(16);
  test::turn_element(mesh.blocks[3], 2);
  EXPECT_TRUE(check_mesh(mesh, mesh.nodes).valid());
  std::vector<Vec3> mirrored = mesh.nodes;
  for (Vec3& x : mirrored) x.x() = -x.x();
  EXPECT_EQ(check_mesh(mesh, mirrored).inverted_elements, n_elements(mesh, 2));
  EXPECT_EQ(check_mesh(mesh, mirrored).findings.front().what, "inverted triangle");
  EXPECT_LT(check_mesh(mesh, mirrored).min_quality, 0);
}

TEST(MovePlane, APlateMovesOutOfItsPlane) {
  const Mesh mesh = test::ring(16);
  const Surface plate = curve(mesh, {"core", "shell"});
  const VolumeMover mover(mesh, test::only(plate));
  EXPECT_FALSE(mover.moves_interior());
  const std::vector<Vec3> moved = roughened(mesh, plate, 0.01);
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    EXPECT_EQ(moved[node].head<2>(), mesh.nodes[node].head<2>());
}

TEST(MovePlane, LinesOnlyMoveAlone) {
  const Mesh mesh = test::polyline(test::circle_points(test::uneven_angles(24), 1), true);
  const Surface circle = select_surface(mesh);
  const VolumeMover mover(mesh, test::only(circle));
  EXPECT_FALSE(mover.moves_interior());
  EXPECT_EQ(mover.wall_nodes().size(), 0U);
  EXPECT_TRUE(check_mesh(mesh, roughened(mesh, circle, 0.1)).valid());
}

// Twice the area of a polygon on a circle is sum (R + z_i)(R + z_j) sin(angle), so that its mean is
// exact: A + Rq^2 / 2 sum rho_ij sin(angle_ij). The part linear in z, whose mean is 0, is taken off
// each of 2,000 independent areas, which makes the sampling error smaller; six standard errors.
TEST(MovePlane, MeanAreaOfARoughCircleIsTheExactOne) {
  const Surface circle =
      select_surface(test::polyline(test::circle_points(test::uneven_angles(64), 1), true));
  const Autocorrelation rho({.family = Family::gaussian, .length = 0.3});
  const FieldSampler sampler(Correlation(circle.points, rho, Distance::euclidean()));
  const double rq = 0.1;
  const double smooth = enclosed_volume(circle, circle.points);
  double expected = 0;
  for (Index f = 0; f < circle.n_faces(); ++f) {
    const Vec3 &a = circle.points[circle.face(f)[0]], &b = circle.points[circle.face(f)[1]];
    expected += rq * rq / 2 * rho.rho((a - b).norm()) * a.cross(b).z();
  }
  constexpr int n = 2000;
  double sum = 0, squares = 0;
  for (std::uint64_t realization = 0; realization < n; ++realization) {
    std::vector<double> heights = sampler.heights(7, realization);
    for (double& z : heights) z *= rq;
    double linear = 0;
    for (Index f = 0; f < circle.n_faces(); ++f) {
      const auto [i, j] = std::pair(circle.face(f)[0], circle.face(f)[1]);
      linear += (heights[i] + heights[j]) / 2 * circle.points[i].cross(circle.points[j]).z();
    }
    const auto rough = moved_points(circle, displace(circle, heights));
    const double growth = enclosed_volume(circle, rough) - smooth - linear;
    sum += growth;
    squares += (growth - expected) * (growth - expected);
  }
  const double standard_error = std::sqrt(squares) / n;
  EXPECT_NEAR(sum / n, expected, 6 * standard_error);
  EXPECT_LT(standard_error, 0.02 * expected);  // so that 12 % would be seen
}
