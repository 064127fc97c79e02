// SPDX-License-Identifier: BSD-3-Clause
// What a run tells its user without being asked: one line each, into report.warnings.
#pragma once

#include <string>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/report.hpp"
#include "roughmesh/surface.hpp"

#include "rough_surface.hpp"

namespace roughmesh::detail {

/// Sharp edges, edges of many faces, faces that count once.
void warn_of_surface(Report& report, const Surface& surface, const Roughness& request);

/// A period that is none of the surface: its sides are not whole periods apart.
void warn_of_period(Report& report, const Surface& surface, const Roughness& request);

/// Heights that hardly differ.
/// @param sq_over_rq  expected Sq over Rq
void warn_of_constant_heights(Report& report, const std::vector<std::string>& groups,
                              double sq_over_rq);

/// Acute edges beside which heights are lowered.
void warn_of_taper(Report& report, const Surface& surface, const TaperReport& taper);

/// Roughness that the mesh or its size cannot carry; surface.resolution is set.
void warn_of_scale(Report& report, const SurfaceReport& surface, const Roughness& request);

/// Covariances beyond the tolerance, clipped eigenvalues, variance that a cutoff leaves out; audit
/// and field of report.surfaces are set.
void warn_of_fields(Report& report);

/// Elements that were checked at their corners only.
void warn_of_curved_elements(Report& report, const MeshCheck& check);

/// Nodes that slid along the surface: once, for the first realization that has some.
void warn_of_slides(Report& report, std::uint64_t realization, const MovedSurface& moved);

/// A realization on more elements than the input has.
void warn_of_split(Report& report, std::uint64_t realization, const Mesh& mesh, const Mesh& split);

/// A realization on other elements than the input.
void warn_of_remeshing(Report& report, std::uint64_t realization, const Mesh& mesh,
                       const Mesh& remeshed);

/// Nodes of the surfaces that move although they lie on faces that stay.
/// @param can_slide  other faces would have followed
void warn_of_walls(Report& report, Index n_nodes, bool can_slide);

/// A wall or gap that heights to be expected may close.
void warn_of_thin_wall(Report& report, const Surface& surface, const Roughness& request,
                       const ThinWall& wall);

/// Surfaces that intersect themselves without any roughness.
void warn_of_input_intersections(Report& report, const SurfaceCheck& check);

/// What is wrong with a rough surface, how often, and the worst place: part of a line.
std::string describe_defects(const SurfaceCheck& check);

/// "lower --rms to about ..." so that the worst place would pass, rounded down to two digits.
std::string lower_rms(const SurfaceCheck& check, const RoughenOptions& request);

}  // namespace roughmesh::detail
