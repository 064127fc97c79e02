// SPDX-License-Identifier: BSD-3-Clause
// What a point meets when it leaves its surface: the sheet on the other side of a wall or gap.
#pragma once

#include <array>
#include <optional>

#include "checked_faces.hpp"
#include "triangle_tree.hpp"

namespace roughmesh::detail {

struct SheetHit {
  double distance = 0;
  std::size_t facet = 0;
  std::array<double, 3> weights{};  ///< of its corners at the place that was hit
};

/// The nearest facet on a ray from a point of the faces in the input, within `reach`, that leans by
/// at most 60 degrees from being across the ray and does not have the point as a corner. What
/// touches the point is no other side.
/// @param tree       of the facets in the input
/// @param direction  a unit vector
std::optional<SheetHit> opposite_sheet(const CheckedFaces& faces, const TriangleTree& tree,
                                       Index point, const Vec3& direction, double reach,
                                       const Vec3& plane_normal);

}  // namespace roughmesh::detail
