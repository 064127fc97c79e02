// SPDX-License-Identifier: BSD-3-Clause
// Edges of a surface and the faces that meet there; points of a curve and the lines that do.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

#include "surface_faces.hpp"

namespace roughmesh::detail {

/// A face at an edge, or a line at a point.
struct Side {
  Index face = 0;
  /// The face runs along the edge from its smaller to its larger point; the line leaves the point.
  bool forward = false;
};

struct EdgeTable {
  /// n pairs, smaller first, in ascending order. An "edge" of a curve is a point, twice.
  std::vector<std::array<Index, 2>> points;
  std::vector<Index> offsets = {0};   ///< n + 1 positions in sides
  std::vector<Side> sides;            ///< of each edge, in the order of the faces
  std::vector<Index> edge_of_corner;  ///< for each of faces.corners, the edge that starts there

  Index size() const { return static_cast<Index>(points.size()); }
  std::span<const Side> edge(Index i) const {
    return {sides.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
  }
};

EdgeTable make_edges(const FaceView& faces, Index n_points);

}  // namespace roughmesh::detail
