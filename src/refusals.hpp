// SPDX-License-Identifier: BSD-3-Clause
// Realizations that no solver would take: told, and refused unless the user allows them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "roughmesh/check.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/report.hpp"

#include "rough_surface.hpp"

namespace roughmesh::detail {

/// Faces that stay although nodes of a rough surface on them move.
struct TornWalls {
  Index n_nodes = 0;
  bool would_slide = false;  ///< some of them, under another choice of --volume
};

/// What helps against inverted elements and surfaces that meet themselves; a finer mesh does not,
/// it makes elements smaller.
/// @param lower  what to do with --rms
std::string remedy(std::span<const FieldPlan> fields, const TornWalls& walls,
                   const std::string& lower);

/// Warns where report.request allows invalid meshes.
/// @throws CheckError  it does not, and the surface or the mesh is not valid
void refuse_invalid(const SurfaceCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report);
void refuse_invalid(const MeshCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report);

}  // namespace roughmesh::detail
