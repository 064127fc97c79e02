// SPDX-License-Identifier: BSD-3-Clause
// Where a rough surface meets faces that stay.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh::detail {

/// Per node of the mesh 1 if it lies on a face that none of the surfaces has: an element of their
/// dimension, or a side of exactly one element of the dimension above.
/// @throws InputError  a face is in two surfaces
std::vector<std::uint8_t> wall_nodes(const Mesh& mesh, std::span<const Surface> surfaces);

}  // namespace roughmesh::detail
