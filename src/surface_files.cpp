// SPDX-License-Identifier: BSD-3-Clause
#include "surface_files.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace roughmesh::detail {
namespace {

bool is_held(const ElementBlock& block, int least_dimension) {
  const int dim = dimension(block.type.shape);
  return block.size() > 0 && dim >= least_dimension && dim <= 2;
}

}  // namespace

void check_face_size(const Scanner& scanner, Tag n_corners) {
  if (n_corners != 3 && n_corners != 4)
    scanner.fail(fmt::format("a face with {} corners; split it into triangles", n_corners));
}

Index checked_node(const Scanner& scanner, Tag number, Index n_nodes) {
  if (number < 0 || number >= n_nodes)
    scanner.fail(
        fmt::format("node {} does not exist: they are numbered 0 to {}", number, n_nodes - 1));
  return static_cast<Index>(number);
}

SurfacePart::SurfacePart(const Mesh& mesh, int least_dimension) : numbers(mesh.nodes.size(), -1) {
  std::vector<bool> is_left_out(mesh.nodes.size());
  for (const ElementBlock& block : mesh.blocks)
    if (!is_held(block, least_dimension))
      for (const Index node : block.nodes) is_left_out[node] = true;
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_held(block, least_dimension)) continue;
    blocks.push_back(&block);
    for (const Index node : block.nodes) is_left_out[node] = false;
  }
  for (Index i = 0; i < mesh.n_nodes(); ++i) {
    if (is_left_out[i]) continue;
    numbers[i] = static_cast<Index>(nodes.size());
    nodes.push_back(i);
  }
}

std::int64_t n_elements(const SurfacePart& part, int dim) {
  std::int64_t n = 0;
  for (const ElementBlock* block : part.blocks)
    if (dimension(block->type.shape) == dim) n += block->size();
  return n;
}

void check_surface_part(const Mesh& mesh, const std::filesystem::path& path, int least_dimension) {
  if (n_elements(mesh, 2) == 0)
    throw InputError(
        fmt::format("{}: the mesh has no surface elements, and the format holds no others; write "
                    ".msh",
                    path.string()));
  for (const ElementBlock& block : mesh.blocks)
    if (is_held(block, least_dimension) && block.type.order > 1)
      throw InputError(fmt::format("{}: a {} cannot be written to this format; write .msh",
                                   path.string(), name(block.type)));
}

}  // namespace roughmesh::detail
