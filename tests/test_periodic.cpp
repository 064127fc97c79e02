// SPDX-License-Identifier: BSD-3-Clause
// Points that are images of each other: by links, by position, their normals and their heights.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/periodic.hpp"

#include "support/errors.hpp"
#include "support/meshes.hpp"

namespace roughmesh {
namespace {

constexpr Index side = 5;  // points along each side of the sheet

/// A wavy sheet over [0, 2] x [0, 3], periodic in x and y, as the only group of a mesh.
Mesh sheet() {
  std::vector<Vec3> nodes;
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) {
      const double u = static_cast<double>(i % (side - 1)) / (side - 1);
      const double v = static_cast<double>(j % (side - 1)) / (side - 1);
      nodes.emplace_back(2.0 * i / (side - 1), 3.0 * j / (side - 1),
                         0.3 * std::sin(6.283 * (u + 0.1)) + 0.2 * std::cos(6.283 * v));
    }
  std::vector<Index> triangles;
  for (Index i = 0; i + 1 < side; ++i)
    for (Index j = 0; j + 1 < side; ++j) {
      const Index a = i * side + j, b = a + side;
      triangles.insert(triangles.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  return test::surface_mesh(nodes, triangles);
}

PeriodicLink link_of(int axis) {
  PeriodicLink link{1, axis + 1, axis + 11, {}, {}};
  for (Index k = 0; k < side; ++k)
    link.nodes.push_back(axis == 0 ? std::pair{(side - 1) * side + k, k}
                                   : std::pair{k * side + side - 1, k * side});
  return link;
}

/// The sheet with links in x and y; the far corner is linked to a neighbour corner only, so that
/// its chain has two steps.
Mesh linked_sheet() {
  Mesh mesh = sheet();
  mesh.periodic_links = {link_of(0), link_of(1)};
  mesh.periodic_links[1].nodes.pop_back();
  return mesh;
}

std::vector<double> affine(const Eigen::Matrix3d& linear, const Vec3& shift) {
  std::vector<double> result(16, 0.0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) result[4 * row + column] = linear(row, column);
    result[4 * row + 3] = shift[row];
  }
  result[15] = 1;
  return result;
}

// Sheet points are sorted by x, then y: point i * side + j.
TEST(PeriodicPartners, OfLinksAreTheFirstOfTheirImages) {
  const Mesh mesh = linked_sheet();
  const Surface surface = select_surface(mesh);
  const PeriodicPartners partners = periodic_partners(mesh, surface);
  EXPECT_EQ(partners.period, Vec3(2, 3, 0));
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) {
      EXPECT_EQ(partners.master[i * side + j], i % (side - 1) * side + j % (side - 1));
      EXPECT_FALSE(partners.rotated[i * side + j]);
      EXPECT_FALSE(partners.unpaired[i * side + j]);
    }
  EXPECT_EQ(masters(partners).size(), static_cast<std::size_t>((side - 1) * (side - 1)));
}

TEST(PeriodicPartners, ByLinksAndByPositionAreTheSame) {
  const Mesh mesh = linked_sheet();
  const Surface surface = select_surface(mesh);
  const PeriodicPartners linked = periodic_partners(mesh, surface);
  EXPECT_EQ(periodic_partners(mesh, surface, Vec3(2, 3, 0)).master, linked.master);
  EXPECT_EQ(periodic_partners(sheet(), surface, Vec3(2, 3, 0)).master, linked.master);
  // One axis by link, the other by period.
  Mesh half = sheet();
  half.periodic_links = {link_of(1)};
  const PeriodicPartners mixed = periodic_partners(half, surface, Vec3(2, 0, 0));
  EXPECT_EQ(mixed.master, linked.master);
  EXPECT_EQ(mixed.period, Vec3(2, 3, 0));
}

TEST(PeriodicPartners, DoNotDependOnWhichSideALinkCallsMaster) {
  Mesh mesh = linked_sheet();
  const Surface surface = select_surface(mesh);
  const PeriodicPartners expected = periodic_partners(mesh, surface);
  for (auto& [slave, master] : mesh.periodic_links[0].nodes) std::swap(slave, master);
  const PeriodicPartners turned = periodic_partners(mesh, surface);
  EXPECT_EQ(turned.master, expected.master);
  EXPECT_EQ(turned.period, expected.period);
}

// Opposite corners linked directly: the sum of two periods, no rotation.
TEST(PeriodicPartners, MayBeLinkedAcrossACorner) {
  Mesh mesh = linked_sheet();
  mesh.periodic_links.push_back({0, 9, 8, {}, {{side * side - 1, 0}}});
  const PeriodicPartners partners = periodic_partners(mesh, select_surface(mesh));
  EXPECT_EQ(partners.period, Vec3(2, 3, 0));
  EXPECT_EQ(std::count(partners.rotated.begin(), partners.rotated.end(), 1), 0);
}

// Positions far from the origin, off by round-off: 2e-10 of the period are forgiven.
TEST(PeriodicPartners, ArePairedToAPartInABillion) {
  Mesh mesh = sheet();
  for (Vec3& x : mesh.nodes) x += Vec3(-40, 17, 5);
  mesh.nodes[side * side - 1] += Vec3(2e-10, -2e-10, 2e-10);
  const Surface surface = select_surface(mesh);
  EXPECT_EQ(masters(periodic_partners(mesh, surface, Vec3(2, 3, 0))).size(),
            static_cast<std::size_t>((side - 1) * (side - 1)));
  mesh.nodes[side * side - 1] += Vec3(0, 0, 1e-7);
  EXPECT_EQ(masters(periodic_partners(mesh, select_surface(mesh), Vec3(2, 3, 0))).size(),
            static_cast<std::size_t>((side - 1) * (side - 1) + 1));
}

TEST(PeriodicPartners, WithoutLinksAreNone) {
  const Mesh mesh = sheet();
  const Surface surface = select_surface(mesh);
  const PeriodicPartners partners = periodic_partners(mesh, surface);
  EXPECT_EQ(partners.period, Vec3(0, 0, 0));
  EXPECT_EQ(masters(partners).size(), surface.points.size());
}

TEST(PeriodicPartners, LinksThatAreNotTranslationsAreMarked) {
  Mesh mesh = sheet();
  // By a map of the file: a quarter turn. Nodes where they would be by a translation do not
  // mislead.
  PeriodicLink turned = link_of(0);
  turned.affine = affine(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()).toRotationMatrix(),
                         Vec3(2, 0, 0));
  mesh.periodic_links = {turned};
  const Surface surface = select_surface(mesh);
  const PeriodicPartners by_map = periodic_partners(mesh, surface);
  EXPECT_EQ(by_map.period, Vec3(0, 0, 0));
  EXPECT_EQ(std::count(by_map.rotated.begin(), by_map.rotated.end(), 1), 2 * side);
  // By the nodes: the first side linked to the second, which runs the other way.
  PeriodicLink by_nodes{1, 1, 2, {}, {}};
  for (Index k = 0; k < side; ++k) by_nodes.nodes.emplace_back(k * side, k);
  mesh.periodic_links = {by_nodes};
  const PeriodicPartners partners = periodic_partners(mesh, surface);
  EXPECT_EQ(partners.period, Vec3(0, 0, 0));
  EXPECT_EQ(std::count(partners.rotated.begin(), partners.rotated.end(), 1), 2 * side - 2);
  // Both rows stay masters of the same number of classes, and keep their own normals.
  EXPECT_EQ(with_partner_normals(surface, partners).normals, surface.normals);
}

