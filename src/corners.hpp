// SPDX-License-Identifier: BSD-3-Clause
// Elements seen from their corners.
#pragma once

#include <array>
#include <span>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Local numbers of a corner and its three neighbours along edges.
using CornerTetrahedron = std::array<int, 4>;

/// Tetrahedra between each corner of a shape of dimension 3 and its neighbours, of positive volume
/// in an element of positive volume. The apex of a pyramid has four neighbours and is left out: it
/// is in the tetrahedra of all other corners. Empty for other shapes.
std::span<const CornerTetrahedron> corner_tetrahedra(ElementShape shape);

/// Six times the signed volume of a tetrahedron.
inline double determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace roughmesh::detail
