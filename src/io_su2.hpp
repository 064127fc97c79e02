// SPDX-License-Identifier: BSD-3-Clause
// What reader and writer of SU2 files share.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"

namespace roughmesh::detail {

/// SU2's numbers of elements are VTK's; nodes stand in Gmsh's order.
struct Su2Element {
  int number;
  ElementType type;
};

std::span<const Su2Element> su2_elements();

void check_for_su2(const Mesh& mesh, const std::filesystem::path& path);
std::vector<std::string> losses_of_su2(const Mesh& mesh);
void write_new_su2(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
