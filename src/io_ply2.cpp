// SPDX-License-Identifier: BSD-3-Clause
// PLY2: two counts, positions, faces by their corners; text in any arrangement of lines.
#include <array>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "file_formats.hpp"
#include "scanner.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {
namespace {

void read_positions(Scanner& scanner, std::size_t n, Mesh& mesh, MeshSource& source) {
  mesh.nodes.reserve(n);
  source.offsets.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    scanner.skip_space();
    source.offsets.push_back(scanner.offset());
    const double x = scanner.text_real();
    const double y = scanner.text_real();
    const double z = scanner.text_real();
    mesh.nodes.emplace_back(x, y, z);
  }
  number_nodes(mesh);
}

void read_face(Scanner& scanner, Tag number, Index n_nodes, BlockBuilder& blocks) {
  const Tag n_corners = scanner.text_integer();
  check_face_size(scanner, n_corners);
  std::array<Index, 4> corners{};
  for (Tag k = 0; k < n_corners; ++k)
    corners[static_cast<std::size_t>(k)] = checked_node(scanner, scanner.text_integer(), n_nodes);
  blocks.add_face(number, {corners.data(), static_cast<std::size_t>(n_corners)});
}

void read_faces(Scanner& scanner, std::size_t n, Mesh& mesh) {
  BlockBuilder blocks(mesh.blocks);
  for (std::size_t i = 0; i < n; ++i)
    read_face(scanner, static_cast<Tag>(i) + 1, mesh.n_nodes(), blocks);
}

Mesh read_ply2(FileBytes file) {
  Scanner scanner(file);
  const Tag n_announced = scanner.text_integer();
  const Tag n_faces_announced = scanner.text_integer();
  if (n_announced > largest_index || n_faces_announced > largest_index)
    scanner.refuse(fmt::format(
        "more nodes or faces than the {} that roughmesh handles; split the mesh", largest_index));
  if (n_announced == 0) scanner.fail("no nodes; save the mesh again");
  const std::size_t n_nodes = scanner.count(n_announced, 6, "nodes");
  const std::size_t n_faces = scanner.count(n_faces_announced, 8, "faces");
  Mesh mesh;
  MeshSource source;
  read_positions(scanner, n_nodes, mesh, source);
  read_faces(scanner, n_faces, mesh);
  scanner.skip_space();
  if (!scanner.at_end()) scanner.fail("something stands behind the last face: a count is wrong");
  mesh.format = MeshFormat::ply2;
  attach_source(mesh, std::move(source), std::move(file));
  return mesh;
}

}  // namespace

const FileFormat ply2_format = {
    .format = MeshFormat::ply2,
    .extensions = {".ply2"},
    .recognizes = [](std::string_view, std::string_view extension) { return extension == ".ply2"; },
    .read = read_ply2,
    .write_patched = write_patched};

}  // namespace roughmesh::detail
