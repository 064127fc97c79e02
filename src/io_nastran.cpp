// SPDX-License-Identifier: BSD-3-Clause
// Nastran bulk data: GRID in small, large and free fields, and elements whose properties are
// groups.
#include "io_nastran.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "element_table.hpp"
#include "fortran_real.hpp"

namespace roughmesh::detail {
namespace {

struct ElementCard {
  std::string_view name;
  ElementShape shape;
  int most_order = 1;
  bool has_property = true;
};

constexpr std::array element_cards = {
    ElementCard{"CTRIA3", ElementShape::triangle},
    ElementCard{"CTRIAR", ElementShape::triangle},
    ElementCard{"CTRIA6", ElementShape::triangle, 2},
    ElementCard{"CQUAD4", ElementShape::quadrangle},
    ElementCard{"CQUADR", ElementShape::quadrangle},
    ElementCard{"CSHEAR", ElementShape::quadrangle},
    ElementCard{"CQUAD8", ElementShape::quadrangle, 2},
    ElementCard{"CTETRA", ElementShape::tetrahedron, 2},
    ElementCard{"CHEXA", ElementShape::hexahedron, 2},
    ElementCard{"CPENTA", ElementShape::prism, 2},
    ElementCard{"CPYRAM", ElementShape::pyramid, 2},
    ElementCard{"CPYRA", ElementShape::pyramid, 2},
    ElementCard{"CROD", ElementShape::line},
    ElementCard{"CTUBE", ElementShape::line},
    ElementCard{"CBAR", ElementShape::line},
    ElementCard{"CBEAM", ElementShape::line},
    ElementCard{"CBEND", ElementShape::line},
    ElementCard{"CBEAM3", ElementShape::line, 2},
    ElementCard{"CONROD", ElementShape::line, 1, false},
    ElementCard{"PLOTEL", ElementShape::line, 1, false},
};

// Elements of areas and volumes whose nodes stand in another order or number.
constexpr std::array<std::string_view, 12> unread = {"CQUAD",   "CTRIAX",  "CTRIAX6", "CQUADX",
                                                     "CQUADX4", "CQUADX8", "CTRAX3",  "CTRAX6",
                                                     "CTRIA",   "CHEXCZ",  "CPLSTN3", "CPLSTN4"};

constexpr std::array second_order = {
    NodeOrder{{ElementShape::tetrahedron, 2, 10}, "0 1 2 3 01 12 02 03 13 23"},
    NodeOrder{{ElementShape::hexahedron, 2, 20},
              "0 1 2 3 4 5 6 7 01 12 23 03 04 15 26 37 45 56 67 47"},
    NodeOrder{{ElementShape::prism, 2, 15}, "0 1 2 3 4 5 01 12 02 03 14 25 34 45 35"},
    NodeOrder{{ElementShape::pyramid, 2, 13}, "0 1 2 3 4 01 12 23 03 04 14 24 34"},
};

const ElementCard* find_card(std::string_view name) {
  const auto* const place =
      std::find_if(element_cards.begin(), element_cards.end(),
                   [&](const ElementCard& card) { return card.name == name; });
  return place == element_cards.end() ? nullptr : place;
}

class Reader {
 public:
  explicit Reader(const FileBytes& file) : reader_(file), file_(&file) {}

  Mesh read();
  MeshSource source() { return std::move(source_); }

 private:
  void read_card(const BulkCard& card);
  void read_grid(const BulkCard& card);
  void read_element(const BulkCard& card, const ElementCard& kind);
  ElementType type_of(const BulkCard& card, const ElementCard& kind, std::size_t first) const;
  Tag number(const BulkCard& card, std::size_t field, std::string_view what) const;
  void read_name(std::string_view comment);
  void require_basic(const BulkCard& card, std::size_t field) const;
  std::uint64_t offset(const BulkCard& card) const {
    return static_cast<std::uint64_t>(card.lines[0].data() - file_->data.get());
  }
  [[noreturn]] void fail(const BulkCard& card, const std::string& what) const {
    Scanner place(*file_);
    place.set_section(card.name);
    place.fail_at(offset(card), what);
  }

