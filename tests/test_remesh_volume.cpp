// SPDX-License-Identifier: BSD-3-Clause
// Volumes that are meshed anew: what must not change does not, and what is new fits.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/mesh_io.hpp"

#include "remesh_volume.hpp"
#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"

using namespace roughmesh;
using namespace roughmesh::detail;

namespace {

// Cells of the ball have edges of 1/8.
constexpr double h = 0.125;

// A ball in a box in a thick shell: volumes "inside", "outside" and "far", which nothing touches.
Mesh ball_in_two_boxes() {
  Mesh mesh = test::ball_in_box(16);
  const Mesh inner = mesh;
  ElementBlock& outside = mesh.blocks[3];
  ElementBlock far{outside.type, 3, {3}, {}, {}};
  ElementBlock near{outside.type, 2, {2}, {}, {}};
  for (Index e = 0; e < outside.size(); ++e) {
    double least = 2;
    for (const Index node : outside.element(e))
      least = std::min(least, mesh.nodes[node].lpNorm<Eigen::Infinity>());
    ElementBlock& to = least > 1 - 1.5 * h ? far : near;
    to.nodes.insert(to.nodes.end(), outside.element(e).begin(), outside.element(e).end());
    to.tags.push_back(outside.tags[e]);
  }
  mesh.blocks[3] = near;
  mesh.blocks.push_back(far);
  mesh.groups.push_back({3, 3, "far"});
  return mesh;
}

struct Rough {
  Mesh mesh;
  Surface surface;
  std::vector<Vec3> positions;
};

// Heights of rms 1 h and more at the steepest places, too high for the old elements.
Rough roughened(Mesh mesh, double height = 1.4 * h) {
  Rough rough{std::move(mesh), {}, {}};
  rough.surface = select_surface(rough.mesh, {.groups = {"surface"}});
  std::vector<double> heights;
  for (const Vec3& x : rough.surface.points)
    heights.push_back(height * std::sin(7 * x.x()) * std::cos(6 * x.y() + 5 * x.z()));
  const std::vector<Vec3> moves = displace_nodes(test::only(rough.surface), {&heights, 1});
  rough.positions = rough.mesh.nodes;
  for (std::size_t i = 0; i < moves.size(); ++i)
    rough.positions[rough.surface.nodes[i]] += moves[i];
  return rough;
}

RemeshedVolume remeshed(const Rough& rough) {
  return VolumeRemesher(rough.mesh, test::only(rough.surface), {}).remesh(rough.positions);
}

struct PlainElement {
  Tag entity;
  std::vector<Tag> groups, nodes;
  auto operator<=>(const PlainElement&) const = default;
};

// By their numbers, the elements of some dimension or group, on the numbers of their nodes.
std::map<Tag, PlainElement> elements_of(const Mesh& mesh, auto&& is_meant) {
  std::map<Tag, PlainElement> elements;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; is_meant(block) && e < block.size(); ++e) {
      PlainElement& plain = elements[block.tags[e]];
      plain = {block.entity, block.physical_groups, {}};
      for (const Index node : block.element(e)) plain.nodes.push_back(mesh.node_tags[node]);
    }
  return elements;
}

std::map<Tag, std::array<double, 3>> places_of(const Mesh& mesh, std::span<const Vec3> nodes) {
  std::map<Tag, std::array<double, 3>> places;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    places[mesh.node_tags[i]] = {nodes[i].x(), nodes[i].y(), nodes[i].z()};
  return places;
}

double volume(const Mesh& mesh, const std::vector<Vec3>& nodes) {
  double sum = 0;
  for (const Tag entity : {1, 2, 3}) sum += test::tetrahedron_volume(mesh, nodes, entity);
  return sum;
}

}  // namespace

#define NEEDS_GMSH \
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh"

TEST(RemeshVolume, WhatDoesNotTouchTheSurfaceComesOutIdentical) {
  NEEDS_GMSH;
  const Rough rough = roughened(ball_in_two_boxes());
  const RemeshedVolume result = remeshed(rough);
  const Mesh& mesh = *result.mesh;
  const auto is_kept = [](const ElementBlock& block) {
    return dimension(block.type.shape) < 3 || block.entity == 3;
  };
  EXPECT_EQ(elements_of(mesh, is_kept), elements_of(rough.mesh, is_kept));
  ASSERT_EQ(mesh.groups.size(), rough.mesh.groups.size());
  for (std::size_t g = 0; g < mesh.groups.size(); ++g)
    EXPECT_EQ(mesh.groups[g].name, rough.mesh.groups[g].name);

  const auto before = places_of(rough.mesh, rough.positions), after = places_of(mesh, mesh.nodes);
  for (const auto& [tag, element] : elements_of(mesh, is_kept))
    for (const Tag node : element.nodes) EXPECT_EQ(after.at(node), before.at(node));
  for (std::size_t i = 0; i < result.old_nodes.size(); ++i)
    EXPECT_EQ(mesh.node_tags[i], rough.mesh.node_tags[result.old_nodes[i]]);
}

