// SPDX-License-Identifier: BSD-3-Clause
// Stages after the harmonic extension: when they run, and what they may touch.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/pipeline.hpp"

#include "parallel.hpp"
#include "split_trapped.hpp"
#include "support/cells.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "volume_faces.hpp"

using namespace roughmesh;

namespace {

constexpr std::array volume_shapes = {ElementShape::tetrahedron, ElementShape::hexahedron,
                                      ElementShape::prism, ElementShape::pyramid};

struct Rough {
  Mesh mesh;
  Surface surface;
  std::vector<Vec3> displacements;

  MovedVolume moved(VolumeMethod last = VolumeMethod::split) const {
    return VolumeMover(mesh, test::only(surface), last).move(displacements);
  }
};

Rough make_rough(Mesh mesh, const char* group, const std::function<double(const Vec3&)>& height) {
  Surface surface = select_surface(mesh, {.groups = {group}});
  std::vector<double> heights;
  for (const Vec3& x : surface.points) heights.push_back(height(x));
  std::vector<Vec3> displacements = displace_nodes(test::only(surface), {&heights, 1});
  return {std::move(mesh), std::move(surface), std::move(displacements)};
}

// Waves on the plane in the middle of a box with cells of size 1/12, gone at the walls. Its valleys
// and peaks reach `height` deep.
Rough rough_box(ElementShape shape, double height) {
  using std::numbers::pi;
  return make_rough(test::cell_box(shape, 12), "middle", [&](const Vec3& x) {
    const double fade = std::sin(pi * x.x()) * std::sin(pi * x.y());
    return height * std::sqrt(fade) * std::sin(5 * pi * x.x()) * std::sin(4 * pi * x.y());
  });
}

// Tetrahedra beside the sphere that are nearly flat, with four nodes on it.
Rough rough_ball(double height) {
  return make_rough(test::ball_in_box(16), "surface", [&](const Vec3& x) {
    return height * std::sin(14 * x.x()) * std::cos(12 * x.y() + 9 * x.z());
  });
}

void expect_only_free_nodes_moved(const Rough& rough, const std::vector<Vec3>& nodes,
                                  const std::function<bool(const Vec3&)>& on_wall) {
  const Surface& surface = rough.surface;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    EXPECT_EQ(nodes[surface.nodes[i]], rough.mesh.nodes[surface.nodes[i]] + rough.displacements[i]);
  const std::set<Index> on_surface(surface.nodes.begin(), surface.nodes.end());
  for (Index node = 0; node < rough.mesh.n_nodes(); ++node)
    EXPECT_TRUE(on_surface.contains(node) || !on_wall(rough.mesh.nodes[node]) ||
                nodes[node] == rough.mesh.nodes[node]);
}

bool on_unit_box(const Vec3& x) { return x.minCoeff() == 0 || x.maxCoeff() == 1; }
bool on_box(const Vec3& x) { return x.lpNorm<Eigen::Infinity>() > 1 - 1e-12; }

}  // namespace

TEST(RepairVolume, MildRoughnessIsLeftToTheHarmonicExtension) {
  for (const ElementShape shape : volume_shapes) {
    const Rough rough = rough_box(shape, 0.01);
    const MovedVolume moved = rough.moved();
    EXPECT_EQ(moved.method, VolumeMethod::harmonic);
    EXPECT_EQ(moved.nodes, rough.moved(VolumeMethod::harmonic).nodes);
  }
}

// Heights of 1.6 cells.
TEST(RepairVolume, InvertedElementsOfEveryShapeAreTurnedBack) {
  for (const ElementShape shape : volume_shapes) {
    const Rough rough = rough_box(shape, 1.6 / 12);
    EXPECT_FALSE(check_mesh(rough.mesh, rough.moved(VolumeMethod::harmonic).nodes).valid());
    const MovedVolume moved = rough.moved();
    EXPECT_EQ(name(moved.method), "foldover-free");
    EXPECT_EQ(moved.split, nullptr);
    EXPECT_TRUE(check_mesh(rough.mesh, moved.nodes).valid());
    expect_only_free_nodes_moved(rough, moved.nodes, on_unit_box);
  }
}

TEST(RepairVolume, PoorElementsAreImproved) {
  const Rough rough = rough_box(ElementShape::tetrahedron, 1.2 / 12);
  const MeshCheck before = check_mesh(rough.mesh, rough.moved(VolumeMethod::harmonic).nodes);
  EXPECT_TRUE(before.valid());
  const MovedVolume moved = rough.moved();
  EXPECT_EQ(name(moved.method), "foldover-free");
  EXPECT_GT(check_mesh(rough.mesh, moved.nodes).min_quality, 1.3 * before.min_quality);
}

