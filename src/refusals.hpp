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

/// What helps against inverted elements and surfaces that meet themselves; a finer mesh does not,
/// it makes elements smaller.
/// @param n_wall_nodes  that move although their faces stay
/// @param lower         what to do with --rms
std::string remedy(std::span<const FieldPlan> fields, Index n_wall_nodes,
                   const std::string& lower = "lower --rms");

/// Warns where report.request allows invalid meshes.
/// @throws CheckError  it does not, and the surface or the mesh is not valid
void refuse_invalid(const SurfaceCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report);
void refuse_invalid(const MeshCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report);

}  // namespace roughmesh::detail