  BulkReader reader_;
  const FileBytes* file_;
  Mesh mesh_;
  MeshSource source_;
  ElementTable elements_;
  std::map<Tag, std::string> names_;
};

Mesh Reader::read() {
  Scanner& scanner = reader_.scanner();
  reader_.move_to_bulk();
  BulkCard card;
  while (reader_.next(card)) {
    for (const std::string_view comment : reader_.comments()) read_name(comment);
    read_card(card);
  }
  if (mesh_.nodes.empty()) scanner.fail("no nodes; save the mesh with its GRID entries");
  if (elements_.size() == 0)
    scanner.fail("no elements; save the mesh with elements such as CTRIA3 or CTETRA");
  elements_.fill(mesh_, source_.offsets, names_, scanner);
  mesh_.format = MeshFormat::nastran;
  return std::move(mesh_);
}

void Reader::read_card(const BulkCard& card) {
  if (card.name == "GRID") return read_grid(card);
  if (card.name == "GRDSET") return require_basic(card, 2);
  if (const ElementCard* const kind = find_card(card.name)) return read_element(card, *kind);
  if (std::find(unread.begin(), unread.end(), card.name) != unread.end())
    reader_.scanner().refuse(fmt::format(
        "{} elements are not handled; use others or leave them out of the file", card.name));
  if (card.name.starts_with("INCLUDE"))
    reader_.scanner().refuse(
        "INCLUDE takes lines from a file that is not read; put its lines into "
        "this file");
  if (card.name.starts_with('='))
    reader_.scanner().refuse(
        "entries that repeat the one before (=) are not followed; save the "
        "file with each entry written out");
}

Tag Reader::number(const BulkCard& card, std::size_t field, std::string_view what) const {
  const std::optional<Tag> value = whole_number(card.field(field));
  if (!value || *value < 0)
    fail(card, fmt::format("expected the number of {}, found {}", what, quoted(card.field(field))));
  return *value;
}

void Reader::require_basic(const BulkCard& card, std::size_t field) const {
  const std::string_view text = card.field(field);
  if (text.empty() || whole_number(text) == 0) return;
  Scanner(*file_).refuse(
      fmt::format("{} {} is in coordinate system {}; save the mesh in the basic "
                  "one (0)",
                  card.name, printable(card.field(1)), printable(text)));
}

void Reader::read_grid(const BulkCard& card) {
  const Tag tag = number(card, 1, "a node");
  require_basic(card, 2);
  if (mesh_.nodes.size() >= static_cast<std::size_t>(largest_index))
    reader_.scanner().refuse("more nodes than roughmesh handles; split the mesh");
  Vec3 x = Vec3::Zero();  // a blank field is 0
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view text = card.field(3 + k);
    if (text.empty()) continue;
    const std::optional<double> value = fortran_real(text);
    if (!value) fail(card, fmt::format("node {}: {} is no finite number", tag, quoted(text)));
    x[static_cast<Eigen::Index>(k)] = *value;
  }
  mesh_.nodes.push_back(x);
  mesh_.node_tags.push_back(tag);
  source_.offsets.push_back(offset(card));
}

// Elements of order 2 may leave out all nodes on their edges, but roughmesh has none with some.
ElementType Reader::type_of(const BulkCard& card, const ElementCard& kind,
                            std::size_t first) const {
  const ElementType linear = serendipity_type(kind.shape, 1);
  if (kind.most_order == 1) return linear;
  const ElementType quadratic = serendipity_type(kind.shape, 2);
  int n_middles = 0;
  for (int k = linear.n_nodes; k < quadratic.n_nodes; ++k)
    n_middles += !card.field(first + static_cast<std::size_t>(k)).empty();
  if (n_middles == 0) return linear;
  if (n_middles < quadratic.n_nodes - linear.n_nodes)
    fail(card,
         fmt::format("element {} has {} of the {} nodes on its edges: it is cut short, or give "
                     "it all or none",
                     printable(card.field(1)), n_middles, quadratic.n_nodes - linear.n_nodes));
  return quadratic;
}

void Reader::read_element(const BulkCard& card, const ElementCard& kind) {
  const Tag tag = number(card, 1, "an element");
  const bool has_property = kind.has_property && !card.field(2).empty();
  const Tag property = has_property ? number(card, 2, "a property") : 0;
  const std::size_t first = kind.has_property ? 3 : 2;
  const ElementType type = type_of(card, kind, first);
  std::vector<Tag> nodes;
  for (const int place : nastran_node_orders().in_file(type))
    nodes.push_back(number(card, first + static_cast<std::size_t>(place), "a node"));
  const Index element = elements_.add({type, property, tag, offset(card)}, nodes);
  if (property > 0) elements_.add_to_group(element, property);
}

// "$ Femap Property 3 : Steel" and "$HMNAME PROP 3"Steel" 4", as two preprocessors name properties.
void Reader::read_name(std::string_view comment) {
  const auto take = [&](std::string_view prefix, char before, char after) {
    if (!comment.starts_with(prefix)) return;
    Tag property = 0;
    std::string_view rest = comment.substr(prefix.size());
    while (rest.starts_with(' ')) rest.remove_prefix(1);
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), property);
    rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
    const std::size_t begin = rest.find(before);
    if (error != std::errc() || begin == rest.npos) return;
    rest.remove_prefix(begin + 1);
    rest = rest.substr(0, std::min(rest.find(after), rest.size()));
    while (rest.starts_with(' ')) rest.remove_prefix(1);
    while (rest.ends_with(' ')) rest.remove_suffix(1);
    if (!rest.empty()) names_[property] = rest;
  };
  take("$ Femap Property ", ':', '\n');
  take("$HMNAME PROP ", '"', '"');
}

