// SPDX-License-Identifier: BSD-3-Clause
// Several rough surfaces of one mesh as one: what moves together is one vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

#include "surface_edges.hpp"

namespace roughmesh::detail {

/// Vertices are classes of nodes that move together: those at one point of a surface, and so on
/// from each of them. They stand in the order of the surfaces and of their points, so that numbers
/// of the file change nothing.
struct JoinedSurfaces {
  int dimension = 2;
  Vec3 plane_normal = Vec3::Zero();
  std::vector<Vec3> positions;                      ///< of vertices
  std::vector<std::vector<Index>> vertex_of_point;  ///< of each surface
  std::vector<Index> vertex_of_node;                ///< in the order of moved_nodes(surfaces)

  std::vector<Index> face_offsets, face_corners;  ///< on vertices, surface after surface
  std::vector<Index> point_of_corner;             ///< point of the face's surface
  std::vector<std::uint32_t> surface_of_face;
  EdgeTable edges;  ///< between vertices

  Index n_vertices() const { return static_cast<Index>(positions.size()); }
  Index n_faces() const { return static_cast<Index>(surface_of_face.size()); }
  std::span<const Index> face(Index i) const { return view().face(i); }
  FaceView view() const { return {dimension, face_offsets, face_corners}; }
};

JoinedSurfaces join_surfaces(std::span<const Surface> surfaces, std::span<const Index> moved);

/// Area vector of each face; zero where only round-off would decide its direction.
std::vector<Vec3> sound_vectors(const JoinedSurfaces& joined);

}  // namespace roughmesh::detail
