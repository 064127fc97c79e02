// SPDX-License-Identifier: BSD-3-Clause
// A surface and a correlation that belong together.
#pragma once

#include <fmt/format.h>

#include "roughmesh/correlation.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh::detail {

/// @throws InputError  the numbers of points differ
inline void require_points_of(const Surface& surface, const Correlation& correlation) {
  if (correlation.n_points() == surface.n_points()) return;
  throw InputError(
      fmt::format("a correlation of {} points for a surface of {}; make it of Surface::points",
                  correlation.n_points(), surface.n_points()));
}

}  // namespace roughmesh::detail
