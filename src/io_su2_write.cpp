// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as SU2 from its arrays: elements of its dimension, and those of one less as
// markers.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "io_su2.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"

namespace roughmesh::detail {
namespace {

int su2_number(const ElementType& type) {
  for (const Su2Element& element : su2_elements())
    if (element.type == type) return element.number;
  return 0;
}

using BlocksOfMarker = std::map<Tag, std::vector<const ElementBlock*>>;  // 0: in no group

BlocksOfMarker blocks_of_markers(const Mesh& mesh, int dim) {
  BlocksOfMarker markers;
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0 && dimension(block.type.shape) == dim)
      markers[first_group(block)].push_back(&block);
  return markers;
}

// SU2 ends a name at a space. Elements in no group need a marker all the same.
std::string marker_name(const Mesh& mesh, int dim, Tag group) {
  if (group == 0) return "no_group";
  std::string text = group_name(mesh, dim, group);
  for (char& c : text)
    if (is_space(c) || c == '%' || c == '=') c = '_';
  return text;
}

// Names that have become alike are told apart by the number of the group.
std::map<Tag, std::string> marker_names(const Mesh& mesh, int dim, const BlocksOfMarker& markers) {
  std::map<Tag, std::string> names;
  std::set<std::string> taken;
  for (const auto& [group, blocks] : markers) {
    std::string name = marker_name(mesh, dim, group);
    while (!taken.insert(name).second) name += fmt::format("_{}", group);
    names[group] = name;
  }
  return names;
}

class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output)
      : mesh_(&mesh), numbers_(output, Encoding::text), dimension_(dimension(mesh)) {}

  void write_all() {
    numbers_.text(fmt::format("NDIME= {}\n", dimension_));
    write_elements();
    write_points();
    write_markers();
  }

 private:
  void write_elements() {
    numbers_.text(fmt::format("NELEM= {}\n", n_elements(*mesh_, dimension_)));
    Tag number = 0;
    for (const ElementBlock& block : mesh_->blocks)
      if (dimension(block.type.shape) == dimension_) write_block(block, &number);
  }

  void write_block(const ElementBlock& block, Tag* number) {
    for (Index i = 0; i < block.size(); ++i) {
      numbers_.number(su2_number(block.type));
      for (const Index node : block.element(i)) numbers_.number(node);
      if (number != nullptr) numbers_.number((*number)++);
      numbers_.end_line();
    }
  }

  void write_points() {
    numbers_.text(fmt::format("NPOIN= {}\n", mesh_->nodes.size()));
    for (std::size_t i = 0; i < mesh_->nodes.size(); ++i) {
      for (int k = 0; k < dimension_; ++k) numbers_.number(mesh_->nodes[i][k]);
      numbers_.number(i);
      numbers_.end_line();
    }
  }

  void write_markers() {
    const BlocksOfMarker markers = blocks_of_markers(*mesh_, dimension_ - 1);
    const auto names = marker_names(*mesh_, dimension_ - 1, markers);
    numbers_.text(fmt::format("NMARK= {}\n", markers.size()));
    for (const auto& [group, blocks] : markers) {
      std::int64_t n = 0;
      for (const ElementBlock* block : blocks) n += block->size();
      numbers_.text(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", names.at(group), n));
      for (const ElementBlock* block : blocks) write_block(*block, nullptr);
    }
  }

  const Mesh* mesh_;
  NumberWriter numbers_;
  int dimension_;
};

}  // namespace

void check_for_su2(const Mesh& mesh, const std::filesystem::path& path) {
  const int dim = dimension(mesh);
  if (dim < 2 || (dim == 2 && !is_plane(mesh)))
    throw InputError(
        fmt::format("{}: SU2 holds meshes of volumes, and of faces in the plane z = 0 "
                    "only; write .msh",
                    path.string()));
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0 && dimension(block.type.shape) >= dim - 1 && su2_number(block.type) == 0)
      throw InputError(
          fmt::format("{}: SU2 has no {}; write .msh", path.string(), name(block.type)));
}

std::vector<std::string> losses_of_su2(const Mesh& mesh) {
  const int dim = dimension(mesh);
  std::vector<std::string> losses;
  const auto n_groups =
      std::count_if(mesh.groups.begin(), mesh.groups.end(),
                    [&](const PhysicalGroup& group) { return group.dimension != dim - 1; });
  if (n_groups > 0)
    losses.push_back(
        fmt::format("{} physical groups that are not of dimension {}", n_groups, dim - 1));
  for (int d = 0; d < dim - 1; ++d)
    if (const std::int64_t n = n_elements(mesh, d); n > 0)
      losses.push_back(fmt::format("{} elements of dimension {}", n, d));
  return losses;
}

void write_new_su2(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  check_for_su2(mesh, output.path());  // positions may have left the plane since the last check
  Writer(mesh, output).write_all();
}

}  // namespace roughmesh::detail