TEST(RepairVolume, RoughCurvesOfPlanarMeshes) {
  for (const bool quadrangles : {false, true}) {
    const Rough rough = make_rough(test::ring(80, quadrangles), "interface", [](const Vec3& x) {
      return 0.1 * std::sin(11 * std::atan2(x.y(), x.x()));
    });
    EXPECT_FALSE(check_mesh(rough.mesh, rough.moved(VolumeMethod::harmonic).nodes).valid());
    const MovedVolume moved = rough.moved();
    EXPECT_EQ(name(moved.method), "foldover-free");
    EXPECT_TRUE(check_mesh(rough.mesh, moved.nodes).valid());
    for (const Vec3& x : moved.nodes) EXPECT_EQ(x.z(), 0);
    expect_only_free_nodes_moved(rough, moved.nodes, [](const Vec3& x) {
      return x.norm() < 0.25 + 1e-12 || x.norm() > 1 - 1e-12;
    });
  }
}

TEST(RepairVolume, DoesNotDependOnTheNumberOfThreads) {
  const Rough box = rough_box(ElementShape::tetrahedron, 1.6 / 12), ball = rough_ball(0.05);
  const auto run = [](const Rough& rough, int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return rough.moved().nodes;
  };
  for (const Rough* rough : {&box, &ball}) {
    const std::vector<Vec3> one = run(*rough, 1);
    EXPECT_EQ(run(*rough, 2), one);
    EXPECT_EQ(run(*rough, 7), one);
  }
}

// What the split may change: elements of one volume, and no face that is an element or lies on the
// boundary. Volumes and faces that fit together are those of the elements before.
TEST(RepairVolume, TrappedElementsAreSplit) {
  const Rough rough = rough_ball(0.05);
  EXPECT_FALSE(check_mesh(rough.mesh, rough.moved(VolumeMethod::foldover_free).nodes).valid());
  const MovedVolume moved = rough.moved();
  ASSERT_EQ(name(moved.method), "split");
  ASSERT_NE(moved.split, nullptr);
  const Mesh& split = *moved.split;
  EXPECT_EQ(moved.nodes.size(), split.nodes.size());
  EXPECT_TRUE(check_mesh(split, moved.nodes).valid());
  expect_only_free_nodes_moved(rough, moved.nodes, on_box);

  EXPECT_TRUE(std::equal(rough.mesh.nodes.begin(), rough.mesh.nodes.end(), split.nodes.begin()));
  ASSERT_EQ(split.blocks.size(), rough.mesh.blocks.size());
  for (const std::size_t faces : {0, 1}) {
    EXPECT_EQ(split.blocks[faces].nodes, rough.mesh.blocks[faces].nodes);
    EXPECT_EQ(split.blocks[faces].tags, rough.mesh.blocks[faces].tags);
  }
  std::set<Tag> tags, node_tags(split.node_tags.begin(), split.node_tags.end());
  for (std::size_t b = 0; b < split.blocks.size(); ++b) {
    const ElementBlock &after = split.blocks[b], &before = rough.mesh.blocks[b];
    EXPECT_EQ(after.physical_groups, before.physical_groups);
    EXPECT_EQ(after.entity, before.entity);
    tags.insert(after.tags.begin(), after.tags.end());
  }
  EXPECT_EQ(static_cast<std::int64_t>(tags.size()), n_elements(split));
  EXPECT_EQ(node_tags.size(), split.nodes.size());
  EXPECT_GT(n_elements(split, 3), n_elements(rough.mesh, 3));
  EXPECT_LT(n_elements(split, 3), n_elements(rough.mesh, 3) * 11 / 10);
  for (const Tag volume : {1, 2})
    EXPECT_NEAR(test::tetrahedron_volume(split, split.nodes, volume),
                test::tetrahedron_volume(rough.mesh, rough.mesh.nodes, volume), 1e-12);
  const auto n_boundary = [](const Mesh& mesh) { return detail::boundary_faces(mesh, 3).size(); };
  EXPECT_EQ(n_boundary(split), n_boundary(rough.mesh));
}

