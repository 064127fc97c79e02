// SPDX-License-Identifier: BSD-3-Clause
// The surface of a box, in triangles.
#pragma once

#include <array>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

struct BoxSurface {
  std::vector<Vec3> nodes;
  std::vector<std::array<Index, 3>> triangles;  ///< oriented outward
};

/// Squares of about this size on each side, halved.
/// @param size  > 0, a length
BoxSurface make_box_surface(const Eigen::AlignedBox3d& box, double size);

}  // namespace roughmesh::detail
