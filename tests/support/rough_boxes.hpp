// SPDX-License-Identifier: BSD-3-Clause
// Boxes with a rough side, whose walls follow.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/periodic.hpp"
#include "roughmesh/walls.hpp"

#include "cells.hpp"
#include "only.hpp"

namespace roughmesh::test {

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

inline Moved move(Mesh mesh, const char* group, const Height& height,
                  const WallOptions& options = {}, VolumeMethod last = VolumeMethod::split) {
  Moved moved{std::move(mesh), {}, {}, {}, {}};
  moved.surface = select_surface(moved.mesh, {.groups = {group}});
  const PeriodicPartners partners = periodic_partners(moved.mesh, moved.surface, options.period);
  moved.surface = with_partner_normals(moved.surface, partners);
  const auto surfaces = only(moved.surface);
  moved.walls = find_walls(moved.mesh, surfaces, options);
  std::vector<double> heights;
  for (const Index master : partners.master)
    heights.push_back(height(moved.surface.points[master]));
  std::vector<EdgeOptions> edges(1);
  edges[0].images = partners.master;
  const SurfaceMover surface_mover(
      surfaces, edges, {.fixed = {}, .sliding = sliding_on_surfaces(moved.walls, surfaces)});
  const std::vector<Vec3> displacements = surface_mover.move({&heights, 1}).displacements;
  const MovedVolume volume =
      VolumeMover(moved.mesh, surfaces, moved.walls, last).move(displacements);
  EXPECT_EQ(volume.split, nullptr);
  moved.nodes = volume.nodes;
  moved.method = volume.method;
  return moved;
}

inline double waves(const Vec3& x) {
  return std::sin(7 * x.x() + 1) * std::cos(6 * x.y() - x.x()) + 0.3 * std::sin(5 * x.z());
}

// The box without faces in its middle, which would stay.
inline Mesh box(int divisions) {
  Mesh mesh = cell_box(ElementShape::tetrahedron, divisions);
  mesh.blocks.erase(mesh.blocks.begin());
  std::erase_if(mesh.groups, [](const PhysicalGroup& group) { return group.name == "middle"; });
  return mesh;
}

// A top of hills, of period 1, whose normals lead off the sides.
inline Mesh hilly(Mesh mesh) {
  using std::numbers::pi;
  for (Vec3& x : mesh.nodes)
    x.z() *= 1 + 0.06 * std::sin(2 * pi * x.x() + 1) * std::cos(2 * pi * x.y() - 0.5);
  return mesh;
}

inline bool is_on_side(const Vec3& x) {
  return x.head<2>().minCoeff() == 0 || x.head<2>().maxCoeff() == 1;
}

inline const Eigen::Affine3d turned(Eigen::Translation3d(3, -2, 1) *
                                    Eigen::AngleAxisd(0.7, Vec3(1, 2, 0.5).normalized()));

// Faces of the box on which `is_on` holds, as elements of a group of their own.
inline void add_group(
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
  mesh.blocks.push_back(make_block(triangle_type, tag, {tag}, std::move(triangles), 100'000 * tag));
  mesh.groups.push_back({2, tag, name});
}

}  // namespace roughmesh::test
