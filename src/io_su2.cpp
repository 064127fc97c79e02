// SPDX-License-Identifier: BSD-3-Clause
// SU2: lines of the form KEY= value, each followed by as many lines of points or elements.
// Format: https://su2code.github.io/docs_v7/Mesh-File/
#include "io_su2.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

std::span<const Su2Element> su2_elements() {
  using enum ElementShape;
  static constexpr std::array table = {
      Su2Element{1, {point, 1, 1}},        Su2Element{3, {line, 1, 2}},
      Su2Element{5, {triangle, 1, 3}},     Su2Element{9, {quadrangle, 1, 4}},
      Su2Element{10, {tetrahedron, 1, 4}}, Su2Element{12, {hexahedron, 1, 8}},
      Su2Element{13, {prism, 1, 6}},       Su2Element{14, {pyramid, 1, 5}}};
  return table;
}

namespace {

/// The lines that follow a key with a count.
struct Section {
  std::size_t offset = 0;  ///< of the count
  Tag n = 0;
};

struct Marker {
  std::string name;
  Section elements;
};

struct Su2Reader {
  explicit Su2Reader(const FileBytes& file) : scanner(file) {}

  Scanner scanner;
  Tag dimension = 0;
  std::optional<Section> points, elements;
  std::vector<Marker> markers;
  std::optional<Tag> n_markers;
  Mesh mesh;
  MeshSource source;
  Tag n_elements = 0;  ///< read so far
};

struct KeyAndValue {
  std::string_view key, value;
  std::size_t value_offset = 0;
};

// The next line that has anything on it.
KeyAndValue read_key(Scanner& scanner) {
  scanner.skip_space();
  const std::size_t start = scanner.offset();
  const std::string_view line = scanner.line();
  const std::size_t equals = line.find('=');
  if (equals == line.npos) return {};
  return {trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)), start + equals + 1};
}

// The first number of a value: a second one counts points without those of other processors.
Tag whole_number(Su2Reader& reader, const KeyAndValue& line) {
  Scanner ahead = reader.scanner;
  ahead.move_to(line.value_offset);
  ahead.set_section(std::string(line.key));
  return ahead.text_integer();
}

Section read_section(Su2Reader& reader, const KeyAndValue& line) {
  Scanner& scanner = reader.scanner;
  scanner.set_section(std::string(line.key));
  const Tag n = whole_number(reader, line);
  if (n > largest_index)
    scanner.refuse(fmt::format(
        "{} points or elements are more than the {} that roughmesh handles; split the mesh", n,
        largest_index));
  const Section section{scanner.offset(), n};
  const std::size_t n_lines = scanner.count(n, 4, "lines");
  for (std::size_t i = 0; i < n_lines; ++i) {
    scanner.skip_space();
    scanner.line();
  }
  scanner.set_section("");
  return section;
}

void read_marker(Su2Reader& reader, const KeyAndValue& line) {
  if (line.value.empty()) reader.scanner.fail("a MARKER_TAG without a name; give it one");
  const KeyAndValue next = read_key(reader.scanner);
  if (!equal_ignoring_case(next.key, "MARKER_ELEMS"))
    reader.scanner.fail(
        fmt::format("expected MARKER_ELEMS behind the marker {}: the file is cut "
                    "short or damaged",
                    quoted(line.value)));
  reader.markers.push_back({std::string(line.value), read_section(reader, next)});
}

void set_once(Su2Reader& reader, std::optional<Section>& section, const KeyAndValue& line) {
  if (section)
    reader.scanner.fail_at(line.value_offset,
                           fmt::format("a second {}; a mesh has one", printable(line.key)));
  section = read_section(reader, line);
}

void refuse_zones(Su2Reader& reader, const KeyAndValue& line) {
  if (const Tag n = whole_number(reader, line); n != 1)
    reader.scanner.refuse(
        fmt::format("{} zones in a file are not read; split it into a file for each zone", n));
}

// Lines that are none of these, such as boxes of free-form deformation, stay as they are.
void find_sections(Su2Reader& reader) {
  Scanner& scanner = reader.scanner;
  for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
    const KeyAndValue line = read_key(scanner);
    if (equal_ignoring_case(line.key, "NDIME"))
      reader.dimension = whole_number(reader, line);
    else if (equal_ignoring_case(line.key, "NZONE"))
      refuse_zones(reader, line);
    else if (equal_ignoring_case(line.key, "NPOIN"))
      set_once(reader, reader.points, line);
    else if (equal_ignoring_case(line.key, "NELEM"))
      set_once(reader, reader.elements, line);
    else if (equal_ignoring_case(line.key, "NMARK"))
      reader.n_markers = whole_number(reader, line);
    else if (equal_ignoring_case(line.key, "MARKER_TAG"))
      read_marker(reader, line);
  }
}

void check_complete(Su2Reader& reader) {
  const Scanner& scanner = reader.scanner;
  if (reader.dimension != 2 && reader.dimension != 3)
    scanner.fail(fmt::format("NDIME is {} or missing; it has to be 2 or 3", reader.dimension));
  if (!reader.points) scanner.fail("no NPOIN: the file is cut short");
  if (!reader.elements) scanner.fail("no NELEM: the file is cut short");
  const auto n = static_cast<Tag>(reader.markers.size());
  if (reader.n_markers && *reader.n_markers != n)
    scanner.fail(
        fmt::format("{} markers where NMARK announces {}: the file is cut short or the "
                    "count is wrong",
                    n, *reader.n_markers));
}

/// The numbers of one line: too few or too many mean that the file is damaged.
class Line {
 public:
  explicit Line(Scanner& scanner) : scanner_(&scanner) {
    scanner.skip_space();
    Scanner ahead = scanner;
    ahead.line();
    end_ = ahead.offset();
  }

