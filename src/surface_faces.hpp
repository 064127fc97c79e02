// SPDX-License-Identifier: BSD-3-Clause
// The faces of a surface: chosen by group, put on points, found again.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Polygons of three or four corners, stored one after the other.
struct Faces {
  std::vector<Index> offsets = {0};  ///< n + 1 positions in corners
  std::vector<Index> corners;
  std::vector<Tag> tags;          ///< n element numbers; 0 for derived boundary faces
  std::vector<Index> file_order;  ///< n positions in the order of the file

  Index size() const { return static_cast<Index>(tags.size()); }
  std::span<const Index> face(Index i) const {
    return {corners.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
  }
  void turn(Index i);  ///< look the other way; the first corner stays first
  void add(std::span<const Index> face_corners, Tag tag, Index order);
};

/// Faces on mesh nodes, in the order of the file, and what they were chosen by.
struct ChosenFaces {
  Faces faces;
  std::vector<std::string> groups;
};

/// The elements of dimension 2 in the groups, or the derived boundary of the volume.
/// @throws InputError  as select_surface
ChosenFaces choose_faces(const Mesh& mesh, std::span<const std::string> groups);

/// Faces on points in canonical order, which depends on positions only.
struct CanonicalFaces {
  Faces faces;
  Index n_duplicates = 0;
};

/// Each face starts at its smallest point; faces stand in the order of their sorted points.
/// Neighbouring corners at one point become one corner; a face left with fewer than three distinct
/// points has no area and is dropped. Of faces on the same points the first in the file stays.
/// @param point_of_node  for every mesh node, its point or -1
CanonicalFaces canonical_faces(const Faces& on_nodes, std::span<const Index> point_of_node);

/// Sorted corners; the fourth of a triangle is the largest Index.
using FaceKey = std::array<Index, 4>;

FaceKey face_key(std::span<const Index> corners);

/// Finds faces by their corners, in whatever order these come.
class FaceLookup {
 public:
  /// Faces in canonical order, as canonical_faces and select_surface return them.
  FaceLookup(std::span<const Index> offsets, std::span<const Index> corners);

  /// Number of the face on these points, -1 if there is none or a point is -1.
  Index find(std::span<const Index> points) const;

 private:
  std::vector<FaceKey> keys_;
};

}  // namespace roughmesh::detail
