// SPDX-License-Identifier: BSD-3-Clause
// What would crash gmsh, or make it run for nothing, is found before it is started.
#pragma once

#include "fill_volumes.hpp"

namespace roughmesh::detail {

/// HXT of gmsh 4.8.4 crashes at coincident nodes, exits at triangles listed twice and aborts at
/// coordinates that are not finite.
/// @throws InputError  these, and a volume whose boundary is open
/// @throws CheckError  triangles that intersect
void check_fill_task(const FillTask& task);

}  // namespace roughmesh::detail
