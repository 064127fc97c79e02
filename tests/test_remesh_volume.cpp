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
#include "roughmesh/pipeline.hpp"

#include "remesh_volume.hpp"
#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;
using namespace roughmesh::detail;

namespace {

// Cells of the ball have edges of 1/8.
constexpr double h = 0.125;

// A ball in a box in a thick shell: volumes "inside", "outside" and "far", which nothing touches.
Mesh ball_in_two_boxes() {
  Mesh mesh = test::ball_in_box(16);
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
  std::vector<Vec3> points(rough.surface.points.size());
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

// The boundary is that of the input where it went to, whatever the elements say.
TEST(RemeshVolume, AMissingElementIsFoundByTheSumOfVolumes) {
  NEEDS_GMSH;
  Rough rough = roughened(test::ball_in_box(8), 0.3 * h);
  for (Vec3& x : rough.positions) x.x() *= 1.5;  // the boundary too
  const RemeshedVolume result = remeshed(rough);
  const Enclosure enclosure(rough.mesh);
  EXPECT_TRUE(check_remeshed(*result.mesh, rough.positions, enclosure).valid());
  Mesh torn = *result.mesh;
  std::vector<Index>& nodes = torn.blocks[3].nodes;
  nodes.erase(nodes.end() - 4, nodes.end());
  torn.blocks[3].tags.pop_back();
  const MeshCheck check = check_remeshed(torn, rough.positions, enclosure);
  EXPECT_FALSE(check.valid());
  EXPECT_GT(check.volume_error.value(), 1e-6);
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
TEST(RemeshVolume, WhereNothingMovesTheMeshStays) {
  const Mesh mesh = ball_in_two_boxes();
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const RemeshedVolume same = VolumeRemesher(mesh, test::only(surface), {}).remesh(mesh.nodes);
  EXPECT_EQ(same.mesh->nodes, mesh.nodes);
  EXPECT_EQ(n_elements(*same.mesh), n_elements(mesh));
  EXPECT_EQ(same.old_nodes.size(), mesh.nodes.size());
}

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

// Nodes on the edges of faces stay those of the faces, curved as they are; everywhere else edges
// are straight, each with one node of its own.
TEST(RemeshVolume, MeshesOfSecondOrderKeepTheNodesOfTheirFaces) {
  NEEDS_GMSH;
  const Rough rough = roughened(test::second_order(test::ball_in_box(8), true), 0.8 * h);
  const RemeshedVolume result = remeshed(rough);
  const Mesh& mesh = *result.mesh;
  const auto is_face = [](const ElementBlock& block) { return dimension(block.type.shape) == 2; };
  EXPECT_EQ(elements_of(mesh, is_face), elements_of(rough.mesh, is_face));
  std::map<std::pair<Index, Index>, Index> on_faces, on_edges;
  const auto add = [](const ElementBlock& block, auto& middles) {
    const auto n_corners_of = static_cast<std::size_t>(n_corners(block.type.shape));
    for (Index e = 0; e < block.size(); ++e)
      for (std::size_t k = 0; k < local_edges(block.type.shape).size(); ++k) {
        const auto nodes = block.element(e);
        const auto [i, j] = local_edges(block.type.shape)[k];
        const Index middle = nodes[n_corners_of + k];
        const auto [at, is_new] = middles.emplace(std::minmax(nodes[i], nodes[j]), middle);
        EXPECT_EQ(at->second, middle);
      }
  };
  for (const ElementBlock& block : mesh.blocks) add(block, is_face(block) ? on_faces : on_edges);
  for (const auto& [edge, middle] : on_faces) EXPECT_EQ(on_edges.at(edge), middle);
  Index n_bent = 0;
  for (const auto& [edge, middle] : on_edges) {
    const Vec3 straight = (mesh.nodes[edge.first] + mesh.nodes[edge.second]) / 2;
    const double offset = (mesh.nodes[middle] - straight).norm();
    if (!on_faces.contains(edge)) {
      EXPECT_LT(offset, 1e-15);
    }
    n_bent += offset > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(n_bent, 0);  // the surface is curved
  EXPECT_NEAR(volume(mesh, mesh.nodes), 8, 8e-13);
  for (std::size_t i = 0; i < rough.surface.nodes.size(); ++i) {
    const auto at =
        std::lower_bound(result.old_nodes.begin(), result.old_nodes.end(), rough.surface.nodes[i]);
    ASSERT_TRUE(at != result.old_nodes.end() && *at == rough.surface.nodes[i]);
    EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(at - result.old_nodes.begin())],
              rough.positions[rough.surface.nodes[i]]);
  }
}

// A slab raised by one height: edges between nodes that moved and nodes that stay on the walls are
// as straight as before.
TEST(RemeshVolume, NodesOnEdgesOfWallsFollowTheirEnds) {
  NEEDS_GMSH;
  Mesh mesh = test::second_order(test::cell_box(ElementShape::tetrahedron, 4), true);
  mesh.groups[0].name = "surface";
  Rough rough = roughened(mesh, 0);
  for (const Index node : rough.surface.nodes) rough.positions[node].z() += 0.05;
  const Mesh result = *remeshed(rough).mesh;
  for (const ElementBlock& block : result.blocks)
    for (Index e = 0; e < block.size(); ++e)
      for (std::size_t k = 0; k < local_edges(block.type.shape).size(); ++k) {
        const auto nodes = block.element(e);
        const auto [i, j] = local_edges(block.type.shape)[k];
        const Index middle = nodes[static_cast<std::size_t>(n_corners(block.type.shape)) + k];
        EXPECT_LT(
            (result.nodes[nodes[i]] + result.nodes[nodes[j]] - 2 * result.nodes[middle]).norm(),
            1e-15);
      }
  EXPECT_NEAR(test::tetrahedron_volume(result, result.nodes, 1), 0.55, 1e-13);
}

// Its height may be 0 while its ends move.
TEST(RemeshVolume, NodesOfTheSurfaceStayWhereTheyAreTold) {
  NEEDS_GMSH;
  Mesh mesh = test::second_order(test::cell_box(ElementShape::tetrahedron, 4), true);
  mesh.groups[0].name = "surface";
  Rough rough = roughened(mesh, 0);
  const std::vector<Index> held = {rough.surface.face(3)[3], rough.surface.face(9)[4]};
  for (const Index point : rough.surface.nodes)
    if (std::find(held.begin(), held.end(), point) == held.end())
      rough.positions[point].z() += 0.01;
  const RemeshedVolume result = remeshed(rough);
  for (const Index node : held) {
    const auto at = std::find(result.old_nodes.begin(), result.old_nodes.end(), node);
    ASSERT_NE(at, result.old_nodes.end());
    EXPECT_EQ(result.mesh->nodes[static_cast<std::size_t>(at - result.old_nodes.begin())],
              mesh.nodes[node]);
  }
}

// Its boundary is two surfaces with nothing on their other sides: what gmsh fills must be between
// them.
TEST(RemeshVolume, ACavityStaysEmpty) {
  NEEDS_GMSH;
  Mesh shell = test::ball_in_box(16);
  const double ball = test::tetrahedron_volume(shell, shell.nodes, 1);
  shell.blocks.erase(shell.blocks.begin() + 2);
  Rough rough = roughened(shell, 0);
  for (const Index node : rough.surface.nodes) rough.positions[node] *= 1.2;
  const Mesh result = *remeshed(rough).mesh;
  EXPECT_NEAR(test::tetrahedron_volume(result, result.nodes), 8 - 1.2 * 1.2 * 1.2 * ball, 1e-12);
}

// One volume with an open sheet of rough faces in its middle: no element may cross it.
TEST(RemeshVolume, ASurfaceInsideAVolumeIsKept) {
  NEEDS_GMSH;
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 8);
  ElementBlock& cells = mesh.blocks[2];
  cells.nodes.insert(cells.nodes.end(), mesh.blocks[3].nodes.begin(), mesh.blocks[3].nodes.end());
  cells.tags.insert(cells.tags.end(), mesh.blocks[3].tags.begin(), mesh.blocks[3].tags.end());
  mesh.blocks.pop_back();
  const ElementBlock all = mesh.blocks[0];
  mesh.blocks[0].nodes.clear();
  mesh.blocks[0].tags.clear();
  for (Index e = 0; e < all.size(); ++e) {
    const auto nodes = all.element(e);
    const bool is_within = std::all_of(nodes.begin(), nodes.end(), [&](Index node) {
      const Vec3& x = mesh.nodes[node];
      return std::max(std::abs(x.x() - 0.5), std::abs(x.y() - 0.5)) < 0.3;
    });
    if (!is_within) continue;
    mesh.blocks[0].nodes.insert(mesh.blocks[0].nodes.end(), nodes.begin(), nodes.end());
    mesh.blocks[0].tags.push_back(all.tags[e]);
  }
  mesh.groups[0].name = "surface";
  const Rough rough = roughened(mesh, 0.1);
  const Mesh result = *remeshed(rough).mesh;
  EXPECT_NEAR(test::tetrahedron_volume(result, result.nodes), 1, 1e-13);
  std::set<std::set<Index>> sides;
  for (Index e = 0; e < result.blocks[2].size(); ++e)
    for (const std::vector<int>& local : local_faces(ElementShape::tetrahedron)) {
      const auto nodes = result.blocks[2].element(e);
      sides.insert({nodes[local[0]], nodes[local[1]], nodes[local[2]]});
    }
  for (Index e = 0; e < result.blocks[0].size(); ++e) {
    const auto nodes = result.blocks[0].element(e);
    EXPECT_TRUE(sides.contains({nodes.begin(), nodes.end()}));
  }
}

TEST(RemeshVolume, WhatWouldBeLostIsRefused) {
  const auto message = [](const Mesh& mesh, const char* group) {
    const Surface surface = select_surface(mesh, {.groups = {group}});
    return test::message_of([&] { VolumeRemesher(mesh, test::only(surface), {}); });
  };
  const auto expect_part = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), text.npos) << text;
  };
  for (const ElementShape shape :
       {ElementShape::hexahedron, ElementShape::prism, ElementShape::pyramid})
    expect_part(message(test::cell_box(shape, 4), "middle"), "tetrahedra only");
  const Mesh ball = test::ball_in_box(8);
  const Index middle = ball.n_nodes() / 2;  // of the ball
  Mesh with_point = ball;
  with_point.blocks.push_back(test::make_block(test::point_type, 1, {1}, {middle}, 90'001));
  expect_part(message(with_point, "surface"), "element 90001 (point) lies inside a volume");
  Mesh with_link = ball;
  with_link.periodic_links.push_back({3, 1, 2, {}, {{middle, 0}}});
  expect_part(message(with_link, "surface"), "periodic node");
  Mesh with_copy = ball;
  with_copy.blocks.push_back(with_copy.blocks[2]);
  expect_part(message(with_copy, "surface"), "share a side");
  // A line that joins two nodes of faces inside a volume, on no face.
  Mesh with_line = test::cell_box(ElementShape::tetrahedron, 2);
  with_line.blocks.push_back(test::make_block(test::line_type, 1, {1}, {0, 13}, 90'001));
  expect_part(message(with_line, "middle"), "the line between nodes 1 and 14");
}

namespace {

// Flat tetrahedra with four nodes on the sphere cannot be split where they are of second order.
RoughenOptions too_rough() {
  RoughenOptions options;
  options.surfaces[0].group = {"surface"};
  options.surfaces[0].rms = 0.05;
  options.surfaces[0].length = {0.3};
  return options;
}

Report run(const Mesh& mesh, const RoughenOptions& options) {
  return roughen(mesh, options, [&](const RoughMesh& rough, Report& report) {
    EXPECT_TRUE(rough.check.valid());
    EXPECT_EQ(report.realizations.back().min_quality, min_quality(rough.mesh));
    EXPECT_EQ(rough.heights.size(), rough.mesh.nodes.size());
    // Nodes of the surface keep their heights, in whatever place they stand.
    std::map<Tag, Vec3> before;
    for (Index node = 0; node < mesh.n_nodes(); ++node)
      before[mesh.node_tags[node]] = mesh.nodes[node];
    for (std::size_t i = 0; i < rough.heights.size(); ++i) {
      if (rough.heights[i] == 0) continue;
      EXPECT_EQ(rough.mesh.nodes[i] - before.at(rough.mesh.node_tags[i]), rough.displacements[i]);
      EXPECT_NEAR(rough.displacements[i].dot(rough.normals[i]), rough.heights[i], 1e-12);
    }
  });
}

}  // namespace

TEST(RemeshVolume, IsTheLastResortOfMoving) {
  NEEDS_GMSH;
  const Mesh mesh = test::second_order(test::ball_in_box(16), true);
  const Report report = run(mesh, too_rough());
  EXPECT_EQ(name(report.realizations[0].volume_method), "remesh");
  EXPECT_EQ(std::count_if(report.warnings.begin(), report.warnings.end(),
                          [](const std::string& w) { return w.find("anew") != w.npos; }),
            1);
  RoughenOptions without = too_rough();
  without.gmsh = "/nonexistent/gmsh";
  try {
    run(mesh, without);
    FAIL();
  } catch (const CheckError& error) {
    EXPECT_NE(std::string(error.what()).find("with the gmsh program (--gmsh PATH)"),
              std::string::npos);
  }
}

// A realization on elements of its own, then one on those of the input, in either order.
TEST(RemeshVolume, WholeRunsHandOverWhatTheyChecked) {
  NEEDS_GMSH;
  const Mesh mesh = test::ball_in_box(16);
  RoughenOptions options = too_rough();
  options.volume = VolumeChoice::remesh;
  options.realizations = 2;
  const Report report = run(mesh, options);
  for (const RealizationReport& realization : report.realizations)
    EXPECT_EQ(name(realization.volume_method), "remesh");
  options.box = 2;
  EXPECT_THROW(run(mesh, options), InputError);
}
