// SPDX-License-Identifier: BSD-3-Clause
// Which of many positions are exactly equal.
#pragma once

#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// For each position the least index of one that is equal as numbers (0 equals -0). Linear time for
/// positions that are mostly distinct or mostly shared by a few, and never more than sorting takes.
std::vector<Index> first_at_each_position(const std::vector<Vec3>& positions);

}  // namespace roughmesh::detail
