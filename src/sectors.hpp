// SPDX-License-Identifier: BSD-3-Clause
// What a rough surface looks like at a sharp edge: several smooth pieces that meet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/displace.hpp"

#include "joined_surfaces.hpp"

namespace roughmesh::detail {

/// The faces of one surface at a vertex that hang together through edges that are not sharp
/// (docs/math.md, eq. 55).
struct Sector {
  Index vertex = 0;
  std::uint32_t surface = 0;
  Index point = 0;             ///< of the surface
  Vec3 normal = Vec3::Zero();  ///< of unit length
};

/// How each edge divides: what meets there.
enum class EdgeKind : std::uint8_t {
  smooth,  ///< two faces of one surface that continue each other
  border,  ///< one face
  sharp    ///< a sharp edge, one of three and more faces, one between two surfaces
};

struct Sectors {
  std::vector<EdgeKind> kind_of_edge;
  std::vector<Sector> all;              ///< by vertex, then by the first of their corners
  std::vector<Index> offsets;           ///< n_vertices + 1 positions in `all`
  std::vector<Index> sector_of_corner;  ///< of each of the corners of the joined surfaces

  std::span<const Sector> at(Index vertex) const {
    return {all.data() + offsets[vertex],
            static_cast<std::size_t>(offsets[vertex + 1] - offsets[vertex])};
  }
};

/// At points of surfaces whose rule is not `offset` there is one sector, and a vertex with one
/// sector has the normal of its point.
Sectors find_sectors(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                     const JoinedSurfaces& joined);

/// Points of a surface at edges that are sharp or join three and more faces, one flag each.
std::vector<std::uint8_t> sharp_points(const Surface& surface, double sharp_angle);

}  // namespace roughmesh::detail
