// SPDX-License-Identifier: BSD-3-Clause
// Is a moved mesh still valid? Findings with place, value and limit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh {

struct Finding {
  std::string what;           ///< "inverted tetrahedron", "folded triangle"
  Tag element = 0;            ///< its number in the file
  Vec3 place = Vec3::Zero();  ///< centroid in the moved mesh
  double value = 0;           ///< smallest scaled Jacobian of the element
  double limit = 0;           ///< value must be above this
};

/// Result of comparing a moved mesh with the mesh it came from.
struct MeshCheck {
  std::int64_t inverted_elements = 0;  ///< a corner Jacobian has another sign than before
  double min_quality = 1;              ///< as of roughmesh::min_quality, negative where inverted
  /// Elements of order 2 and more among those checked: only their corners were looked at, so that
  /// a curved side may still cross another.
  std::int64_t n_curved = 0;
  std::vector<Finding> findings;  ///< the worst ones first, at most 10

  bool valid() const { return inverted_elements == 0; }
};

/// Smallest scaled Jacobian (docs/math.md, eq. 17) over the elements of the largest dimension, in
/// the node order of the file; negative orientation of the file counts as positive. Of curved
/// elements, at their corners, with straight edges. 1 without elements.
double min_quality(const Mesh& mesh);

/// An element is inverted, a face folded, unless every corner Jacobian that is not zero in `mesh`
/// keeps its sign. The Jacobians of a face are seen along its normal, on the side where the normal
/// was in `mesh`: all change sign where it turns by more than 90 degrees, one where a quadrangle
/// becomes concave. Where `mesh` and `moved` lie in one plane, they are seen along its normal, and
/// the faces are elements that invert. Checked, at their corners, are elements of the largest
/// dimension and, beside volume elements, faces with a node that no volume element has, like
/// shells.
/// @param moved  n_nodes positions, finite
/// @throws NumericalError  a coordinate that is not finite
MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved);

}  // namespace roughmesh