// From file to file: the new nodes and elements are in the groups of those that were split, and
// neither the realization before nor the one after has any.
TEST(RepairVolume, ASplitMeshIsWrittenWithItsGroups) {
  const test::TemporaryFolder folder;
  write_mesh(test::ball_in_box(16), folder / "smooth.msh");
  const Mesh smooth = read_mesh(folder / "smooth.msh");
  RoughenOptions options;
  options.surfaces[0].group = {"surface"};
  options.surfaces[0].rms = 0.014;
  options.surfaces[0].length = {0.3};
  options.first = 34;  // 37 and 38, 40 and 41 are split at different edges, as many each
  options.realizations = 8;
  std::map<VolumeMethod, int> n_of_method;
  const std::int64_t n_elements_of_smooth = n_elements(smooth);
  const Report report = roughen(smooth, options, [&](const RoughMesh& rough, Report& partial) {
    const VolumeMethod method = partial.realizations.back().volume_method;
    ++n_of_method[method];
    EXPECT_EQ(rough.mesh.nodes.size() > smooth.nodes.size(), method == VolumeMethod::split);
    EXPECT_EQ(n_elements(rough.mesh) > n_elements_of_smooth, method == VolumeMethod::split);
    // What is handed over is what was checked: elements of this split, not of the one before.
    EXPECT_EQ(min_quality(rough.mesh), rough.check.min_quality) << rough.realization;
    EXPECT_EQ(rough.heights.size(), rough.mesh.nodes.size());
    EXPECT_EQ(rough.normals.size(), rough.mesh.nodes.size());
    EXPECT_EQ(rough.displacements.size(), rough.mesh.nodes.size());
    EXPECT_EQ(partial.realizations.back().inverted_elements, 0);
    write_mesh(rough.mesh, folder / "rough.msh");
    const Mesh again = read_mesh(folder / "rough.msh");
    EXPECT_EQ(again.nodes, rough.mesh.nodes);
    ASSERT_EQ(again.groups.size(), smooth.groups.size());
    for (std::size_t g = 0; g < again.groups.size(); ++g)
      EXPECT_EQ(again.groups[g].name, smooth.groups[g].name);
    for (const Tag volume : {1, 2})
      EXPECT_NEAR(test::tetrahedron_volume(again, again.nodes, volume),
                  test::tetrahedron_volume(rough.mesh, rough.mesh.nodes, volume), 1e-12);
  });
  EXPECT_GT(n_of_method[VolumeMethod::split], 0);
  EXPECT_LT(n_of_method[VolumeMethod::split], 8);
  const auto warns = [](const std::string& w) { return w.find("split") != std::string::npos; };
  EXPECT_EQ(std::count_if(report.warnings.begin(), report.warnings.end(), warns),
            n_of_method[VolumeMethod::split]);
}

// A lid below the bottom: nothing to be done, and no time lost on it.
TEST(RepairVolume, TheImpossibleIsLeftInverted) {
  for (const ElementShape shape : volume_shapes) {
    const Rough rough =
        make_rough(test::cell_box(shape, 4), "top", [](const Vec3&) { return -1.2; });
    const MovedVolume moved = rough.moved();
    const Mesh& mesh = moved.split ? *moved.split : rough.mesh;
    EXPECT_FALSE(check_mesh(mesh, moved.nodes).valid());
  }
}

// Of an element of volume V in a sum of N, round-off is 1e-16 V.
TEST(Enclosure, VolumesAddUpToWhatTheBoundaryEncloses) {
  for (const ElementShape shape : volume_shapes) {
    const Rough rough = rough_box(shape, 0.05);
    const Enclosure enclosure(rough.mesh);
    std::vector<Vec3> moved = rough.moved().nodes;
    for (Vec3& x : moved) x.z() += 0.1 * std::sin(3 * x.x()) * x.y();  // the boundary too
    const MeshCheck check = check_mesh(rough.mesh, moved, enclosure);
    ASSERT_TRUE(check.volume_error.has_value());
    EXPECT_LT(*check.volume_error, 1e-14);
    EXPECT_TRUE(check.valid());
  }
}

TEST(Enclosure, AMissingOrDoubledElementIsAFinding) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const Enclosure enclosure(mesh);
  const auto expect_error = [&](double error) {
    const MeshCheck check = check_mesh(mesh, mesh.nodes, enclosure);
    ASSERT_TRUE(check.volume_error.has_value());
    EXPECT_NEAR(*check.volume_error, error, 1e-13);
    EXPECT_FALSE(check.valid());
    EXPECT_EQ(check.inverted_elements, 0);
    EXPECT_NE(check.findings.back().what.find("do not add up"), std::string::npos);
  };
  ElementBlock& block = mesh.blocks[3];
  block.nodes.resize(block.nodes.size() - 4);
  block.tags.pop_back();
  expect_error(1.0 / 384);  // of 6 * 4^3 tetrahedra of one volume
  for (int k = 0; k < 8; ++k) block.nodes.push_back(block.nodes[static_cast<std::size_t>(k % 4)]);
  block.tags.insert(block.tags.end(), {90'001, 90'002});
  expect_error(1.0 / 384);
}

TEST(Enclosure, PlanarMeshes) {
  for (const bool quadrangles : {false, true}) {
    const Mesh mesh = test::ring(40, quadrangles);
    const MeshCheck check = check_mesh(mesh, mesh.nodes, Enclosure(mesh));
    ASSERT_TRUE(check.volume_error.has_value());
    EXPECT_LT(*check.volume_error, 1e-14);
  }
}

// Where the input does not add up, nothing can be told.
TEST(Enclosure, RepeatedOrTurnedElementsAndSurfacesAreNotCompared) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  mesh.blocks.push_back(mesh.blocks[3]);
  EXPECT_FALSE(check_mesh(mesh, mesh.nodes, Enclosure(mesh)).volume_error.has_value());
  mesh.blocks.pop_back();
  test::turn_element(mesh.blocks[3], 0);
  EXPECT_FALSE(check_mesh(mesh, mesh.nodes, Enclosure(mesh)).volume_error.has_value());
  const Mesh sphere = test::icosphere(1);
  EXPECT_FALSE(check_mesh(sphere, sphere.nodes, Enclosure(sphere)).volume_error.has_value());
}
