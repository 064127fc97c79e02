// SPDX-License-Identifier: BSD-3-Clause
// The step that masks rise by.
#pragma once

#include <algorithm>

namespace roughmesh::detail {

/// From 0 at t <= 0 to 1 at t >= 1 with two continuous derivatives (docs/math.md, eq. 40). The
/// upper half is computed from the lower one, S(1 - t) = 1 - S(t), so that both ends keep their
/// digits.
inline double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  const auto rise = [](double u) { return u * u * u * (10 + u * (6 * u - 15)); };
  return s < 0.5 ? rise(s) : 1 - rise(1 - s);
}

}  // namespace roughmesh::detail
