// SPDX-License-Identifier: BSD-3-Clause
// Signs of determinants of coordinates, exact whatever round-off says.
#pragma once

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Sign of the volume of the tetrahedron: 1 where d lies on the side from which a, b, c run
/// counter-clockwise, 0 in their plane. Coordinates are finite.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of the triangle that is seen along a coordinate axis, from its far end: 1 where
/// a, b, c run counter-clockwise, 0 on a line.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

}  // namespace roughmesh::detail
