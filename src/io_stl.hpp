// SPDX-License-Identifier: BSD-3-Clause
// STL: loose triangles with a normal each. Format: 3D Systems, StereoLithography Interface
// Specification (1989); https://www.fabbers.com/tech/STL_Format
#pragma once

#include "file_formats.hpp"

namespace roughmesh::detail {

inline constexpr std::size_t stl_header_bytes = 80;
/// Of a binary file: twelve float32 and two bytes of attributes.
inline constexpr std::size_t stl_facet_bytes = 50;

void write_patched_stl(const Mesh& mesh, OutputFile& output);
void check_stl(const Mesh& mesh, const std::filesystem::path& path);
void write_new_stl(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
