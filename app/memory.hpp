// SPDX-License-Identifier: BSD-3-Clause
// How the program asks the system for memory.
#pragma once

namespace roughmesh::app {

/// From here on freed memory stays with the program, for its next arrays, until it ends. By default
/// the C library hands arrays above 32 MiB back at once, and the system clears every page of the
/// next one: a third of the time of a large mesh.
void keep_freed_memory();

}  // namespace roughmesh::app
