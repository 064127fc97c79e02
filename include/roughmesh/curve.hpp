// SPDX-License-Identifier: BSD-3-Clause
// Arc length along the lines of a planar mesh.
#pragma once

#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// Where the points of a surface of dimension 1 stand along it (docs/math.md, eq. 28). Pieces are
/// numbered in the order of their first points.
struct CurvePlaces {
  /// n places (s, number of the piece, 0), in the order of the points. s is the arc length: on an
  /// open piece from that of its two ends which comes first among the points, on a closed piece
  /// from its first point.
  std::vector<Vec3> places;
  std::vector<double> lengths;         ///< of the pieces
  std::vector<double> closed_lengths;  ///< of the closed pieces, infinity for open ones
};

/// @throws InputError  faces that are not lines of two points; a point where three lines meet; a
///                     point on no line
CurvePlaces curve_places(const Surface& surface);

}  // namespace roughmesh