Mesh read_nastran(FileBytes file) {
  Reader reader(file);
  Mesh mesh = reader.read();
  attach_source(mesh, reader.source(), std::move(file));
  return mesh;
}

// Is there a line that begins with GRID? Many programs call their data .dat.
bool has_grid(std::string_view bytes) {
  const auto equal = [](char a, char b) { return (a | 0x20) == (b | 0x20); };
  for (std::size_t start = 0; start < bytes.size();) {
    const std::string_view name = bytes.substr(start, 5);
    constexpr std::string_view grid = "GRID";
    if (name.size() == 5 && std::equal(grid.begin(), grid.end(), name.begin(), equal) &&
        (is_space(name[4]) || name[4] == '*' || name[4] == ','))
      return true;
    const std::size_t end = bytes.find('\n', start);
    start = end == bytes.npos ? bytes.size() : end + 1;
  }
  return false;
}

// Comments begin with $, as sections of MSH do; MSH that is called .bdf stays MSH.
bool is_nastran(std::string_view bytes, std::string_view extension) {
  if (bytes.substr(0, 4096).find("$MeshFormat") != bytes.npos) return false;
  if (extension == ".dat" || extension == ".fem") return has_grid(bytes);
  return extension == ".bdf" || extension == ".nas";
}

}  // namespace

const NodeOrders& nastran_node_orders() {
  static const NodeOrders orders(second_order);
  return orders;
}

const FileFormat nastran_format = {
    .format = MeshFormat::nastran,
    .extensions = {".bdf", ".nas", ".fem", ".dat"},
    .recognizes = is_nastran,
    .read = read_nastran,
    .write_patched = write_patched_nastran,
    .check_new = check_nastran,
    .write_new = write_new_nastran,
    .holds = {.groups = true, .group_names = true, .tags = true, .least_dimension = 1},
    .spacing = nastran_spacing,
    .new_spacing = new_nastran_spacing};

}  // namespace roughmesh::detail
