// SPDX-License-Identifier: BSD-3-Clause
// Points, segments and triangles in space, and exact distances to them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A point, segment or triangle. Vertices are sorted by position, so that what is computed from
/// them does not depend on the order in which a file names them.
struct PlacedSimplex {
  std::array<Vec3, 3> vertices;
  int n_vertices = 1;

  /// @param positions  1 to 3 of them, in any order
  explicit PlacedSimplex(std::span<const Vec3> positions);

  Eigen::AlignedBox3d bounds() const;
};

/// By number of vertices, then by position: a total order.
bool operator<(const PlacedSimplex& a, const PlacedSimplex& b);
bool operator==(const PlacedSimplex& a, const PlacedSimplex& b);

/// Square of the distance to the nearest point of the simplex; exactly 0 at its vertices. A
/// triangle without area is the segments between its vertices.
double squared_distance(const PlacedSimplex& simplex, const Vec3& x);

/// Appends what an element consists of: its point, its segment, its triangles. A quadrangle is the
/// triangles of both its splittings, so that no diagonal is preferred; a volume element is its
/// faces.
/// @param corners  positions, n_corners(shape) of them in Gmsh's order
void append_simplices(ElementShape shape, std::span<const Vec3> corners,
                      std::vector<PlacedSimplex>& simplices);

}  // namespace roughmesh::detail
