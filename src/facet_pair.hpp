// SPDX-License-Identifier: BSD-3-Clause
// Do two triangles, or two segments of a plane, intersect beyond what they share? Exact.
#pragma once

#include <array>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Three corners, by number and place. A segment repeats its second corner.
struct PlacedFacet {
  std::array<Index, 3> points;
  std::array<Vec3, 3> x;
};

/// Do two triangles have a place in common that is on none of the corners and edges they share?
/// Corners of one number are shared; others that touch intersect. By the number of shared corners:
/// 0: any common place; 1: the opposite edge of one meets the other; 2: they are folded onto each
/// other, coplanar and on the same side of the edge; 3: always. A triangle without area stands for
/// its edges, and intersects nothing that shares an edge with it, nor another without area.
bool triangles_intersect(const PlacedFacet& a, const PlacedFacet& b);

/// The same of segments in a plane that is not parallel to this axis. By the number of shared ends:
/// 0: any common place; 1: one lies upon the other; 2: always. A segment without length intersects
/// nothing.
bool segments_intersect(const PlacedFacet& a, const PlacedFacet& b, int axis);

}  // namespace roughmesh::detail
