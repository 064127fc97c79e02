// SPDX-License-Identifier: BSD-3-Clause
// New volumes for rough surfaces, whichever kind of mesh they are of.
#pragma once

#include <memory>
#include <span>

#include "roughmesh/options.hpp"
#include "roughmesh/surface.hpp"

#include "fill_surface.hpp"
#include "remesh_volume.hpp"

namespace roughmesh::detail {

/// Meshes volumes anew, or fills a bare closed surface. Refuses all that it cannot do when it is
/// made, before the first realization.
class Remesher {
 public:
  /// @param mesh     has to outlive this
  /// @param options  of them gmsh, timeout and box
  /// @throws InputError  what VolumeRemesher or SurfaceFiller throws; curves; a box around volumes
  Remesher(const Mesh& mesh, std::span<const Surface> surfaces, const RoughenOptions& options);

  RemeshedVolume remesh(std::span<const Vec3> positions) const;

 private:
  std::unique_ptr<const VolumeRemesher> volumes_;
  std::unique_ptr<const SurfaceFiller> filler_;
};

GmshProgram gmsh_program(const RoughenOptions& options);

}  // namespace roughmesh::detail
