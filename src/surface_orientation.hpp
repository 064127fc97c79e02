// SPDX-License-Identifier: BSD-3-Clause
// Which way the faces of a surface look.
#pragma once

#include "roughmesh/mesh.hpp"

#include "surface_edges.hpp"
#include "surface_points.hpp"

namespace roughmesh::detail {

/// Turns faces so that neighbours agree and each piece looks where select_surface promises. The
/// first corner of each face stays first; `edges` are those of the faces as given.
/// @return             number of pieces connected through edges
/// @throws InputError  one-sided surface
Index orient_faces(const Mesh& mesh, const WeldedPoints& welded, const EdgeTable& edges,
                   Faces& faces);

}  // namespace roughmesh::detail
