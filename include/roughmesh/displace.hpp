// SPDX-License-Identifier: BSD-3-Clause
// Heights become displacements of the points of a surface, and of the nodes of several.
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh {

/// u_i = z_i n_i (docs/math.md, eq. 3).
/// @param heights  n numbers z_i, signed, positive outward, in the unit of the mesh
/// @return         n vectors, in the order of surface.points
std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights);

/// The nodes of all surfaces, ascending, each once.
std::vector<Index> moved_nodes(std::span<const Surface> surfaces);

/// What becomes of sharp edges and corners.
enum class EdgeRule : std::uint8_t {
  offset,   ///< every face there keeps its height, and the faces stretch along with their rims
  average,  ///< a point moves along one normal, which is an average over all of its faces
  fix       ///< points at sharp edges stay
};

std::string_view name(EdgeRule rule);

/// How one surface moves at its edges.
struct EdgeOptions {
  EdgeRule rule = EdgeRule::offset;
  double sharp_angle = SurfaceOptions{}.sharp_angle;  ///< as SurfaceOptions::sharp_angle
  std::vector<double> weights = {};  ///< of masks, n numbers: points of weight 0 stay; empty: none
  /// n numbers, equal for points that are periodic images of each other and of one displacement,
  /// also on several surfaces; empty: none are.
  std::vector<Index> images = {};
};

/// A node that moves across `normal` only, as one on a wall or a plane of symmetry does; two planes
/// leave a line, three a point.
struct SlidingNode {
  Index node = 0;
  Vec3 normal = Vec3::Zero();  ///< of any size
};

/// What nodes of rough surfaces cannot do.
struct NodeConstraints {
  std::vector<Index> fixed = {};          ///< ascending; they stay, whatever surface they are of
  std::vector<SlidingNode> sliding = {};  ///< ascending by node
  /// Ascending. Where faces would fold they do not slide within a smooth piece of surface, as nodes
  /// of faces that stay do not, or those of lines and points that are to keep their shape.
  std::vector<Index> anchored = {};
};

/// Where the nodes of surfaces go.
struct MovedSurface {
  std::vector<Vec3> displacements;  ///< one per node of SurfaceMover::nodes(), in its order
  Index n_slid = 0;                 ///< nodes that slid along the surface so that no face folds
  double farthest_slide = 0;
};

/// Displacements of the nodes of surfaces of one mesh, prepared once. A node with one smooth piece
/// of surface around it moves by eq. 3 of docs/math.md. Where several meet, at sharp edges and
/// where surfaces meet, it moves by the smallest vector with the height of each along its normal,
/// in the sense of least squares (eq. 36 and 55); what such nodes slide by along the surfaces is
/// spread over the edges and faces beside them (eq. 56). Where faces would turn over, as beside
/// edges that are much shorter than their heights, the nodes around them slide along the surface
/// until none does, as far as there is a way, under the rule `offset` (eq. 68). Nodes at one point
/// of a surface move together.
class SurfaceMover {
 public:
  /// @param surfaces  one or more of one mesh, of one dimension; kept by reference
  /// @param options   one for each
  /// @throws InputError  numbers of options, weights or images that do not fit; a constrained node
  ///                     of no surface
  SurfaceMover(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
               const NodeConstraints& constraints = {});
  ~SurfaceMover();
  SurfaceMover(SurfaceMover&&) noexcept;
  SurfaceMover& operator=(SurfaceMover&&) noexcept;

  const std::vector<Index>& nodes() const;  ///< moved_nodes(surfaces)

  /// The same bits on any number of threads.
  /// @param heights  for each surface one number per point, in the unit of the mesh; 0 where the
  ///                 weight is
  /// @throws InputError      a number of heights that does not fit
  /// @throws NumericalError  a solver did not converge
  MovedSurface move(std::span<const std::vector<double>> heights) const;

  struct Plan;  ///< defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

/// Likewise for one set of heights. A height of exactly 0, as a mask makes it, leaves the node to
/// the other surfaces.
/// @param options  one for each surface, without weights; empty: the defaults
std::vector<Vec3> displace_nodes(std::span<const Surface> surfaces,
                                 std::span<const std::vector<double>> heights,
                                 std::span<const EdgeOptions> options = {});

}  // namespace roughmesh
