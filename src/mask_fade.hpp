// SPDX-License-Identifier: BSD-3-Clause
// Masks that start from borders and physical groups.
#pragma once

#include <string>
#include <vector>

#include "roughmesh/mask.hpp"

namespace roughmesh::detail {

/// Multiplies the weights by those of a fade (docs/math.md, eq. 41).
/// @throws InputError  as mask_weights
void apply_fade(const Mesh& mesh, const Surface& surface, const Fade& fade,
                std::vector<double>& weights);

/// Sets the weights of the points to 0 that are nodes of elements of the group.
/// @throws InputError  as mask_weights
void apply_fixed(const Mesh& mesh, const Surface& surface, const std::string& group,
                 std::vector<double>& weights);

}  // namespace roughmesh::detail
