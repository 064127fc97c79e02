// SPDX-License-Identifier: BSD-3-Clause
// What is measured on an oriented surface.
#pragma once

#include "roughmesh/surface.hpp"

#include "surface_edges.hpp"

namespace roughmesh::detail {

/// Fills `areas` and `area`.
void measure_areas(Surface& surface);

/// Fills `normals` (docs/math.md, eq. 2; of a curve, eq. 35).
/// @throws InputError  a point all of whose faces have no area or cancel
void measure_normals(const Mesh& mesh, Surface& surface);

/// Fills `mesh_size` and the counts of edges.
void measure_edges(const EdgeTable& edges, double sharp_angle, Surface& surface);

}  // namespace roughmesh::detail
