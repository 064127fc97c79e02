// SPDX-License-Identifier: BSD-3-Clause
// Does a mesh lie in one plane, and in which.
#pragma once

#include <optional>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The plane of a planar mesh, or the node that keeps a mesh from being planar.
struct PlaneFit {
  std::optional<Vec3> normal;  ///< unit vector; its last component that is not zero is positive
  Index farthest_node = -1;    ///< without normal: the node farthest from the best guess
  double distance = 0;         ///< of that node

  bool is_planar() const { return normal.has_value(); }
};

/// Plane of the nodes of all elements of dimension 1 and more, to 1e-6 of their extent. Where z is
/// constant it is the one across the z axis, then that across y, then x; of a straight line in
/// space, the plane closest to the one across z. Depends on positions only, not on their order.
PlaneFit fit_plane(const Mesh& mesh);

}  // namespace roughmesh::detail
