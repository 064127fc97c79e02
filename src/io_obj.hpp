// SPDX-License-Identifier: BSD-3-Clause
// OBJ: statements of text, a keyword and its arguments each; a backslash at the end of a line
// continues it. Format: Wavefront Advanced Visualizer manual, appendix B1, "Object Files".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"
#include "scanner.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {

/// The corners of faces that name a normal, face by face.
struct ObjCorners {
  std::vector<Index> nodes;
  std::vector<Index> normals;     ///< positions in ObjContent::normals, -1 for none
  std::vector<std::size_t> ends;  ///< of each face, in `nodes`
};

struct ObjContent {
  std::vector<Vec3> positions;         ///< of v
  std::vector<std::uint64_t> offsets;  ///< of the first number of each v
  std::vector<std::uint64_t> normals;  ///< likewise of each vn
  ObjCorners corners;                  ///< only where asked for
  std::vector<ElementBlock> blocks;
  std::vector<PhysicalGroup> groups;  ///< of the elements, sorted
};

/// @throws FormatError, InputError
ObjContent parse_obj(const FileBytes& file, bool keeps_corners);

/// The next word of a statement, on its next lines too if it is continued; empty at the end of the
/// statement or at a comment.
std::string_view obj_word(Scanner& scanner);

void write_patched_obj(const Mesh& mesh, OutputFile& output);
void check_obj(const Mesh& mesh, const std::filesystem::path& path);
void write_new_obj(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
