// SPDX-License-Identifier: BSD-3-Clause
// What is measured on an oriented surface.
#pragma once

#include <span>

#include "roughmesh/surface.hpp"

#include "polygon.hpp"
#include "surface_edges.hpp"

namespace roughmesh::detail {

/// Fills `areas` and `area`.
void measure_areas(Surface& surface);

/// Fills `normals` (docs/math.md, eq. 2; of a curve, eq. 35).
/// @throws InputError  a point all of whose faces have no area or cancel
void measure_normals(const Mesh& mesh, Surface& surface);

/// Fills `normals` where groups of points share one: from the faces of all of them together, each
/// point being sorted to point `sharer[i]` (docs/math.md, eq. 31). For faces of three and more
/// corners.
/// @throws InputError  points whose faces cancel; lines
void measure_shared_normals(Surface& surface, std::span<const Index> sharer);

/// Area vector of a face (of a line, eq. 35); zero where only round-off would decide its direction.
Vec3 sound_face_vector(const Corners& corners, const Vec3& plane_normal);

/// Do two faces with these sound vectors enclose more than the angle?
bool is_sharp(const Vec3& a, const Vec3& b, double sharp_angle);

/// Fills `mesh_size` and the counts of edges.
void measure_edges(const EdgeTable& edges, double sharp_angle, Surface& surface);

}  // namespace roughmesh::detail
