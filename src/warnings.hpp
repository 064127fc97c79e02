// SPDX-License-Identifier: BSD-3-Clause
// What a run tells its user without being asked: one line each, into report.warnings.
#pragma once

#include "roughmesh/check.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/report.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh::detail {

/// Sharp edges, edges of many faces, faces that count once.
void warn_of_surface(Report& report, const Surface& surface);

/// Roughness that the mesh, the numbers of its file or its size cannot carry; report.resolution is
/// set.
void warn_of_scale(Report& report, const Mesh& mesh, const Surface& surface);

/// A covariance beyond the tolerance, clipped eigenvalues; report.audit and report.field are set.
void warn_of_field(Report& report);

/// Elements whose curved sides nothing looked at.
void warn_of_curved_elements(Report& report, const MeshCheck& check);

/// Nodes of the surface on faces that stay.
void warn_of_walls(Report& report, const VolumeMover& mover);

}  // namespace roughmesh::detail
