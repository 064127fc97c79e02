// SPDX-License-Identifier: BSD-3-Clause
// Is a moved mesh still valid? Its surface first, then its elements: findings with place and limit.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh {

struct Finding {
  std::string what;           ///< "inverted tetrahedron", "folded triangle"
  Tag element = 0;            ///< its number in the file
  Vec3 place = Vec3::Zero();  ///< centroid in the moved mesh
  double value = 0;           ///< quality of the element, as of roughmesh::min_quality
  double limit = 0;           ///< value must be above this
};

/// The boundary of a mesh, prepared once, to compare what elements fill with what it encloses:
/// where they were divided, a missing, doubled or badly joined one leaves a difference; moves do
/// not.
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

  /// Likewise of a mesh with other elements and nodes inside the same boundary.
  /// @param remeshed  at its place
  /// @param moved     n_nodes positions of the input; those on its boundary count
  std::optional<double> volume_error_inside(const Mesh& remeshed,
                                            std::span<const Vec3> moved) const;

  static constexpr double largest_error = 1e-12;

 private:
  double error(const Mesh& mesh, std::span<const Vec3> nodes, std::span<const Vec3> outer) const;
  double enclosed(std::span<const Vec3> nodes) const;

  std::vector<std::array<Index, 4>> faces_;  // lines and triangles end with -1
  std::optional<Vec3> plane_normal_;
  bool is_exact_ = false;
};

/// Result of comparing a moved mesh with the mesh it came from.
struct MeshCheck {
  /// A corner Jacobian has another sign than before, or that of a curved element is not positive
  /// everywhere.
  std::int64_t inverted_elements = 0;
  double min_quality = 1;  ///< as of roughmesh::min_quality, negative where inverted
  /// Pyramids of order 2, faces of order 2 that are in no plane and elements of higher order among
  /// those checked: only their corners were looked at, so that a curved side may still cross
  /// another.
  std::int64_t n_corners_only = 0;
  /// Curved elements that are not positive everywhere, but were not in the input either: no
  /// findings as long as their corners are right.
  std::int64_t curved_inverted_before = 0;
  std::vector<Finding> findings;            ///< the worst ones first, at most 10
  std::optional<double> volume_error = {};  ///< of Enclosure, where it was given

  bool volumes_add_up() const { return !volume_error || *volume_error <= Enclosure::largest_error; }
  bool valid() const { return inverted_elements == 0 && volumes_add_up(); }
};

/// Smallest scaled Jacobian (docs/math.md, eq. 17) over the elements of the largest dimension, in
/// the node order of the file; negative orientation of the file counts as positive. Of elements of
/// order 2 that at their corners, with straight edges, or what eq. 61 has for their curved sides,
/// if that is less. 1 without elements.
double min_quality(const Mesh& mesh);

/// An element is inverted, a face folded, unless every corner Jacobian that is not zero in `mesh`
/// keeps its sign. The Jacobians of a face are seen along its normal, on the side where the normal
/// was in `mesh`: all change sign where it turns by more than 90 degrees, one where a quadrangle
/// becomes concave. Where `mesh` and `moved` lie in one plane, they are seen along its normal, and
/// the faces are elements that invert. Elements of order 2 are inverted as well unless their
/// determinant is proven to be positive everywhere (docs/math.md, eq. 60), if it was in `mesh`.
/// Checked are elements of the largest dimension and, beside volume elements, at their corners,
/// faces with a node that no volume element has, like shells.
/// @param moved  n_nodes positions, finite
/// @throws NumericalError  a coordinate that is not finite
MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved);

/// The same, and that volumes add up; the last finding tells if they do not.
MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved, const Enclosure& enclosure);

/// Of a mesh with new volume elements inside the boundary of the input: quality of all elements,
/// and that volumes add up. Elements have no former place here, so that of straight ones none is
/// found inverted; curved ones have to be positive everywhere.
/// @param moved  as for Enclosure::volume_error_inside
MeshCheck check_remeshed(const Mesh& remeshed, std::span<const Vec3> moved,
                         const Enclosure& enclosure);

