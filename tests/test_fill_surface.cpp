// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces become volumes: which, in what groups, and how much they hold.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/pipeline.hpp"

#include "fill_surface.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;
using namespace roughmesh::detail;

namespace {

#define NEEDS_GMSH \
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh"

void add_sphere(Mesh& mesh, int subdivisions, double radius, const Vec3& centre) {
  const Mesh sphere = test::icosphere(subdivisions, radius);
  const Index first = mesh.n_nodes();
  for (const Vec3& x : sphere.nodes) mesh.nodes.push_back(x + centre);
  test::number_nodes(mesh);
  std::vector<Index> nodes = sphere.blocks[0].nodes;
  for (Index& node : nodes) node += first;
  const Tag tag = n_elements(mesh) + 1;
  mesh.blocks.push_back(test::make_block(test::triangle_type, 0, {}, std::move(nodes), tag));
}

// From the second largest to the smallest: two beside each other in one, and one alone outside.
Mesh nested_spheres() {
  Mesh mesh;
  add_sphere(mesh, 2, 0.4, {-1, 0, 0});
  add_sphere(mesh, 2, 2.0, {0, 0, 0});
  add_sphere(mesh, 2, 0.5, {1, 0, 0});
  add_sphere(mesh, 2, 0.2, {1, 0, 0});
  add_sphere(mesh, 2, 0.5, {5, 0, 0});
  return mesh;
}

// Of a polyhedron inscribed in a sphere.
double volume_of(const Mesh& mesh, std::size_t block) {
  double sum = 0;
  for (Index e = 0; e < mesh.blocks[block].size(); ++e) {
    const auto n = mesh.blocks[block].element(e);
    const Vec3 &a = mesh.nodes[n[0]], &b = mesh.nodes[n[1]], &c = mesh.nodes[n[2]];
    sum += mesh.blocks[block].type.shape == ElementShape::triangle
               ? a.cross(b).dot(c) / 6
               : (b - a).cross(c - a).dot(mesh.nodes[n[3]] - a) / 6;
  }
  return sum;
}

std::map<std::string, double> volumes_by_group(const Mesh& mesh) {
  std::map<std::string, double> volumes;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (const PhysicalGroup& group : mesh.groups)
      if (group.dimension == 3 && dimension(mesh.blocks[b].type.shape) == 3 &&
          mesh.blocks[b].physical_groups == std::vector<Tag>{group.tag})
        volumes[group.name] += volume_of(mesh, b);
  return volumes;
}

bool has_group(const Mesh& mesh, int dim, const std::string& name) {
  return std::any_of(mesh.groups.begin(), mesh.groups.end(), [&](const PhysicalGroup& group) {
    return group.dimension == dim && group.name == name;
  });
}

}  // namespace

TEST(NestedSurfaces, TheInnermostOneAroundIsFound) {
  const NestedSurfaces nested = find_nested_surfaces(nested_spheres());
  ASSERT_EQ(nested.components.size(), 5U);
  std::vector<Index> around;
  for (const auto& component : nested.components) around.push_back(component.around);
  EXPECT_EQ(around, (std::vector<Index>{1, -1, 1, 2, -1}));
}

// The sum over a closed surface is a whole number up to round-off of its 320 terms.
TEST(NestedSurfaces, AClosedSurfaceGoesRoundItsInsideOnce) {
  const Mesh mesh = test::icosphere(2);
  const auto sphere = find_nested_surfaces(mesh).components.front();
  EXPECT_NEAR(winding_number(sphere.triangles, mesh.nodes, {0.3, -0.2, 0.1}), 1, 1e-13);
  EXPECT_NEAR(winding_number(sphere.triangles, mesh.nodes, {1.2, 0, 0}), 0, 1e-13);
}

TEST(FillSurface, ASphereIsFilled) {
  NEEDS_GMSH;
  const Mesh sphere = test::icosphere(3);
  const RemeshedVolume filled = SurfaceFiller(sphere, std::nullopt, {}).fill(sphere.nodes);
  const Mesh& mesh = *filled.mesh;
  ASSERT_EQ(mesh.blocks.size(), 2U);
  EXPECT_EQ(mesh.blocks[0].nodes, sphere.blocks[0].nodes);
  EXPECT_TRUE(std::equal(sphere.nodes.begin(), sphere.nodes.end(), mesh.nodes.begin()));
  EXPECT_NEAR(volumes_by_group(mesh).at("inside"), volume_of(sphere, 0), 1e-13);
  EXPECT_TRUE(has_group(mesh, 2, "surface"));
  EXPECT_FALSE(has_group(mesh, 2, "box"));
  EXPECT_GT(min_quality(mesh), 0.05);
}

TEST(FillSurface, ABoxIsAddedAround) {
  NEEDS_GMSH;
  const Mesh sphere = test::icosphere(3);
  Mesh mesh = *SurfaceFiller(sphere, 2.5, {}).fill(sphere.nodes).mesh;
  const auto volumes = volumes_by_group(mesh);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : sphere.nodes) box.extend(x);
  const double of_box = 2.5 * 2.5 * 2.5 * box.volume();
  EXPECT_EQ(volumes.size(), 2U);
  EXPECT_NEAR(volumes.at("inside"), volume_of(sphere, 0), 1e-13);
  EXPECT_NEAR(volumes.at("inside") + volumes.at("outside"), of_box, 1e-12 * of_box);
  EXPECT_TRUE(has_group(mesh, 2, "box"));
  EXPECT_GT(min_quality(mesh), 0.05);
  EXPECT_EQ(mesh.blocks[1].physical_groups, std::vector<Tag>{2});
  EXPECT_NEAR(volume_of(mesh, 1), of_box, 1e-12 * of_box);  // the box is oriented outward
}

