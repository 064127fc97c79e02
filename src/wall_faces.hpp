// SPDX-License-Identifier: BSD-3-Clause
// Where a rough surface meets faces that are not rough.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

#include "volume_faces.hpp"

namespace roughmesh::detail {

/// Elements between two partitions of a mesh, which a generator adds: they bound nothing. Readers
/// give them no entity and no group, where all others have an entity.
bool is_between_partitions(const Mesh& mesh, const ElementBlock& block);

/// Per node of the mesh 1 if it lies on a face that none of the surfaces has: an element of their
/// dimension, or a side of exactly one element of the dimension above.
/// @throws InputError  a face is in two surfaces
std::vector<std::uint8_t> wall_nodes(const Mesh& mesh, std::span<const Surface> surfaces);

/// A face that none of the surfaces has.
struct WallFace {
  CellFace face;
  Index block = -1;  ///< of its element; -1 for a side that is none
};

/// Each once, by its corners.
std::vector<WallFace> wall_faces(const Mesh& mesh, std::span<const Surface> surfaces);

}  // namespace roughmesh::detail
