// SPDX-License-Identifier: BSD-3-Clause
// New nodes where elements have none that could move.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "deforming.hpp"

namespace roughmesh::detail {

/// A mesh with more nodes: those of the original first, then one in the middle of each edge that
/// was split and of each tetrahedron that got one.
struct SplitMesh {
  Mesh mesh;
  std::vector<Vec3> positions;  ///< of its nodes, the new ones in the middle of the moved old ones
  Index n_new_nodes = 0;
};

/// Splits, of the tetrahedra of order 1 with a marked node, every edge that joins two nodes that
/// are not free, not both linked to images, and lies on no element but tetrahedra and on no
/// boundary; then, into four, those that still have no free node. Elements keep entity and groups;
/// one part keeps the number, the others get new ones.
/// @param marked     per node: where it is needed
/// @param positions  of the moved nodes
/// @return           nothing where there is nothing to split
std::optional<SplitMesh> split_trapped(const Mesh& mesh, const NodeFlags& is_free,
                                       const NodeFlags& marked, std::span<const Vec3> positions);

}  // namespace roughmesh::detail
