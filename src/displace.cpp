// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/displace.hpp"

#include <fmt/format.h>

namespace roughmesh {

std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights) {
  if (heights.size() != surface.points.size())
    throw InputError(fmt::format("{} heights for a surface of {} points; give one per point",
                                 heights.size(), surface.points.size()));
  std::vector<Vec3> displacements(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    displacements[i] = heights[i] * surface.normals[i];
  return displacements;
}

}  // namespace roughmesh
