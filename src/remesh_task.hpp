// SPDX-License-Identifier: BSD-3-Clause
// What gmsh has to fill where regions of a mesh are meshed anew.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fill_volumes.hpp"
#include "volume_regions.hpp"

namespace roughmesh::detail {

struct RemeshTask {
  FillTask fill;
  std::vector<Index> node_of_mesh;  ///< of each node of `fill`
  std::vector<Index> regions;       ///< of each volume of `fill`, ascending
};

/// @param is_touched  per region: mesh it anew
/// @param positions   of all nodes of the mesh; those on the faces of touched regions count
/// @pre faces of touched regions are triangles, their elements tetrahedra
RemeshTask make_remesh_task(const Mesh& mesh, const VolumeRegions& regions,
                            std::span<const std::uint8_t> is_touched,
                            std::span<const Vec3> positions);

}  // namespace roughmesh::detail
