// SPDX-License-Identifier: BSD-3-Clause
// How long the edges of new elements should be, everywhere in a box.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Lengths of edges on a cubic lattice, linear between its points, constant beyond its sides. Gmsh
/// looks them up at once, while it searches a view on tetrahedra for most of its time.
struct SizeLattice {
  Vec3 corner = Vec3::Zero();
  double spacing = 1;         ///< a length
  std::array<int, 3> n{};     ///< points along each axis, at least 2
  std::vector<double> sizes;  ///< of all points, those along the last axis first; lengths

  std::size_t number(const std::array<int, 3>& point) const {
    return (static_cast<std::size_t>(point[0]) * static_cast<std::size_t>(n[1]) +
            static_cast<std::size_t>(point[1])) *
               static_cast<std::size_t>(n[2]) +
           static_cast<std::size_t>(point[2]);
  }
  Vec3 place(const std::array<int, 3>& point) const {
    return corner + spacing * Vec3(point[0], point[1], point[2]);
  }
};

/// Lengths of edges that grow with the distance from places (docs/math.md, eq. 65).
inline constexpr double growth = 0.3;

/// The least that the growing edges of all places leave (docs/math.md, eq. 65).
/// @param places  n of them, at least one
/// @param sizes   n lengths of edges there
SizeLattice growing_sizes(std::span<const Vec3> places, std::span<const double> sizes);

/// Those of a mesh that fills space: at each point of the lattice the mean over the nodes of the
/// cells around, weighted as linear interpolation would; where there are none, as above.
SizeLattice mean_sizes(std::span<const Vec3> places, std::span<const double> sizes);

}  // namespace roughmesh::detail