TEST(PeriodicPartners, LinksToNodesThatStayAreMarked) {
  Mesh mesh = linked_sheet();
  mesh.nodes.emplace_back(2, 3, 9);
  test::number_nodes(mesh);
  mesh.periodic_links = {{1, 1, 2, {}, {{7, side * side}}}};
  const PeriodicPartners partners = periodic_partners(mesh, select_surface(mesh));
  EXPECT_EQ(partners.unpaired[7], 1);
  EXPECT_EQ(std::count(partners.unpaired.begin(), partners.unpaired.end(), 1), 1);
}

TEST(PeriodicPartners, RefuseSidesThatDifferAndPeriodsThatContradict) {
  Mesh mesh = linked_sheet();
  const Surface surface = select_surface(mesh);
  const auto message = [&](const std::optional<Vec3>& period = {}) {
    return test::message_of([&] { periodic_partners(mesh, surface, period); });
  };
  EXPECT_NE(message(Vec3(2.1, 3, 0)).find("--period is 2.1 along x"), std::string::npos);
  mesh.nodes[(side - 1) * side + 2].z() += 1e-5;
  EXPECT_NE(message().find("node 23 at (2, 1.5, "), std::string::npos) << message();
  mesh = linked_sheet();
  for (Vec3& x : mesh.nodes) x.z() = 0;
  mesh.periodic_links.push_back({1, 5, 6, {}, {{2 * side, 0}, {2 * side + 1, 1}}});
  EXPECT_NE(message().find("has period 1 along x, another link 2"), std::string::npos) << message();
  mesh = sheet();
  EXPECT_NE(message(Vec3(2.5, 3, 0)).find("no two points of the surface differ by it"),
            std::string::npos);
  for (const Vec3& period : {Vec3(0, 0, 0), Vec3(-2, 3, 0), Vec3(std::nan(""), 3, 0),
                             Vec3(std::numeric_limits<double>::infinity(), 3, 0)})
    EXPECT_NE(message(period).find("--period"), std::string::npos);
}

