// SPDX-License-Identifier: BSD-3-Clause
// Parts of the Abaqus reader and writer. Format: Abaqus Keywords Guide (also CalculiX's manual,
// http://www.dhondt.de/ccx_2.21.pdf, chapter 7).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "element_table.hpp"
#include "file_formats.hpp"
#include "node_orders.hpp"
#include "scanner.hpp"
#include "text.hpp"

namespace roughmesh::detail {

/// "*ELEMENT, TYPE=C3D4, ELSET=Eall": names and parameters in capitals without spaces, values as
/// they stand.
struct AbaqusKeyword {
  std::string name;
  std::map<std::string, std::string> parameters;

  bool has(const std::string& parameter) const { return parameters.count(parameter) > 0; }
  std::string value(const std::string& parameter) const;
};

AbaqusKeyword parse_abaqus_keyword(std::string_view text);
/// The fields between the commas, without space around them; a comma at the end adds none.
std::vector<std::string_view> comma_fields(std::string_view line);

enum class AbaqusRole : std::uint8_t {
  solid,
  plane,  ///< faces of it are its edges
  sheet,  ///< shells, membranes, rigid facets: a face of it is itself
  line,
  ignored  ///< springs, masses, connectors, cohesive layers: kept in the file only
};
struct AbaqusType {
  AbaqusRole role = AbaqusRole::ignored;
  ElementType type = {};
};
/// @param name  in capitals
std::optional<AbaqusType> abaqus_type(std::string_view name);
const NodeOrders& abaqus_node_orders();

/// *ELSET, *SURFACE and the ELSET of *ELEMENT: kept as they are listed, applied at the end.
class AbaqusSets {
 public:
  AbaqusSets(ElementTable& elements, const Scanner& scanner)
      : elements_(&elements), scanner_(&scanner) {}

  /// The roles of the elements, in their order.
  void add_element(AbaqusRole role, std::optional<Index> set);
  /// The set of this name, begun where there is none; one of the assembly may have the name of one
  /// of the part.
  Index set(const std::string& name, bool in_assembly, bool is_internal);
  /// A data line of *ELSET.
  void add_line(Index set, std::string_view line, bool generates, bool in_assembly);
  Index surface(const std::string& name);
  /// A data line of *SURFACE.
  void add_surface_line(Index surface, std::string_view line, bool in_assembly);

  /// Puts the elements into their groups and makes elements of the faces of surfaces; the names of
  /// the groups by number.
  std::map<Tag, std::string> apply();

 private:
  struct Set {
    std::string name;
    Tag group = 0;  ///< 0: none is made of it
    std::vector<Index> elements = {};
  };
  struct Item {
    Index set = 0;
    Index nested = -1;                  ///< a set, instead of numbers
    Tag first = 0, last = 0, step = 1;  ///< numbers of elements
    std::uint64_t offset = 0;
  };
  struct SurfaceItem {
    Item item;
    int face = 0;  ///< 0: all that are free, or the sheet itself
  };
  struct Face {
    Index element = 0;
    int face = 0;
    Tag group = 0;
    friend bool operator==(const Face&, const Face&) = default;
    friend bool operator<(const Face& a, const Face& b) {
      return std::tie(a.element, a.face, a.group) < std::tie(b.element, b.face, b.group);
    }
  };

  std::optional<Item> item(std::string_view field, bool in_assembly) const;
  std::optional<Index> find_set(std::string_view name, bool in_assembly) const;
  void spend(std::size_t n, std::uint64_t offset);
  void append(const Item& item, std::vector<Index>& elements);
  void append_range(const Item& item, std::vector<Index>& elements);
  void apply_surface(const SurfaceItem& line, std::vector<Face>& faces);
  void apply_face(Index element, int face, const SurfaceItem& line, std::vector<Face>& faces);
  const std::vector<Face>& free_faces();
  void add_faces(std::vector<Face> faces);
  void add_face_element(const Face& face, Tag number);

  ElementTable* elements_;
  const Scanner* scanner_;
  std::vector<AbaqusRole> roles_;
  std::map<std::pair<bool, std::string>, Index> set_names_;
  std::map<std::string, Index> surface_names_;
  std::vector<Set> sets_, surfaces_;
  std::vector<Item> items_;
  std::vector<SurfaceItem> surface_items_;
  std::vector<std::pair<Tag, Index>> by_number_;  ///< (number, element), sorted
  std::optional<std::vector<Face>> free_faces_;
  Tag n_groups_ = 0;
  std::size_t spent_ = 0;
};

void check_abaqus(const Mesh& mesh, const std::filesystem::path& path);
void write_new_abaqus(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
