// SPDX-License-Identifier: BSD-3-Clause
// The step that masks rise by.
#pragma once

#include <algorithm>

namespace roughmesh::detail {

/// From 0 at t <= 0 to 1 at t >= 1 with two continuous derivatives (docs/math.md, eq. 40).
inline double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return std::min(1.0, s * s * s * (10 + s * (6 * s - 15)));
}

}  // namespace roughmesh::detail
