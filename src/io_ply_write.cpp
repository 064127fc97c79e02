// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "corner_normals.hpp"
#include "io_patch.hpp"
#include "io_ply.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"
#include "surface_files.hpp"

namespace roughmesh::detail {
namespace {

NumberFormat number_format(const Scanner& scanner, PlyType type) {
  if (scanner.encoding() == Encoding::text) return NumberFormat::text;
  return type == PlyType::float32 ? NumberFormat::float32 : NumberFormat::float64;
}

// New numbers for one vertex; null where they stay.
struct VertexChange {
  const Vec3* from = nullptr;
  const Vec3* to = nullptr;
  const Vec3* normal = nullptr;

  std::optional<double> value(int role) const {
    if (role >= PlyVertexLayout::normal)
      return normal != nullptr ? std::optional((*normal)[role - PlyVertexLayout::normal])
                               : std::nullopt;
    if (role < 0 || same_bits((*from)[role], (*to)[role])) return std::nullopt;
    return (*to)[role];
  }
};

void patch_vertex(Scanner& scanner, const PlyElement& vertex, const PlyVertexLayout& layout,
                  const VertexChange& change, TriplePatcher& patcher) {
  for (std::size_t p = 0; p < layout.roles.size(); ++p) {
    const PlyProperty& property = vertex.properties[p];
    if (scanner.encoding() == Encoding::text) scanner.skip_space();
    const std::size_t start = scanner.offset();
    skip_ply_property(scanner, property);
    if (const auto value = change.value(layout.roles[p]))
      patcher.replace_number(start, scanner.offset() - start, number_format(scanner, property.type),
                             *value);
  }
}

// Names of properties are single words, and no two of them may be equal.
class PropertyNames {
 public:
  std::string add(std::string name) {
    for (char& c : name)
      if (static_cast<unsigned char>(c) <= 32 || c == 127) c = '_';
    while (name.empty() || !taken_.insert(name).second) name += '_';
    return name;
  }

 private:
  std::set<std::string> taken_ = {"x", "y", "z"};
};

std::string component_name(const PointField& field, int k) {
  constexpr std::array letters = {'x', 'y', 'z'};
  const auto axis = static_cast<std::size_t>(k);
  if (field.n_components == 1) return field.name;
  if (field.n_components > 3) return fmt::format("{}_{}", field.name, k);
  // What every program takes for the normal of a vertex.
  if (field.name == "normal" && field.n_components == 3) return fmt::format("n{}", letters[axis]);
  return fmt::format("{}_{}", field.name, letters[axis]);
}

class PlyWriter {
 public:
  PlyWriter(const Mesh& mesh, const WriteOptions& options, OutputFile& output)
      : mesh_(&mesh),
        options_(&options),
        output_(&output),
        part_(mesh, 1),
        encoding_(options.encoding.value_or(Encoding::binary)),
        has_groups_(
            std::any_of(part_.blocks.begin(), part_.blocks.end(),
                        [](const ElementBlock* block) { return first_group(*block) != 0; })) {}

  void write() {
    write_header();
    write_vertices();
    write_elements(2);
    write_elements(1);
  }

 private:
  template <typename... Values>
  void text(fmt::format_string<Values...> format, Values&&... values) {
    output_->write(fmt::format(format, std::forward<Values>(values)...));
  }

  void write_header() {
    text("ply\nformat {} 1.0\n", encoding_ == Encoding::text ? "ascii" : "binary_little_endian");
    text("comment written by roughmesh\n");
    for (const PhysicalGroup& group : mesh_->groups)
      if (!group.name.empty() && group.dimension >= 1 && group.dimension <= 2)
        text("comment {} {} {} {}\n", ply_group, group.dimension, group.tag,
             group_name(group, GroupNames::of_dimension));
    text("element vertex {}\n", part_.nodes.size());
    for (const char axis : {'x', 'y', 'z'}) text("property double {}\n", axis);
    write_field_names();
    text("element face {}\nproperty list uchar int vertex_indices\n", n_elements(part_, 2));
    if (has_groups_) text("property int {}\n", ply_group);
    write_edge_header();
    text("end_header\n");
  }

  void write_field_names() {
    PropertyNames names;
    for (const PointField& field : options_->fields)
      for (int k = 0; k < field.n_components; ++k)
        text("property double {}\n", names.add(component_name(field, k)));
  }

  void write_edge_header() {
    if (n_elements(part_, 1) == 0) return;
    text("element edge {}\nproperty int vertex1\nproperty int vertex2\n", n_elements(part_, 1));
    if (has_groups_) text("property int {}\n", ply_group);
  }

  void write_vertices() {
    NumberWriter row(*output_, encoding_, std::endian::little);
    for (const Index node : part_.nodes) {
      row.vector(mesh_->nodes[node]);
      for (const PointField& field : options_->fields) {
        const auto n = static_cast<std::size_t>(field.n_components);
        for (std::size_t k = 0; k < n; ++k)
          row.number(field.values[static_cast<std::size_t>(node) * n + k]);
      }
      row.end_line();
    }
  }

  void write_elements(int dim) {
    NumberWriter row(*output_, encoding_, std::endian::little);
    for (const ElementBlock* block : part_.blocks) {
      if (dimension(block->type.shape) != dim) continue;
      for (Index i = 0; i < block->size(); ++i) {
        if (dim == 2) row.number(static_cast<std::uint8_t>(block->type.n_nodes));
        for (const Index node : block->element(i)) row.number(std::int32_t{part_.numbers[node]});
        if (has_groups_) row.number(static_cast<std::int32_t>(first_group(*block)));
        row.end_line();
      }
    }
  }

  const Mesh* mesh_;
  const WriteOptions* options_;
  OutputFile* output_;
  SurfacePart part_;
  Encoding encoding_;
  bool has_groups_;
};

}  // namespace

void write_patched_ply(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  Scanner scanner(source.file);
  const PlyHeader header = read_ply_header(scanner);
  const PlyElement& vertex = *header.find("vertex");
  const PlyVertexLayout layout(vertex);
  std::vector<Vec3> normals;
  std::vector<bool> is_stale(mesh.nodes.size());
  if (layout.has_normals) {
    normals = node_normals(mesh, stored_positions(mesh));
    is_stale = is_at_moved_face(mesh);
  }
  TriplePatcher patcher(source, output);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!is_stale[i] && same_bits(source.positions[i], mesh.nodes[i])) continue;
    scanner.move_to(source.offsets[i]);
    patch_vertex(scanner, vertex, layout,
                 {&source.positions[i], &mesh.nodes[i], is_stale[i] ? &normals[i] : nullptr},
                 patcher);
  }
  patcher.finish();
}

void check_ply(const Mesh& mesh, const std::filesystem::path& path) {
  check_surface_part(mesh, path, 1);
  for (const ElementBlock* block : SurfacePart(mesh, 1).blocks) {
    const Tag group = first_group(*block);
    if (group != static_cast<std::int32_t>(group))
      throw InputError(
          fmt::format("{}: the group number {} does not fit into the 32 bits of a PLY "
                      "file; write .msh",
                      path.string(), group));
  }
}

void write_new_ply(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  PlyWriter(mesh, options, output).write();
}

}  // namespace roughmesh::detail
