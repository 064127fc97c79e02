// SPDX-License-Identifier: BSD-3-Clause
// One surface where several are expected.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh::test {

inline std::span<const Surface> only(const Surface& surface) { return {&surface, 1}; }

/// Vectors at points as vectors at nodes, in the order of surface.nodes.
inline std::vector<Vec3> at_nodes(const Surface& surface, const std::vector<Vec3>& at_points) {
  std::vector<Vec3> result;
  for (const Index point : surface.point_of_node) result.push_back(at_points[point]);
  return result;
}

}  // namespace roughmesh::test
