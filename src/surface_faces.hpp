// SPDX-License-Identifier: BSD-3-Clause
// The faces of a surface: chosen by group, put on points, found again.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Corners of faces that are stored one after the other.
struct FaceView {
  int dimension = 2;               ///< 1 for lines
  std::span<const Index> offsets;  ///< n + 1 positions in corners
  std::span<const Index> corners;

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  std::span<const Index> face(Index i) const {
    return corners.subspan(static_cast<std::size_t>(offsets[i]),
                           static_cast<std::size_t>(offsets[i + 1] - offsets[i]));
  }
};

/// Polygons of three or four corners, or lines in a plane.
struct Faces {
  int dimension = 2;                 ///< 1 for lines
  Vec3 plane_normal = Vec3::Zero();  ///< of the plane of lines
  std::vector<Index> offsets = {0};  ///< n + 1 positions in corners
  std::vector<Index> corners;
  std::vector<Tag> tags;  ///< n element numbers; 0 for derived boundary faces
  /// n numbers of their elements, counted in the order of the file, ascending where the faces are
  /// in that order; the facets of one element of order 2 have the same.
  std::vector<Index> file_order;

  Index size() const { return static_cast<Index>(tags.size()); }
  std::span<const Index> face(Index i) const {
    return {corners.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
  }
  FaceView view() const { return {dimension, offsets, corners}; }
  void turn(Index i);  ///< look the other way; the first corner of a polygon stays first
  void add(std::span<const Index> face_corners, Tag tag, Index order);
  void reserve(std::size_t n_faces, std::size_t n_corners);
};

/// Faces on mesh nodes, in the order of the file, and what they were chosen by.
struct ChosenFaces {
  Faces faces;
  std::vector<std::string> groups;
};

/// The elements of codimension 1 in the groups, or the derived boundary of the volume, those of
/// order 2 as their facets.
/// @throws InputError  as select_surface
ChosenFaces choose_faces(const Mesh& mesh, std::span<const std::string> groups);

/// Faces on points in canonical order, which depends on positions only.
struct CanonicalFaces {
  Faces faces;
  Index n_elements = 0;    ///< elements they come from
  Index n_duplicates = 0;  ///< elements of faces that stand on the points of an earlier one
};

/// Each polygon starts at its smallest point, lines keep their direction; faces stand in the order
/// of their sorted points. Neighbouring corners at one point become one corner; a face left with
/// fewer than three distinct points, a line with fewer than two, is dropped. Of faces on the same
/// points the first in the file stays.
/// @param on_nodes       in the order of the file
/// @param point_of_node  for every mesh node, its point or -1; of the corners, one of n_points
CanonicalFaces canonical_faces(const Faces& on_nodes, std::span<const Index> point_of_node,
                               Index n_points);

inline constexpr Index no_point = std::numeric_limits<Index>::max();

/// Sorted corners, then no_point: the fourth of a triangle, the third and fourth of a line.
using FaceKey = std::array<Index, 4>;

FaceKey face_key(std::span<const Index> corners);

/// Finds faces by their corners, in whatever order these come.
class FaceLookup {
 public:
  /// Faces in canonical order, as canonical_faces and select_surface return them; kept by
  /// reference.
  FaceLookup(std::span<const Index> offsets, std::span<const Index> corners);

  /// Number of the face on these points, -1 if there is none or a point is -1.
  Index find(std::span<const Index> points) const;

 private:
  FaceKey key_of(Index face) const;

  std::span<const Index> offsets_, corners_;
  std::vector<Index> first_face_;  // with a smallest point of at least this number
};

}  // namespace roughmesh::detail
