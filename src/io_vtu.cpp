// SPDX-License-Identifier: BSD-3-Clause
// VTU (VTK XML unstructured grid), for looking at results: arrays as raw bytes behind the XML.
// Format: VTK File Formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#include <bit>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "new_file.hpp"
#include "vtk_cells.hpp"

namespace roughmesh::detail {
namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

// Writes the XML and hands out the offsets of the arrays, in the order in which they follow.
class Header {
 public:
  void add(std::string_view text) { xml_ += text; }
  void add_array(std::string_view type, std::string_view name, int n_components,
                 std::uint64_t n_bytes) {
    // Without the attribute an array is a scalar; readers make a column of "1".
    const std::string components =
        n_components == 1 ? "" : fmt::format(" NumberOfComponents=\"{}\"", n_components);
    xml_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n", type,
        escaped(name), components, offset_);
    offset_ += sizeof(std::uint64_t) + n_bytes;
  }
  const std::string& xml() const { return xml_; }

 private:
  std::string xml_;
  std::uint64_t offset_ = 0;
};

struct Sizes {
  std::uint64_t n_nodes, n_cells, n_corners;
};

Sizes sizes(const Mesh& mesh) {
  Sizes result{mesh.nodes.size(), 0, 0};
  for (const ElementBlock& block : mesh.blocks) {
    result.n_cells += block.tags.size();
    result.n_corners += block.nodes.size();
  }
  return result;
}

std::string header(const Sizes& n, const std::vector<PointField>& fields) {
  constexpr std::uint64_t word = 8;
  Header h;
  h.add("<?xml version=\"1.0\"?>\n");
  h.add(
      fmt::format("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
                  "header_type=\"UInt64\">\n  <UnstructuredGrid>\n",
                  std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian"));
  h.add(fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", n.n_nodes,
                    n.n_cells));
  h.add("      <Points>\n");
  h.add_array("Float64", "Points", 3, 3 * n.n_nodes * word);
  h.add("      </Points>\n      <Cells>\n");
  h.add_array("Int64", "connectivity", 1, n.n_corners * word);
  h.add_array("Int64", "offsets", 1, n.n_cells * word);
  h.add_array("UInt8", "types", 1, n.n_cells);
  h.add("      </Cells>\n      <CellData>\n");
  h.add_array("Int64", "entity", 1, n.n_cells * word);
  h.add_array("Int64", "physical_group", 1, n.n_cells * word);
  h.add("      </CellData>\n      <PointData>\n");
  for (const PointField& field : fields)
    h.add_array("Float64", field.name, field.n_components, field.values.size() * word);
  h.add("      </PointData>\n    </Piece>\n  </UnstructuredGrid>\n");
  h.add("  <AppendedData encoding=\"raw\">\n   _");
  return h.xml();
}

template <typename T>
void write_value(OutputFile& output, T value) {
  output.write({reinterpret_cast<const char*>(&value), sizeof value});
}

template <typename Element, typename Write>
void write_cells(OutputFile& output, const Mesh& mesh, std::uint64_t n_bytes, Write write) {
  write_value<std::uint64_t>(output, n_bytes);
  for (const ElementBlock& block : mesh.blocks)
    for (Index i = 0; i < block.size(); ++i) write_value<Element>(output, write(block));
}

void write_doubles(OutputFile& output, const double* values, std::size_t n) {
  write_value<std::uint64_t>(output, n * sizeof(double));
  output.write({reinterpret_cast<const char*>(values), n * sizeof(double)});
}

void write_connectivity(OutputFile& output, const Mesh& mesh, std::uint64_t n_corners) {
  write_value<std::uint64_t>(output, n_corners * sizeof(std::int64_t));
  for (const ElementBlock& block : mesh.blocks) {
    const VtkCell& cell = *vtk_cell(block.type);
    for (Index i = 0; i < block.size(); ++i)
      for (const int place : cell.places)
        write_value<std::int64_t>(output, block.element(i)[place]);
  }
}

void write_arrays(OutputFile& output, const Mesh& mesh, const Sizes& n) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const std::uint64_t cell_bytes = n.n_cells * sizeof(std::int64_t);
  write_doubles(output, mesh.nodes.empty() ? nullptr : mesh.nodes[0].data(), 3 * n.n_nodes);
  write_connectivity(output, mesh, n.n_corners);
  std::int64_t end = 0;
  write_cells<std::int64_t>(output, mesh, cell_bytes,
                            [&](const ElementBlock& block) { return end += block.type.n_nodes; });
  write_cells<std::uint8_t>(output, mesh, n.n_cells, [](const ElementBlock& block) {
    return static_cast<std::uint8_t>(vtk_cell(block.type)->number);
  });
  write_cells<std::int64_t>(output, mesh, cell_bytes,
                            [](const ElementBlock& block) { return block.entity; });
  write_cells<std::int64_t>(output, mesh, cell_bytes, first_group);
}

void write_vtu(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  const Sizes n = sizes(mesh);
  output.write(header(n, options.fields));
  write_arrays(output, mesh, n);
  for (const PointField& field : options.fields)
    write_doubles(output, field.values.data(), field.values.size());
  output.write("\n  </AppendedData>\n</VTKFile>\n");
}

}  // namespace

const FileFormat vtu_format = {.format = MeshFormat::vtu,
                               .extensions = {".vtu"},
                               .check_new = check_for_vtk,
                               .write_new = write_vtu,
                               .holds = {.point_fields = true},
                               .encodings = {Encoding::binary}};

}  // namespace roughmesh::detail