TEST(PeriodicPartners, HeightsOfMastersAreExpandedToImages) {
  const Mesh mesh = sheet();
  const PeriodicPartners partners = periodic_partners(mesh, select_surface(mesh), Vec3(2, 3, 0));
  std::vector<double> of_masters;
  for (const Index master : masters(partners)) of_masters.push_back(10.0 * master);
  const std::vector<double> heights = expand(partners, of_masters);
  for (std::size_t i = 0; i < heights.size(); ++i) EXPECT_EQ(heights[i], 10.0 * partners.master[i]);
  of_masters.pop_back();
  EXPECT_THROW(expand(partners, of_masters), InputError);
}

// The normals of the sheet's cell are those of the middle cell of three by three cells.
TEST(PeriodicPartners, NormalsAreThoseOfTheUnboundedSurface) {
  const Mesh mesh = sheet();
  const Surface surface = select_surface(mesh);
  const PeriodicPartners partners = periodic_partners(mesh, surface, Vec3(2, 3, 0));
  const Surface shared = with_partner_normals(surface, partners);

  std::vector<Vec3> nodes;
  std::vector<Index> triangles;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      const auto first = static_cast<Index>(nodes.size());
      for (const Vec3& x : mesh.nodes) nodes.push_back(x + Vec3(2 * i, 3 * j, 0));
      for (const Index node : mesh.blocks[0].nodes) triangles.push_back(first + node);
    }
  const Surface nine = select_surface(test::surface_mesh(nodes, triangles));
  int n_found = 0;
  for (std::size_t p = 0; p < nine.points.size(); ++p)
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      if ((nine.points[p] - surface.points[i]).norm() < 1e-12) {
        ++n_found;
        EXPECT_LT((nine.normals[p] - shared.normals[i]).norm(), 1e-12) << i;
      }
  EXPECT_EQ(n_found, side * side);
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    EXPECT_EQ(shared.normals[i], shared.normals[partners.master[i]]);
}

// A plate of three and a half periods along x and one along y, far from the origin: its middle has
// images as well as its sides.
TEST(PeriodicPartners, ByPositionAreAllPointsThatDifferByPeriods) {
  Mesh mesh = test::plate(7, 3.5);
  const Vec3 period(1, 3.5, 0), far(100, 200, 300);
  for (Vec3& x : mesh.nodes) x += far;
  const Surface surface = select_surface(mesh);
  const PeriodicPartners partners = periodic_partners(mesh, surface, period);
  for (Index i = 0; i < surface.n_points(); ++i) {
    const auto is_image = [&](const Vec3& x) {
      const Vec3 shift = surface.points[i] - x;
      return std::abs(shift.x() - std::round(shift.x())) < 1e-9 &&
             std::abs(shift.y() - 3.5 * std::round(shift.y() / 3.5)) < 1e-9;
    };
    const auto first = std::find_if(surface.points.begin(), surface.points.end(), is_image);
    EXPECT_EQ(partners.master[i], first - surface.points.begin()) << i;
  }
}

// Every point of a plate of 400 x 400 modulo a period of one mesh size: one class of 160,801.
TEST(PeriodicPartners, TakeNoQuadraticTimeForManyImages) {
  const Mesh mesh = test::plate(400);
  const PeriodicPartners partners =
      periodic_partners(mesh, select_surface(mesh), Vec3(1.0 / 400, 1.0 / 400, 0));
  EXPECT_EQ(masters(partners).size(), 1u);
}

}  // namespace
}  // namespace roughmesh
