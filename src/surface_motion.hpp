// SPDX-License-Identifier: BSD-3-Clause
// The faces of a mesh before and after they moved, and what is wrong with them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/check.hpp"

#include "checked_faces.hpp"
#include "self_intersection.hpp"
#include "triangle_tree.hpp"

namespace roughmesh::detail {

/// The faces and what does not change from one motion to the next.
struct FacesAtRest {
  CheckedFaces faces;
  Vec3 plane_normal = Vec3::Zero();  ///< of lines
  int axis = 2;                      ///< along which the plane of lines is seen

  FacesInPlace in_place() const { return {faces, faces.before, faces.joined, axis}; }
};

/// One motion of the faces.
struct SurfaceMotion {
  const FacesAtRest& rest;
  std::vector<Vec3> after;              ///< of the points
  std::vector<Index> joined;            ///< of the points, after the motion
  std::vector<std::uint8_t> has_moved;  ///< of the points

  FacesInPlace in_place() const { return {rest.faces, after, joined, rest.axis}; }
  Vec3 displacement(Index point) const { return after[point] - rest.faces.before[point]; }
};

/// @param moved  positions of the nodes of the mesh
SurfaceMotion move_faces(const FacesAtRest& rest, std::span<const Vec3> moved);

/// A defect by the numbers of its faces; face b is a where there is one only.
struct Defect {
  double passing_share = 0;
  SurfaceDefect kind = SurfaceDefect::intersection;
  std::array<Tag, 2> elements{};
  Index a = 0, b = 0;
};

/// How many defects of each kind there are, and which are the worst.
class DefectTally {
 public:
  static constexpr std::size_t most_kept = 10;

  void add(const Defect& defect);
  void add(const DefectTally& other);

  /// A defect that passes at this share is none of the worst.
  double threshold() const;
  std::int64_t count(SurfaceDefect kind) const { return counts_[static_cast<std::size_t>(kind)]; }
  /// Counts one that is none of the worst.
  void add_minor(SurfaceDefect kind) { ++counts_[static_cast<std::size_t>(kind)]; }
  const std::vector<Defect>& worst() const { return worst_; }  ///< worst first

 private:
  std::array<std::int64_t, 4> counts_{};
  std::vector<Defect> worst_;
};

/// Faces that turned by more than 90 degrees or lost their area; those without area in the input
/// have nothing to lose.
DefectTally turned_faces(const SurfaceMotion& motion);

/// Pairs of faces that intersect and did not in the input.
DefectTally new_intersections(const SurfaceMotion& motion, std::span<const FacePair> pairs);

/// Of larger surfaces, one in so many points sends rays to the opposite sheet that this many do,
/// and one of every connected part.
inline constexpr std::size_t most_sampled_points = 100'000;

/// Points that passed the sheet that was opposite to them in the input.
DefectTally closed_walls(const SurfaceMotion& motion, const TriangleTree& tree);

}  // namespace roughmesh::detail
