// SPDX-License-Identifier: BSD-3-Clause
// Where a moved mesh needs repair.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/check.hpp"

namespace roughmesh::detail {

/// When an element counts as poor: inverted as check_corners sees it, or of a quality below `share`
/// of what it had, or of `enough` where it had more.
struct PoorLimit {
  double share = 0;
  double enough = 0;
};

/// check_mesh of the elements with straight edges: what may be asked of corners before other nodes
/// have followed.
MeshCheck check_corners(const Mesh& mesh, std::span<const Vec3> moved);

/// Per node 1 if it is a corner of a poor element of the largest dimension, none of whose corners
/// is among `others` (per node; may be empty).
std::vector<std::uint8_t> nodes_of_poor_elements(const Mesh& mesh, std::span<const Vec3> moved,
                                                 const PoorLimit& limit,
                                                 std::span<const std::uint8_t> others = {});

}  // namespace roughmesh::detail