enum class SurfaceDefect : std::uint8_t {
  intersection,  ///< of two faces
  folded,        ///< a face turned by more than 90 degrees
  collapsed,     ///< a face without area left
  closed_wall    ///< two opposite sheets have changed places
};

/// What is wrong with a moved surface in one place.
struct SurfaceFinding {
  SurfaceDefect defect = SurfaceDefect::intersection;
  std::string what;               ///< "triangle 7 intersects triangle 12"
  std::array<Tag, 2> elements{};  ///< numbers in the file, ascending; of one element (0, number)
  Vec3 place = Vec3::Zero();      ///< in the moved mesh: mean of the middles of the faces
  double height = 0;              ///< how far the farthest of their nodes has moved
  /// Estimate of the largest share of all displacements at which these faces would pass: where
  /// bisection between none and all of them finds them to fail first.
  double passing_share = 0;
};

struct SurfaceCheck {
  std::int64_t self_intersections = 0;   ///< pairs of faces that intersect and did not in the input
  std::int64_t input_intersections = 0;  ///< pairs of faces that intersect as they did in the input
  std::int64_t folded_faces = 0;
  std::int64_t collapsed_faces = 0;
  /// Points that passed the opposite sheet, which no intersection tells of where it is all of them.
  std::int64_t closed_walls = 0;
  /// False: there are more intersections than were looked for; numbers of pairs are "at least".
  bool is_complete = true;
  std::vector<SurfaceFinding> findings;  ///< smallest passing_share first, at most 10

  /// Nothing was found, and nothing can have been missed.
  bool valid() const { return findings.empty() && is_complete; }
};

/// Where a surface is closer to its other side than heights may be.
struct ThinWall {
  Vec3 place = Vec3::Zero();  ///< point of the surface
  double distance = 0;        ///< along the normal, to the opposite sheet
  bool is_gap = false;        ///< the sheet is in front of the surface, not behind it
  Tag element = 0;            ///< of the opposite sheet: number in the file
  /// Over that of the heights that would just close it, which come from both sides where both are
  /// rough.
  double passing_share = 0;
};

/// Looks at all faces of a mesh that could meet its rough surfaces, prepared once: selected and
/// unselected elements of their dimension and the boundary of those above; lines for curves of a
/// planar mesh. Quadrangles are the triangles of both their splittings; elements of order 2 the
/// facets of docs/math.md, eq. 38; higher orders straight. Nodes at one place in the input that
/// still are at one place after a motion are one point, so that a crack or a contact is none of its
/// findings unless its sides come apart.
class SurfaceChecker {
 public:
  /// @param surfaces  one or more of this mesh, of one dimension
  /// @param left_out  n_nodes flags: faces with such a node are not looked at; empty: all are
  /// @throws InputError  no surface
  SurfaceChecker(const Mesh& mesh, std::span<const Surface> surfaces,
                 std::span<const std::uint8_t> left_out = {});
  ~SurfaceChecker();
  SurfaceChecker(SurfaceChecker&&) noexcept;
  SurfaceChecker& operator=(SurfaceChecker&&) noexcept;

  /// Signs are exact: faces intersect if they have a place in common, as numbers, that is no corner
  /// or edge of both. Only faces with a node that moved are looked at. All that is found is the
  /// same on any number of threads.
  /// @param moved  n_nodes positions; those of the interior do not matter
  /// @throws NumericalError  a coordinate that is not finite
  SurfaceCheck check(std::span<const Vec3> moved) const;

  /// The thinnest place of the walls behind and gaps before a surface, relative to these heights,
  /// by rays from its points (some 10^5 of a larger surface) along both normals in the input to
  /// sheets that lean by at most 60 degrees. None where heights close none.
  /// @param height  to be expected on every rough surface
  std::optional<ThinWall> thinnest_wall(const Surface& surface, double height) const;

  struct Plan;  ///< the faces and a hierarchy of boxes; defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

/// One check of a mesh.
SurfaceCheck check_surface(const Mesh& mesh, std::span<const Surface> surfaces,
                           std::span<const Vec3> moved);

}  // namespace roughmesh
