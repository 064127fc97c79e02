// SPDX-License-Identifier: BSD-3-Clause
// MSH: the loop over sections, and the sections that all versions share.
#include "io_msh.hpp"

#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "gmsh_element_types.hpp"

namespace roughmesh::detail {

void MshReader::start_nodes(Tag n, std::size_t min_bytes_each) {
  if (has_nodes) scanner.fail("a second $Nodes section; a mesh has one");
  has_nodes = true;
  if (n == 0) scanner.fail("no nodes; save the mesh after meshing");
  if (n > largest_index)
    scanner.refuse(fmt::format(
        "{} nodes are more than the {} that roughmesh handles; split the mesh", n, largest_index));
  const std::size_t size = scanner.count(n, min_bytes_each, "nodes");
  mesh.nodes.reserve(size);
  mesh.node_tags.reserve(size);
  offsets.reserve(size);
}

void MshReader::add_position() {
  if (is_text()) scanner.skip_space();
  offsets.push_back(scanner.offset());
  const double x = scanner.real();
  const double y = scanner.real();
  const double z = scanner.real();
  mesh.nodes.emplace_back(x, y, z);
}

void MshReader::finish_nodes() {
  lookup = NodeLookup(mesh.node_tags);
  if (const auto duplicate = lookup.duplicate()) {
    const auto i = static_cast<std::size_t>(*duplicate);
    scanner.fail_at(offsets[i], fmt::format("two nodes have the number {}; renumber the mesh",
                                            mesh.node_tags[i]));
  }
}

Tag MshReader::group(Tag tag) const {
  if (tag == std::numeric_limits<Tag>::min())
    scanner.fail(fmt::format("physical group {} is beyond 2^63 - 1; renumber the groups", tag));
  return std::abs(tag);
}

void MshReader::start_elements() {
  if (has_elements) scanner.fail("a second $Elements section; a mesh has one");
  if (!has_nodes) scanner.fail("stands before $Nodes; put it behind");
  has_elements = true;
}

const ElementType& MshReader::element_type(Tag number) const {
  const ElementType* const type = element_type_from_gmsh(number);
  if (type == nullptr)
    scanner.fail(
        fmt::format("element type {} is none that roughmesh reads (points to pyramids of "
                    "order 1 to 10); save the mesh without such elements",
                    number));
  return *type;
}

void MshReader::check_element_count(Tag n) const {
  if (n > largest_index)
    scanner.refuse(
        fmt::format("{} elements are more than the {} that roughmesh handles; split the mesh", n,
                    largest_index));
}

Index MshReader::node(Tag tag) const {
  const Index index = lookup.find(tag);
  if (index < 0) [[unlikely]]
    scanner.fail(fmt::format("node {} is not in $Nodes; save the mesh with all its nodes", tag));
  return index;
}

// Gmsh itself saves pairs of nodes that it leaves out of $Nodes when only some groups are saved, so
// such a pair is no damage.
void MshReader::add_periodic_pair(PeriodicLink& link, Tag slave, Tag master) const {
  const Index a = lookup.find(slave);
  const Index b = lookup.find(master);
  if (a >= 0 && b >= 0) link.nodes.emplace_back(a, b);
}

namespace {

const char* const conversion = "convert it: gmsh -save -format msh41 -o NEW.msh OLD.msh";

void expect_end(Scanner& scanner) {
  const std::string expected = "$End" + scanner.section().substr(1);
  scanner.skip_space();
  if (scanner.at_end())
    scanner.fail(fmt::format("the file ends before {}: it is cut short", expected));
  const std::size_t start = scanner.offset();
  const std::string_view found = scanner.text_token();
  if (found != expected)
    scanner.fail_at(
        start, fmt::format("expected {}, found {}: a count is wrong or the file damaged", expected,
                           quoted(found)));
}

MeshFormat format_of_version(Scanner& scanner, std::string_view version) {
  double number = 0;
  const auto [stop, error] =
      std::from_chars(version.data(), version.data() + version.size(), number);
  if (error != std::errc() || stop != version.data() + version.size())
    scanner.fail(fmt::format("{} is no version number: the file is damaged", quoted(version)));
  if (number == 2.0 || number == 2.1 || number == 2.2) return MeshFormat::msh2;
  if (number == 4.1) return MeshFormat::msh4;
  scanner.refuse(fmt::format("MSH version {} is not read, only 2.2 and 4.1; {}", printable(version),
                             conversion));
}

void read_byte_order(Scanner& scanner) {
  scanner.line();
  scanner.set_encoding(Encoding::binary, false);
  const std::size_t start = scanner.offset();
  const Tag one = scanner.integer();
  constexpr Tag swapped_one = 0x01000000;
  if (one != 1 && one != swapped_one)
    scanner.fail_at(start,
                    "the mark of the byte order is neither 1 nor its reverse: the file is damaged");
  scanner.set_encoding(Encoding::binary, one == swapped_one);
}

void read_format(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  if (reader.mesh.format != MeshFormat::none) scanner.fail("a second $MeshFormat section");
  const std::string version(scanner.text_token());
  reader.mesh.format = format_of_version(scanner, version);
  const Tag file_type = scanner.text_integer();
  const Tag data_size = scanner.text_integer();
  if (file_type != 0 && file_type != 1)
    scanner.fail(fmt::format("file type {} is neither 0 (text) nor 1 (binary)", file_type));
  if (data_size != 8 && !(data_size == 4 && file_type == 0))
    scanner.refuse(fmt::format("numbers of {} bytes are not read, only those of 8; {}", data_size,
                               conversion));
  if (file_type == 1) read_byte_order(scanner);
}

void read_physical_names(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  const std::size_t n = scanner.count(scanner.text_integer(), 6, "names");
  for (std::size_t i = 0; i < n; ++i) {
    const Tag dim = scanner.text_integer();
    if (dim < 0 || dim > 3) scanner.fail(fmt::format("dimension {} is not 0 to 3", dim));
    const Tag tag = scanner.text_integer();
    const std::string_view rest = scanner.line();
    const std::size_t open = rest.find('"');
    const std::size_t close = rest.rfind('"');
    if (open == rest.npos || close == open) scanner.fail("a group's name lacks its quotes");
    reader.names[{static_cast<int>(dim), reader.group(tag)}] =
        rest.substr(open + 1, close - open - 1);
  }
}

// Sections that are not looked into: data, comments, whatever another program has added.
void skip_section(Scanner& scanner) {
  const std::string end = "$End" + scanner.section().substr(1);
  const std::size_t start = scanner.offset();
  const std::string_view rest = scanner.rest();
  for (std::size_t found = rest.find(end); found != rest.npos; found = rest.find(end, found + 1)) {
    const std::size_t stop = found + end.size();
    if (stop < rest.size() && !is_space(rest[stop])) continue;
    return scanner.move_to(start + stop);
  }
  scanner.fail(fmt::format("{} is missing: the file is cut short", printable(end)));
}

using SectionReader = void (*)(MshReader&);

SectionReader reader_of_section(MeshFormat format, std::string_view section) {
  const bool is_4 = format == MeshFormat::msh4;
  if (section == "$MeshFormat") return read_format;
  if (section == "$PhysicalNames") return read_physical_names;
  if (section == "$Nodes") return is_4 ? read_msh4_nodes : read_msh2_nodes;
  if (section == "$Elements") return is_4 ? read_msh4_elements : read_msh2_elements;
  if (section == "$Periodic") return is_4 ? read_msh4_periodic : read_msh2_periodic;
  if (section == "$Entities" && is_4) return read_msh4_entities;
  if (section == "$PartitionedEntities" && is_4) return read_msh4_partitioned_entities;
  return nullptr;
}

void check_section_name(Scanner& scanner, std::string_view section) {
  if (section == "$NOD")
    scanner.refuse(fmt::format("MSH version 1 is not read, only 2.2 and 4.1; {}", conversion));
  if (section == "$ParametricNodes")
    scanner.refuse("$ParametricNodes is not read; save the mesh with Mesh.SaveParametric = 0");
  if (section == "$") scanner.fail("a section without a name");
  if (section.starts_with("$End"))
    scanner.fail(fmt::format("{} without a section that it ends", quoted(section)));
}

void read_section(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  scanner.set_section("");
  if (scanner.peek() != '$')
    scanner.fail(fmt::format("{} stands outside of any section: the file is damaged",
                             quoted(Scanner(scanner).text_token())));
  const std::size_t start = scanner.offset();
  const std::string section(Scanner(scanner).text_token());
  check_section_name(scanner, section);
  scanner.set_section(section);
  scanner.line();
  const SectionReader read = reader_of_section(reader.mesh.format, section);
  if (reader.mesh.format == MeshFormat::none && read != read_format && section != "$Comments")
    scanner.fail_at(start, "stands before $MeshFormat; put it behind");
  if (read == nullptr) return skip_section(scanner);
  read(reader);
  expect_end(scanner);
}

void check_complete(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  scanner.set_section("");
  if (reader.mesh.format == MeshFormat::none) scanner.fail("no $MeshFormat section: no MSH file");
  if (!reader.has_nodes) scanner.fail("no $Nodes section: the file is cut short");
  if (!reader.has_elements) scanner.fail("no $Elements section: the file is cut short");
}

// In 4.1 groups belong to entities, which may stand anywhere in the file.
void assign_groups(MshReader& reader) {
  if (reader.mesh.format != MeshFormat::msh4) return;
  for (ElementBlock& block : reader.mesh.blocks) {
    const auto found = reader.entities.find({dimension(block.type.shape), block.entity});
    if (found == reader.entities.end()) continue;
    block.physical_groups = found->second.groups;
    block.entity = found->second.elementary;
  }
}

void list_groups(MshReader& reader) {
  for (const ElementBlock& block : reader.mesh.blocks)
    for (const Tag group : block.physical_groups)
      reader.names.try_emplace({dimension(block.type.shape), group});
  for (const auto& [key, name] : reader.names)
    reader.mesh.groups.push_back({key.first, key.second, name});
}

void read_sections(MshReader& reader) {
  for (reader.scanner.skip_space(); !reader.scanner.at_end(); reader.scanner.skip_space())
    read_section(reader);
  check_complete(reader);
  assign_groups(reader);
  list_groups(reader);
}

bool is_msh(std::string_view bytes, std::string_view) {
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  return start != bytes.npos && bytes[start] == '$';
}

Mesh read_msh(FileBytes file) {
  MshReader reader(file);
  read_sections(reader);
  MeshSource source;
  if (!reader.is_text()) source.coordinates = NumberFormat::float64;
  source.swap_bytes = reader.scanner.swap_bytes();
  source.offsets = std::move(reader.offsets);
  attach_source(reader.mesh, std::move(source), std::move(file));
  return std::move(reader.mesh);
}

}  // namespace

const FileFormat msh4_format = {
    .format = MeshFormat::msh4,
    .extensions = {".msh"},
    .beginning = "begin with $MeshFormat (a geometry script has to be called .geo)",
    .recognizes = is_msh,
    .read = read_msh,
    .write_patched = write_patched,
    .check_new = check_for_msh,
    .write_new = write_new_msh4,
    .holds = {.groups = true,
              .several_groups = true,
              .group_names = true,
              .periodic_links = true,
              .tags = true},
    .losses = losses_of_msh,
    .encodings = {Encoding::text, Encoding::binary}};

// Recognized and read by the same code as MSH 4.1.
const FileFormat msh2_format = {.format = MeshFormat::msh2,
                                .extensions = {".msh"},
                                .write_patched = write_patched,
                                .check_new = check_for_msh2,
                                .write_new = write_new_msh2,
                                .holds = {.groups = true,
                                          .several_groups = true,
                                          .group_names = true,
                                          .periodic_links = true,
                                          .tags = true},
                                .losses = losses_of_msh,
                                .encodings = {Encoding::text, Encoding::binary}};

}  // namespace roughmesh::detail
