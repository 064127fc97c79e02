// SPDX-License-Identifier: BSD-3-Clause
// Legacy VTK: the head, points and cells, and how they become a mesh.
#include "io_vtk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "vtk_cells.hpp"

namespace roughmesh::detail {

namespace {

void read_head(VtkReader& reader) {
  Scanner& scanner = reader.scanner;
  scanner.line();
  scanner.line();  // title
  scanner.skip_space();
  const std::size_t start = scanner.offset();
  const std::string_view encoding = trimmed(scanner.line());
  const bool is_binary = equal_ignoring_case(encoding, "BINARY");
  if (!is_binary && !equal_ignoring_case(encoding, "ASCII"))
    scanner.fail_at(start, fmt::format("expected ASCII or BINARY, found {}: the file is damaged or "
                                       "cut short",
                                       quoted(encoding)));
  if (is_binary) scanner.set_encoding(Encoding::binary, std::endian::native != std::endian::big);
}

void read_dataset(VtkReader& reader) {
  const std::string_view kind = reader.scanner.text_token();
  reader.is_polydata = equal_ignoring_case(kind, "POLYDATA");
  if (!reader.is_polydata && !equal_ignoring_case(kind, "UNSTRUCTURED_GRID"))
    reader.scanner.refuse(
        fmt::format("a {} is not read, only UNSTRUCTURED_GRID and POLYDATA; convert it (in "
                    "ParaView: filter Clean to Grid)",
                    kind.empty() ? "file without a dataset" : printable(kind)));
}

double read_coordinate(Scanner& scanner, NumberFormat format) {
  if (format == NumberFormat::text) return scanner.text_real();
  const std::size_t start = scanner.offset();
  const double value =
      format == NumberFormat::float32 ? double{scanner.bytes<float>()} : scanner.bytes<double>();
  if (!std::isfinite(value))
    scanner.fail_at(start, "a number is not finite: mend it or make the mesh anew");
  return value;
}

void read_points(VtkReader& reader) {
  Scanner& scanner = reader.scanner;
  if (reader.has_points) scanner.fail("a second POINTS section; a mesh has one");
  reader.has_points = true;
  const Tag n = scanner.text_integer();
  const VtkType& type = reader.read_type();
  if (n == 0) scanner.fail("no points; save the mesh again");
  if (n > largest_index)
    scanner.refuse(fmt::format(
        "{} points are more than the {} that roughmesh handles; split the mesh", n, largest_index));
  NumberFormat format = type.n_bytes == 4 ? NumberFormat::float32 : NumberFormat::float64;
  if (reader.is_text()) format = NumberFormat::text;
  if (format != NumberFormat::text && type.is_integer)
    scanner.refuse(
        "positions are whole numbers, which leave no room for roughness; save them as "
        "double");
  const std::size_t n_numbers = reader.start_numbers(type, reader.product(3, n));
  reader.source.coordinates = format;
  reader.source.swap_bytes = scanner.swap_bytes();
  reader.mesh.nodes.reserve(n_numbers / 3);
  reader.source.offsets.reserve(n_numbers / 3);
  for (Tag i = 0; i < n; ++i) {
    if (reader.is_text()) scanner.skip_space();
    reader.source.offsets.push_back(scanner.offset());
    Vec3& x = reader.mesh.nodes.emplace_back();
    for (int k = 0; k < 3; ++k) x[k] = read_coordinate(scanner, format);
  }
}

// Since version 5.1: where each cell begins, then the nodes of all.
void read_offsets(VtkReader& reader, Tag n_starts, Tag n_nodes, VtkCells& cells) {
  Scanner& scanner = reader.scanner;
  scanner.text_token();
  cells.starts = reader.read_integers(reader.read_type(), n_starts);
  scanner.skip_space();
  const std::size_t start = scanner.offset();
  if (const auto found = scanner.text_token(); !equal_ignoring_case(found, "CONNECTIVITY"))
    scanner.fail_at(start, fmt::format("expected CONNECTIVITY, found {}: a count is wrong or the "
                                       "file is cut short",
                                       quoted(found)));
  cells.connectivity = reader.read_integers(reader.read_type(), n_nodes);
  const std::vector<Tag>& starts = cells.starts;
  if (!starts.empty() && (starts.front() != 0 || starts.back() != n_nodes ||
                          !std::is_sorted(starts.begin(), starts.end())))
    scanner.fail_at(cells.offset,
                    "the offsets do not rise from 0 to the number of connectivity: "
                    "the file is damaged");
}

// Before: each cell as its number of nodes and the nodes.
void read_counted(VtkReader& reader, Tag n_cells, Tag n_numbers, VtkCells& cells) {
  reader.scanner.count(n_cells, 4, "cells");
  const std::vector<Tag> numbers = reader.read_integers(*vtk_type("int"), n_numbers);
  cells.starts = {0};
  std::size_t place = 0;
  for (Tag i = 0; i < n_cells; ++i) {
    const std::size_t n_left = numbers.size() - place;
    const Tag n = n_left > 0 ? numbers[place] : -1;
    if (n < 0 || static_cast<std::size_t>(n) >= n_left)
      reader.scanner.fail_at(
          cells.offset, fmt::format("cell {} does not fit into the section: a count is wrong", i));
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(place) + 1;
    cells.connectivity.insert(cells.connectivity.end(), first, first + n);
    cells.starts.push_back(static_cast<Tag>(cells.connectivity.size()));
    place += static_cast<std::size_t>(n) + 1;
  }
  if (place != numbers.size())
    reader.scanner.fail_at(cells.offset,
                           fmt::format("{} numbers are left behind the last cell: a count is wrong",
                                       numbers.size() - place));
}

void read_cells(VtkReader& reader, const std::string& section) {
  Scanner& scanner = reader.scanner;
  if (reader.cells.contains(section)) scanner.fail("a second section of the same name");
  VtkCells& cells = reader.cells[section];
  cells.offset = scanner.offset();
  const Tag n = scanner.text_integer();
  const Tag n_numbers = scanner.text_integer();
  if (n > largest_index)
    scanner.refuse(fmt::format(
        "{} cells are more than the {} that roughmesh handles; split the mesh", n, largest_index));
  Scanner ahead = scanner;
  ahead.line();
  if (reader.is_text()) ahead.skip_space();
  if (ahead.rest().starts_with("OFFSETS") || ahead.rest().starts_with("offsets"))
    return read_offsets(reader, n, n_numbers, cells);
  read_counted(reader, n, n_numbers, cells);
}

void read_cell_types(VtkReader& reader) {
  reader.cell_types = reader.read_integers(*vtk_type("int"), reader.scanner.text_integer());
}

bool read_geometry(VtkReader& reader, const std::string& section) {
  constexpr std::array<std::string_view, 3> lists = {"VERTICES", "LINES", "POLYGONS"};
  if (section == "POINTS")
    read_points(reader);
  else if (section == "CELL_TYPES" && !reader.is_polydata)
    read_cell_types(reader);
  else if (section == "TRIANGLE_STRIPS" && reader.is_polydata)
    reader.scanner.refuse(
        "triangle strips are not read; save the surface as triangles (in "
        "ParaView: filter Triangulate)");
  else if ((section == "CELLS" && !reader.is_polydata) ||
           (reader.is_polydata && std::count(lists.begin(), lists.end(), section) > 0))
    read_cells(reader, section);
  else
    return false;
  return true;
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 32);
  return result;
}

void read_sections(VtkReader& reader) {
  Scanner& scanner = reader.scanner;
  VtkDataReader data(reader);
  bool has_dataset = false;
  for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
    scanner.set_section("");
    const std::size_t start = scanner.offset();
    const std::string section = upper(scanner.text_token());
    scanner.set_section(section);
    if (section == "DATASET" && !has_dataset) {
      read_dataset(reader);
      has_dataset = true;
    } else if (!has_dataset || !(read_geometry(reader, section) || data.read(section))) {
      scanner.set_section("");
      scanner.fail_at(start, fmt::format("{} is no section that belongs here: a count is wrong or "
                                         "the file is damaged",
                                         quoted(std::string_view(section))));
    }
  }
  scanner.set_section("");
  if (!has_dataset) scanner.fail("no DATASET: the file is cut short");
}

