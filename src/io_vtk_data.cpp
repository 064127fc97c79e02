// SPDX-License-Identifier: BSD-3-Clause
// Legacy VTK: data at points and cells, most of which is only passed over.
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include <fmt/format.h>

#include "io_vtk.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::array<std::string_view, 12> group_arrays = {
    "physical_group", "gmsh:physical", "medit:ref", "su2:tag",  "material",  "materials",
    "materialids",    "material_id",   "region",    "regionid", "region_id", "cellentityids"};
constexpr std::array<std::string_view, 3> entity_arrays = {"entity", "gmsh:geometrical",
                                                           "cellentityids"};

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// In lower case, with %41 and its like decoded.
std::string plain_name(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    char c = name[i];
    if (c == '%' && i + 2 < name.size() && hexadecimal(name[i + 1]) >= 0 &&
        hexadecimal(name[i + 2]) >= 0) {
      c = static_cast<char>(16 * hexadecimal(name[i + 1]) + hexadecimal(name[i + 2]));
      i += 2;
    }
    result += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  }
  return result;
}

bool tells_groups(std::string_view name) {
  return std::count(group_arrays.begin(), group_arrays.end(), name) > 0 ||
         std::count(entity_arrays.begin(), entity_arrays.end(), name) > 0;
}

// Exporters write "nan" for nodes without a face.
double lenient_real(std::string_view token) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (token.starts_with('+')) token.remove_prefix(1);
  std::from_chars(token.data(), token.data() + token.size(), value);
  return value;
}

}  // namespace

std::span<const std::string_view> vtk_group_arrays() { return group_arrays; }
std::span<const std::string_view> vtk_entity_arrays() { return entity_arrays; }

bool VtkDataReader::read(const std::string& section) {
  if (section == "POINT_DATA")
    start(true);
  else if (section == "CELL_DATA")
    start(false);
  else if (section == "FIELD")
    read_field();
  else if (section == "METADATA")
    skip_metadata();
  else
    return (is_at_points_ || is_at_cells_) && read_attribute(section);
  return true;
}

bool VtkDataReader::read_attribute(const std::string& section) {
  if (section == "SCALARS")
    read_scalars();
  else if (section == "COLOR_SCALARS")
    read_color_scalars();
  else if (section == "LOOKUP_TABLE")
    read_lookup_table();
  else if (section == "NORMALS")
    read_normals();
  else if (section == "VECTORS")
    read_tuples(3);
  else if (section == "TENSORS")
    read_tuples(9);
  else if (section == "TENSORS6")
    read_tuples(6);
  else if (section == "TEXTURE_COORDINATES")
    read_texture_coordinates();
  else if (section == "GLOBAL_IDS" || section == "PEDIGREE_IDS" || section == "EDGE_FLAGS")
    read_tuples(1);
  else
    return false;
  return true;
}

void VtkDataReader::start(bool is_at_points) {
  is_at_points_ = is_at_points;
  is_at_cells_ = !is_at_points;
  n_ = reader_->scanner.text_integer();
  const Tag n_due = is_at_points ? reader_->mesh.n_nodes() : static_cast<Tag>(reader_->n_cells());
  if (n_ != n_due)
    reader_->scanner.fail(fmt::format("data for {} {} where there are {}: a count is wrong", n_,
                                      is_at_points ? "points" : "cells", n_due));
}

void VtkDataReader::read_scalars() {
  Scanner& scanner = reader_->scanner;
  const std::string name = plain_name(scanner.text_token());
  const VtkType& type = reader_->read_type();
  const std::string_view rest = trimmed(scanner.line());
  Tag n_components = 1;
  std::from_chars(rest.data(), rest.data() + rest.size(), n_components);
  scanner.skip_space();
  const std::size_t start = scanner.offset();
  if (const auto found = scanner.text_token(); !equal_ignoring_case(found, "LOOKUP_TABLE"))
    scanner.fail_at(start, fmt::format("expected LOOKUP_TABLE, found {}: the file is damaged or "
                                       "cut short",
                                       quoted(found)));
  scanner.text_token();
  read_values(name, type, n_components, n_);
}

