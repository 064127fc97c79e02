// SPDX-License-Identifier: BSD-3-Clause
// Periodic differences of points.
#pragma once

#include <cmath>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The difference of two points, reduced to half a period on each axis that has one; the others
/// have period 0.
inline Vec3 nearest_image(Vec3 difference, const Vec3& period) {
  for (int axis = 0; axis < 3; ++axis)
    if (period[axis] > 0)
      difference[axis] -= period[axis] * std::nearbyint(difference[axis] / period[axis]);
  return difference;
}

}  // namespace roughmesh::detail