// The box is unmoved, so that its volume is 8 as before; of the ball, what the rough sphere
// encloses. The sum of some 10^4 terms of one sign is exact to 1e-14.
TEST(RemeshVolume, NewElementsFillTheVolumesWithoutAFlatOne) {
  NEEDS_GMSH;
  const Rough rough = roughened(ball_in_two_boxes());
  EXPECT_FALSE(check_mesh(rough.mesh, rough.positions).valid());
  const RemeshedVolume result = remeshed(rough);
  const Mesh& mesh = *result.mesh;
  EXPECT_NEAR(volume(mesh, mesh.nodes), 8, 8e-13);
  std::vector<Vec3> points;
  for (Index p = 0; p < rough.surface.n_points(); ++p) points.push_back(Vec3::Zero());
  for (std::size_t i = 0; i < rough.surface.nodes.size(); ++i)
    points[rough.surface.point_of_node[i]] = rough.positions[rough.surface.nodes[i]];
  EXPECT_NEAR(test::tetrahedron_volume(mesh, mesh.nodes, 1), enclosed_volume(rough.surface, points),
              1e-13);
  EXPECT_GT(min_quality(mesh), 0.05);
  const auto n_of = [](const Mesh& m, std::size_t block) { return m.blocks[block].size(); };
  for (const std::size_t block : {2, 3}) {
    EXPECT_GT(2 * n_of(mesh, block), n_of(rough.mesh, block));
    EXPECT_LT(n_of(mesh, block), 2 * n_of(rough.mesh, block));
  }
}

TEST(RemeshVolume, NewNumbersFollowTheOldOnes) {
  NEEDS_GMSH;
  Rough rough = roughened(ball_in_two_boxes());
  rough.mesh.node_tags.back() = 1'000'000;
  rough.mesh.blocks[0].tags[0] = 2'000'000;
  const RemeshedVolume result = remeshed(rough);
  const std::vector<Tag>& tags = result.mesh->node_tags;
  const auto n_old = static_cast<std::ptrdiff_t>(result.old_nodes.size());
  EXPECT_GT(*std::min_element(tags.begin() + n_old, tags.end()), 1'000'000);
  EXPECT_EQ(std::set<Tag>(tags.begin(), tags.end()).size(), tags.size());
  const auto is_new = [](const ElementBlock& block) {
    return dimension(block.type.shape) == 3 && block.entity < 3;
  };
  const auto added = elements_of(*result.mesh, is_new);
  EXPECT_GT(added.begin()->first, 2'000'000);
  EXPECT_EQ(
      static_cast<std::int64_t>(elements_of(*result.mesh, [](const auto&) { return true; }).size()),
      n_elements(*result.mesh));
  std::set<Index> used;
  for (const ElementBlock& block : result.mesh->blocks)
    used.insert(block.nodes.begin(), block.nodes.end());
  EXPECT_EQ(used.size(), tags.size());
}

TEST(RemeshVolume, EqualInputGivesEqualMeshes) {
  NEEDS_GMSH;
  const Rough rough = roughened(test::ball_in_box(16));
  const RemeshedVolume a = remeshed(rough), b = remeshed(rough);
  EXPECT_EQ(a.mesh->nodes, b.mesh->nodes);
  ASSERT_EQ(a.mesh->blocks.size(), b.mesh->blocks.size());
  for (std::size_t k = 0; k < a.mesh->blocks.size(); ++k)
    EXPECT_EQ(a.mesh->blocks[k].nodes, b.mesh->blocks[k].nodes);
}

// Files whose elements all run the other way round are common; solvers have adapted to them.
TEST(RemeshVolume, ElementsKeepTheirOrientation) {
  NEEDS_GMSH;
  Mesh turned = test::ball_in_box(8);
  for (Index e = 0; e < turned.blocks[2].size(); ++e) test::turn_element(turned.blocks[2], e);
  const Rough rough = roughened(turned, 0.5 * h);
  const RemeshedVolume result = remeshed(rough);
  EXPECT_LT(test::tetrahedron_volume(*result.mesh, result.mesh->nodes, 1), 0);
  EXPECT_GT(test::tetrahedron_volume(*result.mesh, result.mesh->nodes, 2), 0);
  EXPECT_GT(min_quality(*result.mesh), 0);
}
