// SPDX-License-Identifier: BSD-3-Clause
// What reader and writer of Medit files share: the sections of elements.
// Format: Frey, MEDIT: an interactive mesh visualization software, INRIA RT-0253 (2001), and the
// list of keywords of libMeshb, https://github.com/LoicMarechal/libMeshb, for binary files.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"

namespace roughmesh::detail {

/// Numbers of keywords in binary files.
namespace medit_code {
inline constexpr int dimension = 3, vertices = 4, end = 54;
}

/// A section of elements: each as its nodes, numbered from 1, and a reference.
struct MeditElements {
  std::string_view keyword;
  int code;
  ElementType type;
  std::vector<int> places;  ///< of each of the file's nodes in Gmsh's order
};

std::span<const MeditElements> medit_elements();
const MeditElements* medit_elements_of(const ElementType& type);  ///< null where there is none

void check_for_medit(const Mesh& mesh, const std::filesystem::path& path);
std::vector<std::string> losses_of_medit(const Mesh& mesh);
void write_new_medit(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
