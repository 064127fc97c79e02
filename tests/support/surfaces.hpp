// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of the meshes that tests make, without the selection and orientation of groups.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh::test {

/// The faces of a mesh of triangles as a surface, its nodes being distinct.
inline Surface surface_of(const Mesh& mesh) {
  Surface surface;
  std::vector<Index> order(mesh.nodes.size()), place(mesh.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    return std::lexicographical_compare(mesh.nodes[i].begin(), mesh.nodes[i].end(),
                                        mesh.nodes[j].begin(), mesh.nodes[j].end());
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = static_cast<Index>(i);
    surface.points.push_back(mesh.nodes[order[i]]);
  }
  surface.normals.assign(order.size(), Vec3::Zero());
  surface.areas.assign(order.size(), 0.0);
  surface.face_offsets = {0};
  std::vector<double> edges;
  std::map<std::pair<Index, Index>, int> faces_of_edge;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.size(); ++e) {
      for (int k = 0; k < 3; ++k) surface.face_points.push_back(place[block.element(e)[k]]);
      surface.face_offsets.push_back(static_cast<Index>(surface.face_points.size()));
      surface.face_tags.push_back(block.tags[e]);
      const auto face = surface.face(surface.n_faces() - 1);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a = surface.points[face[(k + 1) % 3]] - surface.points[face[k]];
        const Vec3 b = surface.points[face[(k + 2) % 3]] - surface.points[face[k]];
        surface.normals[face[k]] += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
        surface.areas[face[k]] += a.cross(b).norm() / 6;
        edges.push_back(a.norm());
        ++faces_of_edge[std::minmax(face[k], face[(k + 1) % 3])];
      }
    }
  for (const auto& [edge, n_faces] : faces_of_edge)
    if (n_faces == 1) surface.border_edges.push_back({edge.first, edge.second});
  surface.n_border_edges = static_cast<Index>(surface.border_edges.size());
  for (Vec3& normal : surface.normals) normal.normalize();
  surface.area = std::accumulate(surface.areas.begin(), surface.areas.end(), 0.0);
  std::sort(edges.begin(), edges.end());
  surface.mesh_size = {edges.front(), edges[edges.size() / 2], edges.back()};
  surface.n_components = 1;
  return surface;
}

}  // namespace roughmesh::test
