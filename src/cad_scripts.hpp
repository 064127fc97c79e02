// SPDX-License-Identifier: BSD-3-Clause
// The scripts that tell gmsh what to do. They hold nothing of the user's but numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "roughmesh/cad.hpp"

namespace roughmesh::detail {

/// Reads the CAD file `file` (a name without quotes) of a length unit in mm, makes its labels
/// physical groups, prints "roughmesh: SOLIDS SURFACES NODES" with the number of nodes that it
/// predicts, and where there is a surface and the number is not above options.max_nodes, meshes and
/// saves "mesh.msh".
std::string cad_script(std::string_view file, std::optional<double> unit_in_mm,
                       const GeometryOptions& options);

/// Runs after a user's script: meshes it, unless `keeps_mesh` (its own) and no size is given, and
/// saves "mesh.msh"; prints empty_mark instead where there is neither curve nor surface.
std::string script_driver(bool keeps_mesh, const GeometryOptions& options);

inline constexpr std::string_view empty_mark = "roughmesh: empty";

}  // namespace roughmesh::detail