/// A cell with its place in the sections.
struct CellPlace {
  const VtkCells* cells;
  std::size_t i;  ///< in them
  Tag number;     ///< in the file, from 0
  std::size_t n_nodes() const {
    return static_cast<std::size_t>(cells->starts[i + 1] - cells->starts[i]);
  }
};

// Cells without a fixed number of nodes are what their number makes them.
Tag plain_type(Tag type, std::size_t n_nodes) {
  constexpr Tag poly_vertex = 2, poly_line = 4, polygon = 7;
  if (type == poly_vertex && n_nodes == 1) return 1;
  if (type == poly_line && n_nodes == 2) return 3;
  if (type == polygon && n_nodes == 3) return 5;
  if (type == polygon && n_nodes == 4) return 9;
  return type;
}

[[noreturn]] void refuse_type(const VtkReader& reader, const CellPlace& place, Tag type) {
  reader.scanner.refuse(
      fmt::format("cell {} is of VTK's type {} with {} nodes, for which roughmesh has no element; "
                  "split such cells or save the mesh without them",
                  place.number, type, place.n_nodes()));
}

void add_cell(VtkReader& reader, const CellPlace& place, Tag type, ElementBlock& block,
              const VtkCell& cell) {
  const Tag* const nodes = place.cells->connectivity.data() + place.cells->starts[place.i];
  if (place.n_nodes() != cell.places.size())
    reader.scanner.fail_at(
        place.cells->offset,
        fmt::format("cell {} of VTK's type {} has {} nodes instead of {}: the file is damaged",
                    place.number, type, place.n_nodes(), cell.places.size()));
  const std::size_t first = block.nodes.size();
  block.nodes.resize(first + cell.places.size());
  for (std::size_t k = 0; k < cell.places.size(); ++k) {
    if (nodes[k] < 0 || nodes[k] >= reader.mesh.n_nodes())
      reader.scanner.fail_at(
          place.cells->offset,
          fmt::format("cell {} has node {}, which does not exist: they are numbered 0 to {}",
                      place.number, nodes[k], reader.mesh.n_nodes() - 1));
    block.nodes[first + static_cast<std::size_t>(cell.places[k])] = static_cast<Index>(nodes[k]);
  }
  block.tags.push_back(place.number + 1);
}

