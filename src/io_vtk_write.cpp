// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as legacy VTK from its arrays: version 3.0, which every reader knows.
#include <bit>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "io_vtk.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"
#include "vtk_cells.hpp"

namespace roughmesh::detail {
namespace {

// Names end at spaces, so those are written as VTK does: %20.
std::string encoded(std::string_view name) {
  std::string result;
  for (const char c : name)
    if (c > 32 && c < 127 && c != '%' && c != '"')
      result += c;
    else
      result += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return result;
}

class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output, Encoding encoding)
      : mesh_(&mesh), numbers_(output, encoding, std::endian::big) {}

  void write_all(const std::vector<PointField>& fields) {
    numbers_.text(fmt::format("# vtk DataFile Version 3.0\nmesh\n{}\nDATASET UNSTRUCTURED_GRID\n",
                              numbers_.is_text() ? "ASCII" : "BINARY"));
    write_points();
    write_cells();
    write_cell_types();
    write_cell_data();
    if (!fields.empty()) write_fields(fields);
  }

 private:
  void end_numbers() { numbers_.text(numbers_.is_text() ? "" : "\n"); }

  void write_points() {
    numbers_.text(fmt::format("POINTS {} double\n", mesh_->nodes.size()));
    for (const Vec3& x : mesh_->nodes) {
      numbers_.vector(x);
      numbers_.end_line();
    }
    end_numbers();
  }

  void write_cells() {
    std::size_t n_numbers = 0;
    for (const ElementBlock& block : mesh_->blocks)
      n_numbers += block.nodes.size() + block.tags.size();
    numbers_.text(fmt::format("CELLS {} {}\n", n_elements(*mesh_), n_numbers));
    for (const ElementBlock& block : mesh_->blocks) {
      if (block.size() == 0) continue;
      const VtkCell& cell = *vtk_cell(block.type);
      for (Index i = 0; i < block.size(); ++i) {
        numbers_.number(static_cast<std::int32_t>(block.type.n_nodes));
        for (const int place : cell.places)
          numbers_.number(std::int32_t{block.element(i)[static_cast<std::size_t>(place)]});
        numbers_.end_line();
      }
    }
    end_numbers();
  }

  void write_cell_types() {
    numbers_.text(fmt::format("CELL_TYPES {}\n", n_elements(*mesh_)));
    for (const ElementBlock& block : mesh_->blocks)
      for (Index i = 0; i < block.size(); ++i) {
        numbers_.number(static_cast<std::int32_t>(vtk_cell(block.type)->number));
        numbers_.end_line();
      }
    end_numbers();
  }

  void write_cell_data() {
    numbers_.text(fmt::format("CELL_DATA {}\n", n_elements(*mesh_)));
    write_scalars("entity", [](const ElementBlock& block) { return block.entity; });
    write_scalars("physical_group", first_group);
  }

  // As int where all fit, because "long" has no fixed size and not all readers know vtktypeint64.
  void write_scalars(std::string_view name, const std::function<Tag(const ElementBlock&)>& value) {
    bool is_int = true;
    for (const ElementBlock& block : mesh_->blocks)
      is_int &= std::in_range<std::int32_t>(value(block));
    numbers_.text(fmt::format("SCALARS {} {} 1\nLOOKUP_TABLE default\n", name,
                              is_int ? "int" : "vtktypeint64"));
    for (const ElementBlock& block : mesh_->blocks)
      for (Index i = 0; i < block.size(); ++i) {
        if (is_int)
          numbers_.number(static_cast<std::int32_t>(value(block)));
        else
          numbers_.number(value(block));
        numbers_.end_line();
      }
    end_numbers();
  }

  void write_fields(const std::vector<PointField>& fields) {
    numbers_.text(
        fmt::format("POINT_DATA {}\nFIELD FieldData {}\n", mesh_->nodes.size(), fields.size()));
    for (const PointField& field : fields) {
      numbers_.text(fmt::format("{} {} {} double\n", encoded(field.name), field.n_components,
                                mesh_->nodes.size()));
      for (std::size_t i = 0; i < field.values.size(); ++i) {
        numbers_.number(field.values[i]);
        if ((i + 1) % static_cast<std::size_t>(field.n_components) == 0) numbers_.end_line();
      }
      end_numbers();
    }
  }

  const Mesh* mesh_;
  NumberWriter numbers_;
};

}  // namespace

void write_new_vtk(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  Writer(mesh, output, options.encoding.value_or(Encoding::text)).write_all(options.fields);
}

}  // namespace roughmesh::detail
