// SPDX-License-Identifier: BSD-3-Clause
// The volumes of a mesh between its faces: what can be meshed anew without touching anything else.
#pragma once

#include <vector>

#include "roughmesh/mesh.hpp"

#include "volume_faces.hpp"

namespace roughmesh::detail {

/// A side of volume elements with another region, or none, behind it, or that is an element of the
/// mesh. Its corners as they stand in the first of its cells.
struct RegionFace {
  CellFace face;  ///< `element` is that of the face where the mesh has it, else of the cell
  std::array<Index, 2> regions{};  ///< ascending; the second is -1 on the boundary of the mesh
};

/// Regions: volume elements of one entity and the same groups that are joined by sides which are no
/// elements of their own. A face with one region on both sides does not divide it.
struct VolumeRegions {
  Index n_regions = 0;
  std::vector<std::vector<Index>> of_block;  ///< of each block, the region of each of its elements;
                                             ///< empty for blocks of a lower dimension
  std::vector<RegionFace> faces;             ///< in the order of their corners
};

/// @throws InputError  a side of more than two volume elements, which have no mesh between them
VolumeRegions find_regions(const Mesh& mesh);

}  // namespace roughmesh::detail
