// SPDX-License-Identifier: BSD-3-Clause
// Is a moved mesh still valid? Findings with place, value and limit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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

/// The boundary of a mesh, prepared once, to compare what its elements fill with what it encloses:
/// overlapping, missing or doubled elements leave a difference, also where each is valid.
class Enclosure {
 public:
  /// @param mesh  of volumes or planar
  explicit Enclosure(const Mesh& mesh);

  /// Relative difference between the sum of the signed volumes (areas in a plane) of the elements
  /// and what the boundary encloses. Nothing where even the input has one: elements of both
  /// orientations, listed twice or in space.
  /// @param mesh   as before, or with its elements divided and nodes added at the end
  /// @param moved  n_nodes positions
  std::optional<double> volume_error(const Mesh& mesh, std::span<const Vec3> moved) const;

  static constexpr double largest_error = 1e-12;

 private:
  double error(const Mesh& mesh, std::span<const Vec3> nodes) const;
  double enclosed(std::span<const Vec3> nodes) const;

  std::vector<std::array<Index, 4>> faces_;  // lines and triangles end with -1
  std::optional<Vec3> plane_normal_;
  bool is_exact_ = false;
};

/// Result of comparing a moved mesh with the mesh it came from.
struct MeshCheck {
  std::int64_t inverted_elements = 0;  ///< a corner Jacobian has another sign than before
  double min_quality = 1;              ///< as of roughmesh::min_quality, negative where inverted
  /// Elements of order 2 and more among those checked: only their corners were looked at, so that
  /// a curved side may still cross another.
  std::int64_t n_curved = 0;
  std::vector<Finding> findings;            ///< the worst ones first, at most 10
  std::optional<double> volume_error = {};  ///< of Enclosure, where it was given

  bool volumes_add_up() const { return !volume_error || *volume_error <= Enclosure::largest_error; }
  bool valid() const { return inverted_elements == 0 && volumes_add_up(); }
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

/// The same, and that volumes add up; the last finding tells if they do not.
MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved, const Enclosure& enclosure);

}  // namespace roughmesh
