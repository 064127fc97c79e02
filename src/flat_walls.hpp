// SPDX-License-Identifier: BSD-3-Clause
// Walls in one plane, and what keeps their outlines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "wall_faces.hpp"

namespace roughmesh::detail {

/// Faces that hang together through edges (lines: through points) and look the same way.
struct WallPatch {
  Vec3 normal = Vec3::Zero();  ///< unit vector; exact where the plane is one of coordinates
  bool is_flat = false;        ///< to 1e-6 of its extent, and of elements of order 1 and 2
};

/// An edge where a patch ends, or a group on it; of lines a point, twice.
struct WallBorder {
  std::array<Index, 2> nodes{};
  Index patch = 0;
};

struct WallPatches {
  std::vector<WallPatch> patches;
  std::vector<Index> patch_of_face;  ///< -1 for a face without area
  std::vector<WallBorder> borders;   ///< inside of no patch, or between two groups
};

/// @param plane_normal  of the plane of lines; unused for faces
WallPatches find_patches(const Mesh& mesh, std::span<const WallFace> faces,
                         const Vec3& plane_normal);

}  // namespace roughmesh::detail
