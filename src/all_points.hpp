// SPDX-License-Identifier: BSD-3-Clause
// Lists of points that leave nothing out.
#pragma once

#include <span>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// 0, 1, ..., n - 1?
inline bool is_all(std::span<const Index> points, Index n) {
  if (static_cast<Index>(points.size()) != n) return false;
  for (Index i = 0; i < n; ++i)
    if (points[static_cast<std::size_t>(i)] != i) return false;
  return true;
}

}  // namespace roughmesh::detail