const std::vector<Tag>* first_array(const VtkReader& reader,
                                    std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    if (const auto found = reader.cell_arrays.find(std::string(name));
        found != reader.cell_arrays.end())
      return &found->second;
  return nullptr;
}

// Data at the cells of a POLYDATA count its vertices first, then lines, then polygons, in whichever
// order they stand.
std::vector<std::pair<const VtkCells*, Tag>> cell_sections(const VtkReader& reader) {
  std::vector<std::pair<const VtkCells*, Tag>> sections;
  constexpr std::array<std::pair<std::string_view, Tag>, 4> order = {
      {{"VERTICES", 2}, {"LINES", 4}, {"POLYGONS", 7}, {"CELLS", 0}}};
  for (const auto& [name, type] : order)
    if (const auto found = reader.cells.find(std::string(name)); found != reader.cells.end())
      sections.emplace_back(&found->second, type);
  return sections;
}

void add_cells(VtkReader& reader) {
  const std::vector<Tag>* const groups = first_array(reader, vtk_group_arrays());
  const std::vector<Tag>* const entities = first_array(reader, vtk_entity_arrays());
  BlockBuilder blocks(reader.mesh.blocks);
  Tag number = 0;
  for (const auto& [cells, list_type] : cell_sections(reader))
    for (std::size_t i = 0; i < cells->size(); ++i, ++number) {
      const auto n = static_cast<std::size_t>(number);
      const CellPlace place{cells, i, number};
      const Tag stated = list_type != 0 ? list_type : reader.cell_types[n];
      if (stated == 0) continue;  // an empty cell
      const Tag type = plain_type(stated, place.n_nodes());
      const VtkCell* const cell = vtk_cell(type);
      if (cell == nullptr) refuse_type(reader, place, type);
      blocks.set_group(groups == nullptr ? 0 : (*groups)[n]);
      ElementBlock& block = blocks.find(cell->type, entities == nullptr ? 0 : (*entities)[n]);
      add_cell(reader, place, type, block, *cell);
    }
  reader.mesh.groups = used_groups(reader.mesh.blocks);
}

void check_complete(VtkReader& reader) {
  const Scanner& scanner = reader.scanner;
  if (!reader.has_points) scanner.fail("no POINTS: the file is cut short");
  if (reader.n_cells() == 0) scanner.fail("no cells: the file is cut short or holds points only");
  if (!reader.is_polydata && reader.cell_types.size() != reader.n_cells())
    scanner.fail(
        fmt::format("{} cells but {} cell types: a count is wrong or the file is cut short",
                    reader.n_cells(), reader.cell_types.size()));
}

bool is_vtk(std::string_view bytes, std::string_view) {
  constexpr std::string_view mark = "# vtk DataFile";
  return equal_ignoring_case(bytes.substr(0, mark.size()), mark);
}

Mesh read_vtk(FileBytes file) {
  VtkReader reader(file);
  read_head(reader);
  read_sections(reader);
  check_complete(reader);
  number_nodes(reader.mesh);
  add_cells(reader);
  if (reader.mesh.blocks.empty()) reader.scanner.fail("all cells are empty; save the mesh again");
  reader.mesh.format = MeshFormat::vtk;
  attach_source(reader.mesh, std::move(reader.source), std::move(file));
  return std::move(reader.mesh);
}

}  // namespace

const FileFormat vtk_format = {.format = MeshFormat::vtk,
                               .extensions = {".vtk"},
                               .beginning = "begin with \"# vtk DataFile Version\"",
                               .recognizes = is_vtk,
                               .read = read_vtk,
                               .write_patched = write_patched,
                               .check_new = check_for_vtk,
                               .write_new = write_new_vtk,
                               .holds = {.groups = true, .point_fields = true},
                               .encodings = {Encoding::text, Encoding::binary}};

}  // namespace roughmesh::detail
