// SPDX-License-Identifier: BSD-3-Clause
// Faces that heights would fold over: nodes slide along the surface until none is, if they can.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/displace.hpp"

#include "deforming.hpp"
#include "surface_faces.hpp"

namespace roughmesh::detail {

/// Does a face with an area turn by 90 degrees or more, or lose its area?
/// @param displacements  one for each position
bool has_turned_face(const FaceView& faces, std::span<const Vec3> positions,
                     std::span<const Vec3> displacements);

/// Surfaces and how their vertices can slide.
struct SlidingSurface {
  std::span<const Vec3> positions;
  FaceView faces;  ///< polygons
  NodeFlags can_slide;
  /// Directions that a vertex keeps its place in, ascending by vertex, orthonormal for each.
  std::vector<SlidingNode> across;
};

/// Slides vertices around turned faces by as little distortion as that takes (docs/math.md,
/// eq. 68): those within 4 layers of faces, then within 12, as long as that leaves fewer of them
/// turned. The same bits on any number of threads.
/// @param displacements  with the slides on return
void unfold(const SlidingSurface& surface, std::vector<Vec3>& displacements);

}  // namespace roughmesh::detail