  /// @param most  numbers that may be left, such as the number of the point or element itself
  void finish(int most) {
    if (scanner_->offset() > end_)
      scanner_->fail_at(end_ - 1, "too few numbers on the line: the file is damaged");
    int n_left = 0;
    for (Scanner ahead = *scanner_; !ahead.text_token().empty() && ahead.offset() <= end_;)
      if (++n_left > most) scanner_->fail("too many numbers on the line: the file is damaged");
    scanner_->move_to(end_);
  }

 private:
  Scanner* scanner_;
  std::size_t end_ = 0;
};

void read_points(Su2Reader& reader) {
  Scanner& scanner = reader.scanner;
  const Section& section = *reader.points;
  scanner.move_to(section.offset);
  scanner.set_section("NPOIN");
  if (section.n == 0) scanner.fail("no points; save the mesh again");
  const auto n = scanner.count(section.n, 2 * static_cast<std::size_t>(reader.dimension), "points");
  reader.mesh.nodes.reserve(n);
  reader.source.offsets.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    Line line(scanner);
    reader.source.offsets.push_back(scanner.offset());
    Vec3& x = reader.mesh.nodes.emplace_back(Vec3::Zero());
    for (Tag k = 0; k < reader.dimension; ++k) x[k] = scanner.text_real();
    line.finish(2);  // its number, and that in the undivided mesh
  }
  number_nodes(reader.mesh);
}

const Su2Element& read_type(Su2Reader& reader) {
  const Tag number = reader.scanner.text_integer();
  for (const Su2Element& element : su2_elements())
    if (element.number == number) return element;
  reader.scanner.fail(
      fmt::format("element type {} is none of SU2's (3, 5, 9, 10, 12, 13, 14)", number));
}

void read_element(Su2Reader& reader, BlockBuilder& blocks, int dim) {
  Scanner& scanner = reader.scanner;
  Line line(scanner);
  const Su2Element& element = read_type(reader);
  const int found = dimension(element.type.shape);
  // Points on the border of a partition, which markers SEND_RECEIVE list.
  if (found == 0) return line.finish(2);
  if (found != dim)
    scanner.fail(fmt::format("a {} where elements of dimension {} stand: the file is damaged",
                             name(element.type), dim));
  ElementBlock& block = blocks.find(element.type);
  for (int k = 0; k < element.type.n_nodes; ++k) {
    const Tag node = scanner.text_integer();
    if (node < 0 || node >= reader.mesh.n_nodes())
      scanner.fail(fmt::format("point {} does not exist: they are numbered 0 to {}", node,
                               reader.mesh.n_nodes() - 1));
    block.nodes.push_back(static_cast<Index>(node));
  }
  block.tags.push_back(++reader.n_elements);
  line.finish(1);
}

void read_elements(Su2Reader& reader, BlockBuilder& blocks, const Section& section, Tag group,
                   int dim) {
  reader.scanner.move_to(section.offset);
  blocks.set_group(group);
  for (Tag i = 0; i < section.n; ++i) read_element(reader, blocks, dim);
}

// Markers of one name are one group; it has the number of the first.
void read_markers(Su2Reader& reader, BlockBuilder& blocks) {
  const int dim = static_cast<int>(reader.dimension) - 1;
  std::map<std::string_view, Tag> groups;
  for (std::size_t i = 0; i < reader.markers.size(); ++i) {
    const Marker& marker = reader.markers[i];
    if (equal_ignoring_case(marker.name, "SEND_RECEIVE")) continue;
    const auto [group, is_new] =
        groups.try_emplace(marker.name, static_cast<Tag>(groups.size()) + 1);
    if (is_new) reader.mesh.groups.push_back({dim, group->second, marker.name});
    reader.scanner.set_section(marker.name);
    read_elements(reader, blocks, marker.elements, group->second, dim);
  }
}

void read_all(Su2Reader& reader) {
  find_sections(reader);
  check_complete(reader);
  read_points(reader);
  reader.scanner.set_section("NELEM");
  BlockBuilder blocks(reader.mesh.blocks);
  read_elements(reader, blocks, *reader.elements, 0, static_cast<int>(reader.dimension));
  read_markers(reader, blocks);
  reader.scanner.set_section("");
  check_element_count(reader.scanner, reader.n_elements);
}

// The first line that is no comment begins with NDIME or NZONE, or the file is called so.
bool is_su2(std::string_view bytes, std::string_view extension) {
  if (extension == ".su2") return true;
  while (!bytes.empty()) {
    bytes = bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
    if (!bytes.starts_with('%')) break;
    bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size()));
  }
  const std::string_view key = trimmed(bytes.substr(0, std::min<std::size_t>(bytes.find('='), 9)));
  return equal_ignoring_case(key, "NDIME") || equal_ignoring_case(key, "NZONE");
}

Mesh read_su2(FileBytes file) {
  const bool has_comments = file.view().find('%') != std::string_view::npos;
  const FileBytes plain = has_comments ? without_comments(file, '%') : FileBytes{};
  Su2Reader reader(has_comments ? plain : file);
  read_all(reader);
  reader.source.n_coordinates = static_cast<int>(reader.dimension);
  reader.source.comment = '%';
  reader.mesh.format = MeshFormat::su2;
  attach_source(reader.mesh, std::move(reader.source), std::move(file));
  return std::move(reader.mesh);
}

}  // namespace

const FileFormat su2_format = {.format = MeshFormat::su2,
                               .extensions = {".su2"},
                               .recognizes = is_su2,
                               .read = read_su2,
                               .write_patched = write_patched,
                               .check_new = check_for_su2,
                               .write_new = write_new_su2,
                               .holds = {.groups = true, .group_names = true},
                               .losses = losses_of_su2};

}  // namespace roughmesh::detail
