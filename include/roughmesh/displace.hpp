// SPDX-License-Identifier: BSD-3-Clause
// Heights become displacements of the points of a surface.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh {

/// u_i = z_i n_i (docs/math.md, eq. 3).
/// @param heights  n numbers z_i, signed, positive outward, in the unit of the mesh
/// @return         n vectors, in the order of surface.points
std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights);

}  // namespace roughmesh
