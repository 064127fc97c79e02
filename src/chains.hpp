// SPDX-License-Identifier: BSD-3-Clause
// Polylines between ends, and linear interpolation along them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A point inside of a chain.
struct Link {
  Index point = 0;
  Index chain = 0;
  double fraction = 0;  ///< of the length of the chain that lies before it
};

/// Neighbours of each end inside the chain give the directions in which it begins.
struct Chain {
  Index first_end = 0, first = 0;  ///< one end and the point beside it
  Index last_end = 0, last = 0;    ///< the other end and the point beside it
};

struct Chains {
  std::vector<Chain> chains;
  std::vector<Link> links;  ///< chain by chain
};

/// Follows segments from end to end. Points that are no end but not in exactly two segments are
/// ends; closed polylines without an end are left out.
/// @param segments  each once
/// @param is_end    per point
Chains find_chains(std::span<const std::array<Index, 2>> segments, std::span<const Vec3> positions,
                   std::span<const std::uint8_t> is_end);

}  // namespace roughmesh::detail
