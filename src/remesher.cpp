// SPDX-License-Identifier: BSD-3-Clause
#include "remesher.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace roughmesh::detail {

GmshProgram gmsh_program(const RoughenOptions& options) { return {options.gmsh, options.timeout}; }

Remesher::Remesher(const Mesh& mesh, std::span<const Surface> surfaces,
                   const RoughenOptions& options) {
  const bool is_curve = std::any_of(surfaces.begin(), surfaces.end(),
                                    [](const Surface& surface) { return surface.dimension < 2; });
  if (is_curve)
    throw InputError(
        "--volume remesh: the rough curves lie in a planar mesh, and only volumes are meshed anew; "
        "take --volume move");
  if (dimension(mesh) < 3) {
    filler_ = std::make_unique<const SurfaceFiller>(mesh, options.box, gmsh_program(options));
    return;
  }
  if (options.box)
    throw InputError(
        fmt::format("--box: {:g}; the mesh has volumes, and a box is for a bare closed surface; "
                    "leave it out",
                    *options.box));
  volumes_ = std::make_unique<const VolumeRemesher>(mesh, surfaces, gmsh_program(options));
}

RemeshedVolume Remesher::remesh(std::span<const Vec3> positions) const {
  return filler_ ? filler_->fill(positions) : volumes_->remesh(positions);
}

}  // namespace roughmesh::detail
