// SPDX-License-Identifier: BSD-3-Clause
// Roughness fades where two sheets of surface run into each other.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/displace.hpp"

namespace roughmesh::detail {

/// The sharpest edge that tapers.
struct AcuteEdge {
  double angle = 0;           ///< between its two sheets, in radians
  Vec3 place = Vec3::Zero();  ///< its middle
};

/// Weights that keep heights below the local thickness beside acute edges (docs/math.md, eq. 57).
struct EdgeTaper {
  std::vector<std::vector<double>> factors;  ///< of each surface, one per point; empty: all 1
  std::vector<AcuteEdge> sharpest;           ///< of each surface that has factors
};

/// @param options  edges of surfaces with another rule than `offset` do not taper
/// @param rms      Rq of each surface; 0: unknown, no taper
EdgeTaper taper_acute_edges(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                            std::span<const double> rms);

}  // namespace roughmesh::detail
