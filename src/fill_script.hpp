// SPDX-License-Identifier: BSD-3-Clause
// The files that tell gmsh which triangles to fill. They hold nothing of the user's but numbers.
#pragma once

#include <string>

#include "fill_volumes.hpp"
#include "scratch_folder.hpp"

namespace roughmesh::detail {

/// Names within the scratch folder.
inline constexpr std::string_view fill_script_name = "fill.geo", filled_name = "mesh.msh";

/// The triangles as discrete surfaces (number of the sheet + 1) of an MSH file, the sizes as a
/// field, and the script that fills volumes (their number + 1) and saves `filled_name` in MSH 4.1.
/// Node i of the task gets number i + 1, and keeps it.
void write_fill_files(const FillTask& task, const ScratchFolder& folder);

}  // namespace roughmesh::detail
