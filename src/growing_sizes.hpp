// SPDX-License-Identifier: BSD-3-Clause
// Elements that grow away from a surface.
#pragma once

#include <span>

#include "fill_volumes.hpp"

namespace roughmesh::detail {

/// Lengths of edges that grow with the distance from places (docs/math.md, eq. 63).
inline constexpr double growth = 0.3;

/// On a lattice over the places, some 32 cells along the longest side.
/// @param places  n of them, at least one
/// @param sizes   n lengths of edges there
SizeMap growing_sizes(std::span<const Vec3> places, std::span<const double> sizes);

}  // namespace roughmesh::detail