// Bytes in a binary file, numbers from 0 to 1 in text.
void VtkDataReader::read_color_scalars() {
  reader_->scanner.text_token();
  const Tag n_components = reader_->scanner.text_integer();
  reader_->skip_numbers(*vtk_type("unsigned_char"), reader_->product(n_components, n_));
}

void VtkDataReader::read_lookup_table() {
  reader_->scanner.text_token();
  const Tag n = reader_->scanner.text_integer();
  reader_->skip_numbers(*vtk_type("unsigned_char"), reader_->product(4, n));
}

void VtkDataReader::read_tuples(Tag n_components) {
  const std::string name = plain_name(reader_->scanner.text_token());
  read_values(name, reader_->read_type(), n_components, n_);
}

void VtkDataReader::read_normals() {
  reader_->scanner.text_token();
  const VtkType& type = reader_->read_type();
  if (is_at_points_ && reader_->source.vectors.empty() && (reader_->is_text() || !type.is_integer))
    return add_normals(type);
  reader_->skip_numbers(type, reader_->product(3, n_));
}

void VtkDataReader::add_normals(const VtkType& type) {
  Scanner& scanner = reader_->scanner;
  MeshSource& source = reader_->source;
  const bool is_text = reader_->is_text();
  reader_->start_numbers(type, reader_->product(3, n_));
  if (!is_text)
    source.vector_numbers = type.n_bytes == 4 ? NumberFormat::float32 : NumberFormat::float64;
  source.vectors.resize(static_cast<std::size_t>(n_));
  for (Index i = 0; i < n_; ++i) {
    if (is_text) scanner.skip_space();
    NodeVector& normal = source.vectors[static_cast<std::size_t>(i)];
    normal.offset = scanner.offset();
    normal.node = i;
    for (int k = 0; k < 3; ++k) {
      if (is_text) {
        const std::string_view token = scanner.text_token();
        if (token.empty()) scanner.fail("the file ends here: it is cut short");
        normal.value[k] = lenient_real(token);
      } else {
        normal.value[k] =
            type.n_bytes == 4 ? double{scanner.bytes<float>()} : scanner.bytes<double>();
      }
    }
  }
}

void VtkDataReader::read_texture_coordinates() {
  reader_->scanner.text_token();
  const Tag n_components = reader_->scanner.text_integer();
  reader_->skip_numbers(reader_->read_type(), reader_->product(n_components, n_));
}

void VtkDataReader::read_field() {
  reader_->scanner.text_token();
  const Tag n = reader_->scanner.text_integer();
  reader_->scanner.count(n, 8, "arrays");
  for (Tag i = 0; i < n; ++i) read_array();
}

void VtkDataReader::read_array() {
  Scanner& scanner = reader_->scanner;
  std::string name = plain_name(scanner.text_token());
  while (name == "metadata") {
    skip_metadata();
    name = plain_name(scanner.text_token());
  }
  if (name == "null_array") return;
  const Tag n_components = scanner.text_integer();
  const Tag n_tuples = scanner.text_integer();
  read_values(name, reader_->read_type(), n_components, n_tuples);
}

// Ends with an empty line.
void VtkDataReader::skip_metadata() {
  reader_->scanner.line();
  while (!reader_->scanner.at_end() && !trimmed(reader_->scanner.line()).empty()) continue;
}

void VtkDataReader::read_values(const std::string& name, const VtkType& type, Tag n_components,
                                Tag n_tuples) {
  const bool is_telling = is_at_cells_ && n_components == 1 && n_tuples == n_ && type.is_integer &&
                          type.n_bytes > 0 && tells_groups(name);
  if (is_telling)
    reader_->cell_arrays.try_emplace(name, reader_->read_integers(type, n_tuples));
  else
    reader_->skip_numbers(type, reader_->product(n_components, n_tuples));
}

}  // namespace roughmesh::detail
