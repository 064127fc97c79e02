// SPDX-License-Identifier: BSD-3-Clause
// The stages in order: a smooth mesh and options in, rough meshes and a report out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/check.hpp"
#include "roughmesh/field_model.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/options.hpp"
#include "roughmesh/report.hpp"

namespace roughmesh {

/// One realization, as the pipeline hands it over; lent until `deliver` returns.
struct RoughMesh {
  std::uint64_t realization = 0;
  Mesh mesh = {};  ///< the input with moved nodes, or with other elements where it was split or
                   ///< meshed anew
  SurfaceCheck surface_check = {};
  MeshCheck check = {};
  std::vector<double> heights = {};      ///< one per node of the mesh; 0 off the surface
  std::vector<Vec3> normals = {};        ///< one per node of the mesh; zero off the surface
  std::vector<Vec3> displacements = {};  ///< one per node of the mesh
};

/// The input with an element of every shape that roughen() would hand over: for check_output()
/// before a long run.
Mesh output_sample(const Mesh& mesh, const RoughenOptions& options);

/// Takes one rough mesh, for example to write it. The last entry of report.realizations belongs to
/// it; its `path` may be filled in.
using Deliver = std::function<void(const RoughMesh& rough, Report& report)>;

/// Where a run is.
struct Progress {
  std::string_view stage;  ///< that begins: a key of `timings` in the report, such as "field"
  std::optional<std::uint64_t> realization;  ///< being made; none: what all have in common
};

/// Told of every stage as it begins, in the thread that called roughen().
using Watch = std::function<void(const Progress& progress)>;

/// Makes options.realizations rough meshes, one after the other, and hands each to `deliver`; holds
/// one at a time. `input`, `output` and `report` of the options are not used here. Sets the number
/// of threads of the whole process while it runs: not for two callers at once.
///
/// @throws InputError      options or mesh that cannot be roughened
/// @throws CheckError      a realization whose surface meets itself or with inverted elements,
///                         unless options.allow_invalid; it is not delivered, earlier ones were
/// @throws NumericalError  a solver did not converge
Report roughen(const Mesh& mesh, const RoughenOptions& options, const Deliver& deliver,
               const Watch& watch = {});

/// Heights, normals and displacements as point data, for files that carry them.
std::vector<PointField> point_fields(const RoughMesh& rough);

}  // namespace roughmesh
