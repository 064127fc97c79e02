// SPDX-License-Identifier: BSD-3-Clause
// Heights become displacements of the points of a surface, and of the nodes of several.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh {

/// u_i = z_i n_i (docs/math.md, eq. 3).
/// @param heights  n numbers z_i, signed, positive outward, in the unit of the mesh
/// @return         n vectors, in the order of surface.points
std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights);

/// The nodes of all surfaces, ascending, each once.
std::vector<Index> moved_nodes(std::span<const Surface> surfaces);

/// Displacements of the nodes of surfaces of one mesh. A node of one surface moves by eq. 3 of
/// docs/math.md, one where several meet by the smallest vector with the height of each along its
/// normal, in the sense of least squares (eq. 36); a height of exactly 0, as a mask makes it, leaves
/// the node to the other surfaces. Nodes at one point of a surface move together.
/// @param heights  for each surface one number per point, in the unit of the mesh
/// @return         one vector per node of moved_nodes(surfaces), in its order; none is longer than
///                 2 sqrt(k) times the largest height of the k surfaces that meet there
/// @throws InputError  a number of heights that does not fit
std::vector<Vec3> displace_nodes(std::span<const Surface> surfaces,
                                 std::span<const std::vector<double>> heights);

}  // namespace roughmesh