TEST(FillSurface, OneVolumeForEachRegionBetweenNestedSurfaces) {
  NEEDS_GMSH;
  const Mesh spheres = nested_spheres();
  const Mesh mesh = *SurfaceFiller(spheres, 1.5, {}).fill(spheres.nodes).mesh;
  std::vector<double> balls;
  for (std::size_t b = 0; b < 5; ++b) {
    const Mesh alone = test::icosphere(2, std::array{0.4, 2.0, 0.5, 0.2, 0.5}[b]);
    balls.push_back(volume_of(alone, 0));
  }
  auto volumes = volumes_by_group(mesh);
  ASSERT_EQ(volumes.size(), 6U);
  constexpr double round_off = 1e-12;
  EXPECT_NEAR(volumes["inside_1"], balls[0], round_off);
  EXPECT_NEAR(volumes["inside_2"], balls[1] - balls[0] - balls[2], 10 * round_off);
  EXPECT_NEAR(volumes["inside_3"], balls[2] - balls[3], round_off);
  EXPECT_NEAR(volumes["inside_4"], balls[3], round_off);
  EXPECT_NEAR(volumes["inside_5"], balls[4], round_off);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : spheres.nodes) box.extend(x);
  EXPECT_NEAR(volumes["outside"], 1.5 * 1.5 * 1.5 * box.volume() - balls[1] - balls[4], 1e-10);
}

TEST(FillSurface, WhatIsNotClosedIsRefused) {
  const auto message = [](const Mesh& mesh) {
    return test::message_of([&] { SurfaceFiller(mesh, std::nullopt, {}); });
  };
  Mesh open = test::icosphere(1);
  open.blocks[0].nodes.resize(open.blocks[0].nodes.size() - 3);
  open.blocks[0].tags.pop_back();
  EXPECT_NE(message(open).find("has 1 triangle: only a closed surface"), std::string::npos);
  Mesh doubled = test::icosphere(1);
  doubled.blocks.push_back(doubled.blocks[0]);
  EXPECT_NE(message(doubled).find("has 4 triangles"), std::string::npos);
  Mesh square = test::plate(1);
  square.blocks = {test::make_block({ElementShape::quadrangle, 1, 4}, 1, {1}, {0, 1, 3, 2}, 1)};
  EXPECT_NE(message(square).find("element 1 is a quadrangle"), std::string::npos);
  EXPECT_NE(message(Mesh{}).find("no closed surface"), std::string::npos);
}

TEST(FillSurface, ASurfaceThatReachesTheBoxIsACheckError) {
  const Mesh sphere = test::icosphere(1);
  std::vector<Vec3> high = sphere.nodes;
  high[5] *= 1.3;
  const SurfaceFiller filler(sphere, 1.1, {"/nonexistent", 1});
  EXPECT_THROW(filler.fill(high), CheckError);
}

// From file to file, with the heights of the input on its nodes and none on new ones.
TEST(FillSurface, ARoughSphereIsFilledByTheWholeRun) {
  NEEDS_GMSH;
  const Mesh sphere = test::icosphere(3);
  RoughenOptions options;
  options.surfaces[0].rms = 0.05;
  options.surfaces[0].length = {0.4};
  options.volume = VolumeChoice::remesh;
  options.box = 2;
  options.realizations = 2;
  roughen(sphere, options, [&](const RoughMesh& rough, Report& report) {
    EXPECT_EQ(name(report.realizations.back().volume_method), "remesh");
    EXPECT_TRUE(rough.check.valid());
    ASSERT_TRUE(rough.check.volume_error.has_value());
    const std::size_t n = sphere.nodes.size();
    ASSERT_GT(rough.mesh.nodes.size(), n);
    EXPECT_EQ(rough.heights.size(), rough.mesh.nodes.size());
    EXPECT_EQ(rough.normals.size(), rough.mesh.nodes.size());
    for (std::size_t i = 0; i < rough.mesh.nodes.size(); ++i) {
      if (i >= n) {
        EXPECT_EQ(rough.heights[i], 0);
        EXPECT_EQ(rough.displacements[i], Vec3::Zero());
        continue;
      }
      EXPECT_EQ(rough.mesh.nodes[i] - sphere.nodes[i], rough.displacements[i]);
      EXPECT_NEAR(rough.displacements[i].dot(rough.normals[i]), rough.heights[i], 1e-12);
    }
  });
}

TEST(FillSurface, RealSurfaces) {
  NEEDS_GMSH;
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "meshes";
  const Mesh cow = read_mesh(folder / "spot.ply");
  const Mesh mesh = *SurfaceFiller(cow, 2, {}).fill(cow.nodes).mesh;
  EXPECT_NEAR(volumes_by_group(mesh).at("inside"), std::abs(volume_of(cow, 0)), 1e-12);
  EXPECT_GT(min_quality(mesh), 0.01);
  const Mesh aorta = read_mesh(folder / "aorta.stl");  // open at its ends
  EXPECT_THROW(SurfaceFiller(aorta, 2, {}), InputError);
}
