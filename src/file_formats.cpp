// SPDX-License-Identifier: BSD-3-Clause
#include "file_formats.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace roughmesh::detail {
namespace {

// Binary STL stands before its text, because headers of binary files like to begin with "solid".
// Bulk data stands before MSH, because it may begin with a comment whose first sign is that of a
// section. Formats that only their extension gives away stand last.
constexpr std::array table = {&nastran_format, &msh4_format, &msh2_format,   &unv_format,
                              &stl_format,     &ply_format,  &off_format,    &vtk_format,
                              &medit_format,   &su2_format,  &abaqus_format, &ply2_format,
                              &obj_format,     &vtu_format};

std::string read_extensions() {
  std::string list;
  for (const FileFormat* format : table)
    for (const std::string_view extension : format->extensions)
      if (format->read != nullptr && list.find(extension) == list.npos)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", extension);
  return list;
}

// Names what a file with the extension of a format lacks of it.
[[noreturn]] void refuse_unrecognized(const FileBytes& file) {
  const std::string path = file.path.string();
  const std::string extension = lower_extension(file.path);
  for (const FileFormat* format : table)
    if (!format->beginning.empty() &&
        std::count(format->extensions.begin(), format->extensions.end(), extension) > 0)
      throw FormatError(fmt::format("{}:1: does not {}, so it is no {} file or is cut short", path,
                                    format->beginning, name(format->format)));
  throw InputError(fmt::format("{}: of a kind that is not read; convert it to one of {}", path,
                               read_extensions()));
}

bool is_consistent(const ElementBlock& block, Index n_nodes) {
  const auto is_node = [&](Index node) { return node >= 0 && node < n_nodes; };
  return block.nodes.size() == block.tags.size() * static_cast<std::size_t>(block.type.n_nodes) &&
         std::all_of(block.nodes.begin(), block.nodes.end(), is_node);
}

}  // namespace

std::span<const FileFormat* const> file_formats() { return table; }

const FileFormat& file_format(MeshFormat format) {
  return **std::find_if(table.begin(), table.end(),
                        [&](const FileFormat* each) { return each->format == format; });
}

const FileFormat& recognize(const FileBytes& file) {
  if (file.size == 0)
    throw FormatError(file.path.string() + ":1: the file is empty; save the mesh again");
  const std::string extension = lower_extension(file.path);
  for (const FileFormat* format : table)
    if (format->recognizes != nullptr && format->recognizes(file.view(), extension)) return *format;
  refuse_unrecognized(file);
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

void check_arrays(const Mesh& mesh, const std::filesystem::path& path) {
  const std::string file = path.string();
  if (mesh.nodes.empty() || n_elements(mesh) == 0)
    throw InputError(fmt::format("{}: a mesh without nodes or elements is not written", file));
  if (mesh.node_tags.size() != mesh.nodes.size())
    throw InputError(fmt::format("{}: {} nodes but {} node numbers; give each node one", file,
                                 mesh.n_nodes(), mesh.node_tags.size()));
  for (const ElementBlock& block : mesh.blocks)
    if (!is_consistent(block, mesh.n_nodes()))
      throw InputError(
          fmt::format("{}: a block of {} names nodes that do not exist or lacks numbers; give each "
                      "element a number and its nodes",
                      file, name(block.type)));
}

void check_elements(const Mesh& mesh, const std::filesystem::path& path, int most_order,
                    bool surface_only) {
  for (const ElementBlock& block : mesh.blocks) {
    if (block.size() == 0) continue;
    if (block.type.order > most_order || (surface_only && dimension(block.type.shape) == 3))
      throw InputError(fmt::format("{}: a {} cannot be written to this format; write .msh",
                                   path.string(), name(block.type)));
  }
}

}  // namespace roughmesh::detail
