// SPDX-License-Identifier: BSD-3-Clause
// Volumes beside a rough surface are meshed anew; the surface and all else stay.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "roughmesh/surface.hpp"

#include "fill_volumes.hpp"
#include "volume_regions.hpp"

namespace roughmesh::detail {

/// A mesh on which some volumes of another have new elements.
struct RemeshedVolume {
  /// Nodes of the input that are still in use, then new ones. Elements of untouched volumes and all
  /// of lower dimension are those of the input with their numbers; new ones are numbered after
  /// them.
  std::shared_ptr<const Mesh> mesh;
  std::vector<Index> old_nodes;  ///< ascending: which node of the input each of the first is
};

/// Fills every region (volume_regions.hpp) that touches a node which moved with tetrahedra of about
/// the size of the old ones, through gmsh. Faces around it stay as they are. New elements are in
/// the entity and the groups of the region, in the orientation that its elements had. Meshes of
/// order 2 keep the nodes of the faces; new elements have straight edges elsewhere.
class VolumeRemesher {
 public:
  /// @param mesh      has to outlive this
  /// @param surfaces  that will move
  /// @throws InputError  beside them: elements that are no tetrahedra or of order above 2; a line,
  ///                     point or periodic node inside a volume, which would be lost; volume
  ///                     elements that overlap; no volume elements
  VolumeRemesher(const Mesh& mesh, std::span<const Surface> surfaces, GmshProgram gmsh);
  VolumeRemesher(Mesh&& mesh, std::span<const Surface> surfaces, GmshProgram gmsh) = delete;

  /// @param positions  of all nodes; those inside of regions do not matter
  /// @throws           what the constructor and fill_volumes throw
  RemeshedVolume remesh(std::span<const Vec3> positions) const;

 private:
  std::vector<std::uint8_t> regions_at(std::span<const std::uint8_t> has_moved) const;

  const Mesh& mesh_;
  GmshProgram gmsh_;
  VolumeRegions regions_;
  std::vector<std::uint8_t> is_rough_;  // per node
};

}  // namespace roughmesh::detail
