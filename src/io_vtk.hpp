// SPDX-License-Identifier: BSD-3-Clause
// Parts of the reader of legacy VTK files: the geometry, and the data at points and cells.
// Format: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/index.html; versions
// up to 5.1. Binary numbers are big-endian.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

/// A type of numbers in a binary file.
struct VtkType {
  std::string_view name;
  std::size_t n_bytes;
  bool is_integer;
};

/// Cells by their nodes: cell i has connectivity[starts[i]] to connectivity[starts[i + 1]].
struct VtkCells {
  std::vector<Tag> starts;
  std::vector<Tag> connectivity;
  std::size_t offset = 0;  ///< of the section, for messages

  std::size_t size() const { return starts.empty() ? 0 : starts.size() - 1; }
};

/// A legacy file while it is read.
struct VtkReader {
  explicit VtkReader(const FileBytes& file) : scanner(file) {}

  Scanner scanner;
  bool is_polydata = false;
  bool has_points = false;
  Mesh mesh;
  MeshSource source;
  std::map<std::string, VtkCells> cells;  ///< by the name of their section
  std::vector<Tag> cell_types;            ///< unstructured grids only
  /// Values of the arrays at cells that may tell groups or entities, by name.
  std::map<std::string, std::vector<Tag>> cell_arrays;

  bool is_text() const { return scanner.encoding() == Encoding::text; }
  std::size_t n_cells() const;
  const VtkType& read_type();
  /// So many numbers of a type, from here on in text, from the next line on in a binary file.
  std::vector<Tag> read_integers(const VtkType& type, Tag n);
  void skip_numbers(const VtkType& type, Tag n);
  std::size_t start_numbers(const VtkType& type, Tag n);
  Tag product(Tag a, Tag b) const;  ///< of counts; fails where it is beyond any file
};

/// The type called so, in any case of letters; null where there is none.
const VtkType* vtk_type(std::string_view name);

/// What follows the geometry: POINT_DATA, CELL_DATA, FIELD and the attributes in them.
class VtkDataReader {
 public:
  explicit VtkDataReader(VtkReader& reader) : reader_(&reader) {}

  /// Reads the section if it is one of data. @param section  in upper case
  bool read(const std::string& section);

 private:
  void start(bool is_at_points);
  bool read_attribute(const std::string& section);
  void read_scalars();
  void read_color_scalars();
  void read_lookup_table();
  void read_tuples(Tag n_components);
  void read_normals();
  void read_texture_coordinates();
  void read_field();
  void read_array();
  void skip_metadata();
  void read_values(const std::string& name, const VtkType& type, Tag n_components, Tag n_tuples);
  void add_normals(const VtkType& type);

  VtkReader* reader_;
  bool is_at_cells_ = false;
  bool is_at_points_ = false;
  Tag n_ = 0;
};

/// Arrays at cells whose values become the physical groups, the most telling first.
std::span<const std::string_view> vtk_group_arrays();
/// Likewise for entities.
std::span<const std::string_view> vtk_entity_arrays();

void write_new_vtk(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
