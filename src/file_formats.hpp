// SPDX-License-Identifier: BSD-3-Clause
// One reader or writer per file format; read_mesh and write_mesh choose among them.
#pragma once

#include <limits>
#include <vector>

#include "roughmesh/mesh.hpp"
#include "roughmesh/mesh_io.hpp"

#include "mesh_source.hpp"
#include "output_file.hpp"

namespace roughmesh::detail {

Mesh read_msh(FileBytes file);
Mesh read_binary_stl(FileBytes file);
Mesh read_text_stl(FileBytes file);
Mesh read_ply2(FileBytes file);

bool is_binary_stl(std::string_view bytes);  ///< the size follows from the number of triangles
bool is_text_stl(std::string_view bytes);    ///< begins with "solid"

/// The source with the coordinates of moved nodes replaced: MSH and PLY2.
void write_patched(const Mesh& mesh, OutputFile& output);
void write_patched_stl(const Mesh& mesh, OutputFile& output);

/// Refuse a mesh that the format cannot hold.
/// @throws InputError
void check_for_msh4(const Mesh& mesh, const std::filesystem::path& path);
void check_for_vtu(const Mesh& mesh, const std::filesystem::path& path);

/// From the arrays alone, of a mesh that passed the check.
void write_new_msh4(const Mesh& mesh, OutputFile& output);
void write_vtu(const Mesh& mesh, const std::vector<PointField>& fields, OutputFile& output);

inline constexpr Tag largest_index = std::numeric_limits<Index>::max();

}  // namespace roughmesh::detail
