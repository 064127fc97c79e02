// SPDX-License-Identifier: BSD-3-Clause
// CAD files and geometry scripts become meshes, through the gmsh program (docs/geometry.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/mesh_io.hpp"

namespace roughmesh {

/// Is this a geometry, by its extension in any case: .step, .stp, .brep, .geo?
bool is_geometry(const std::filesystem::path& path);

struct GeometryOptions {
  /// Length of the edges, in the unit of the file; everywhere the same. 0: as a .geo script says,
  /// which is no choice for CAD files.
  double mesh_size = 0;
  std::string gmsh = "gmsh";   ///< the program: a name looked for in PATH, or a path
  double timeout = 600;        ///< seconds it may take, > 0
  bool trust_scripts = false;  ///< run .geo scripts that run programs or touch other files
  bool share_faces = true;  ///< of a CAD file: solids that touch get one mesh of their common face
  /// Of a CAD file: radius to which the sharp edges of its solids are rounded, in the unit of the
  /// file, best at least two mesh sizes; 0: they stay. Labels of faces are lost.
  double round = 0;
  double sharp_angle = 40.0 / 180.0 * std::numbers::pi;  ///< of the edges that are rounded
  double max_nodes =
      20'000'000;  ///< of a CAD file: predicted from its volume and area before meshing
};

/// Meshes a geometry with linear elements. The mesh reads as if from an MSH 4.1 file.
///
/// STEP and BREP: solids with their surfaces; where there is no solid, the surfaces. Coordinates
/// are the numbers of the file, whatever its length unit. Labels of STEP parts become physical
/// groups: the path of names through the assembly, such as "housing/block"; parts of one label are
/// one group. Faces that two solids share are not merged.
///
/// Scripts (.geo): meshed as they say, in the highest dimension that has a physical group, else the
/// highest that has an entity; one that makes its mesh itself keeps that mesh. A mesh_size given
/// replaces all its sizes. Scripts are read first, and refused where they could run programs or
/// touch other files, unless trusted.
///
/// gmsh runs as a child process in a temporary folder, reads no option file of the user and prints
/// nothing; an interrupt ends it (discard_unfinished_files).
///
/// Rounding uses the fillets of OpenCASCADE; the volume of the solids has to change as their edges
/// let expect (docs/math.md, eq. 66).
///
/// @throws InputError      missing file or program; no solid and no surface; mesh size missing or
///                         too small; a script that is refused; time over; a radius too large for
///                         the solids, without sharp edges, or of a script
/// @throws FormatError     not what its extension says, corrupt, a script with mistakes: file and,
///                         for scripts, line
/// @throws NumericalError  gmsh failed to mesh it or crashed
Mesh mesh_geometry(const std::filesystem::path& path, const GeometryOptions& options);

}  // namespace roughmesh
