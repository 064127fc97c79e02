// SPDX-License-Identifier: BSD-3-Clause
// The scripts that tell gmsh what to do. They hold nothing of the user's but numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "roughmesh/cad.hpp"

#include "cad_rounding.hpp"

namespace roughmesh::detail {

/// Reads the CAD file `file` (a name without quotes) of a length unit in mm, makes its labels
/// physical groups, prints "roughmesh: SOLIDS SURFACES NODES" with the number of nodes that it
/// predicts, and where there is a surface and the number is not above options.max_nodes, meshes and
/// saves "mesh.msh".
/// @param rounding  null, or edges to round first: prints rounded_mark and the volume before and
///                  after; where the fillets fail, only the mark, and makes no mesh. Labels of
///                  faces are lost.
std::string cad_script(std::string_view file, std::optional<double> unit_in_mm,
                       const GeometryOptions& options, const Rounding* rounding);

/// Reads it likewise and meshes and saves its surfaces and curves only, so that their sharp edges
/// can be found; their numbers are those that rounding takes.
std::string survey_script(std::string_view file, std::optional<double> unit_in_mm,
                          const GeometryOptions& options);

/// Runs after a user's script: meshes it, unless `keeps_mesh` (its own) and no size is given, and
/// saves "mesh.msh"; prints empty_mark instead where there is neither curve nor surface.
std::string script_driver(bool keeps_mesh, const GeometryOptions& options);

inline constexpr std::string_view empty_mark = "roughmesh: empty";
inline constexpr std::string_view rounded_mark = "roughmesh rounded:";

}  // namespace roughmesh::detail
