// SPDX-License-Identifier: BSD-3-Clause
// STL: loose triangles with a normal each. Corners at equal positions become one node.
#include "io_stl.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "coincident.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {
namespace {

// Triangles of a file before their corners are glued.
struct Soup {
  std::vector<Vec3> corners;  // three for each facet
  std::vector<StlFacet> facets;
};

void add_nodes(Mesh& mesh, Soup& soup) {
  const std::vector<Index> first = first_at_each_position(soup.corners);
  std::vector<Index> node_of_corner(first.size());
  for (std::size_t c = 0; c < first.size(); ++c) {
    const bool is_new = first[c] == static_cast<Index>(c);
    node_of_corner[c] = is_new ? mesh.n_nodes() : node_of_corner[first[c]];
    if (is_new) mesh.nodes.push_back(soup.corners[c]);
    soup.facets[c / 3].nodes[c % 3] = node_of_corner[c];
  }
  number_nodes(mesh);
}

void add_facets(ElementBlock& block, const Soup& soup, std::size_t begin, std::size_t end) {
  block.tags.reserve(end - begin);
  block.nodes.reserve(3 * (end - begin));
  for (std::size_t f = begin; f < end; ++f) {
    block.tags.push_back(static_cast<Tag>(f) + 1);
    block.nodes.insert(block.nodes.end(), soup.facets[f].nodes.begin(), soup.facets[f].nodes.end());
  }
}

void attach_source(Mesh& mesh, FileBytes file, Soup soup, NumberFormat format) {
  MeshSource source;
  source.coordinates = format;
  source.swap_bytes = format == NumberFormat::float32 && std::endian::native == std::endian::big;
  source.facets = std::move(soup.facets);
  mesh.format = MeshFormat::stl;
  attach_source(mesh, std::move(source), std::move(file));
}

std::size_t n_binary_facets(std::string_view bytes) {
  std::uint32_t n = 0;
  std::memcpy(&n, bytes.data() + stl_header_bytes, sizeof n);
  return std::endian::native == std::endian::big ? reverse_bytes(n) : n;
}

float binary_float(std::string_view bytes, std::size_t offset) {
  float value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return std::endian::native == std::endian::big ? reverse_bytes(value) : value;
}

Vec3 binary_corner(const FileBytes& file, std::size_t offset) {
  Vec3 corner;
  for (int k = 0; k < 3; ++k) {
    corner[k] = binary_float(file.view(), offset + static_cast<std::size_t>(k) * sizeof(float));
    if (!std::isfinite(corner[k]))
      throw FormatError(
          fmt::format("{}: byte {}: a corner is not finite: mend it or make the mesh anew",
                      file.path.string(), offset));
  }
  return corner;
}

Soup binary_soup(const FileBytes& file, std::size_t n) {
  Soup soup;
  soup.facets.resize(n);
  soup.corners.reserve(3 * n);
  for (std::size_t f = 0; f < n; ++f) {
    StlFacet& facet = soup.facets[f];
    facet.normal = stl_header_bytes + sizeof(std::uint32_t) + stl_facet_bytes * f;
    for (std::size_t k = 0; k < 3; ++k) {
      facet.vertices[k] = facet.normal + 3 * sizeof(float) * (k + 1);
      soup.corners.push_back(binary_corner(file, facet.vertices[k]));
    }
  }
  return soup;
}

void expect_words(Scanner& scanner, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    scanner.skip_space();
    const std::size_t start = scanner.offset();
    const std::string_view found = scanner.text_token();
    if (found.empty()) scanner.fail("the file ends inside a solid: it is cut short");
    if (!equal_ignoring_case(found, word))
      scanner.fail_at(
          start, fmt::format("expected {}, found {}: the file is damaged", word, quoted(found)));
  }
}

// The normal is not read: exporters write "nan" for triangles without area.
void read_text_facet(Scanner& scanner, Soup& soup) {
  StlFacet& facet = soup.facets.emplace_back();
  expect_words(scanner, {"normal"});
  scanner.skip_space();
  facet.normal = scanner.offset();
  for (int k = 0; k < 3; ++k) scanner.skip_number(sizeof(float));
  expect_words(scanner, {"outer", "loop"});
  for (std::uint64_t& offset : facet.vertices) {
    expect_words(scanner, {"vertex"});
    scanner.skip_space();
    offset = scanner.offset();
    const double x = scanner.text_real();
    const double y = scanner.text_real();
    const double z = scanner.text_real();
    soup.corners.emplace_back(x, y, z);
  }
  expect_words(scanner, {"endloop", "endfacet"});
}

struct Solid {
  std::string name;
  std::size_t begin = 0, end = 0;  // facets
};

Solid read_solid(Scanner& scanner, Soup& soup) {
  Solid solid;
  expect_words(scanner, {"solid"});
  solid.name = trimmed(scanner.line());
  solid.begin = soup.facets.size();
  for (;;) {
    scanner.skip_space();
    const std::size_t start = scanner.offset();
    const std::string_view word = scanner.text_token();
    if (equal_ignoring_case(word, "endsolid")) break;
    scanner.move_to(start);
    expect_words(scanner, {"facet"});
    read_text_facet(scanner, soup);
  }
  scanner.line();
  solid.end = soup.facets.size();
  return solid;
}

// Each named solid is a group; solids of the same name are one.
void add_solids(Mesh& mesh, const Soup& soup, const std::vector<Solid>& solids) {
  std::map<std::string_view, Tag> groups;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const Solid& solid = solids[i];
    const Tag number = static_cast<Tag>(i) + 1;
    ElementBlock& block = mesh.blocks.emplace_back();
    block.type = triangle_type;
    block.entity = number;
    add_facets(block, soup, solid.begin, solid.end);
    if (solid.name.empty()) continue;
    const auto [group, is_new] = groups.try_emplace(solid.name, number);
    block.physical_groups = {group->second};
    if (is_new) mesh.groups.push_back({2, number, solid.name});
  }
}

bool is_binary_stl(std::string_view bytes) {
  const std::size_t start = stl_header_bytes + sizeof(std::uint32_t);
  return bytes.size() >= start && bytes.size() == start + stl_facet_bytes * n_binary_facets(bytes);
}

bool is_text_stl(std::string_view bytes) {
  const std::string_view word = trimmed(bytes.substr(0, 1024)).substr(0, 5);
  return equal_ignoring_case(word, "solid");
}

Mesh read_binary_stl(FileBytes file) {
  const std::size_t n = n_binary_facets(file.view());
  if (n == 0)
    throw FormatError(fmt::format("{}: no triangles; save the mesh again", file.path.string()));
  if (3 * n > largest_index)
    throw InputError(
        fmt::format("{}: {} triangles are more than the {} that roughmesh handles; split the mesh",
                    file.path.string(), n, largest_index / 3));
  Soup soup = binary_soup(file, n);
  Mesh mesh;
  add_nodes(mesh, soup);
  mesh.blocks.resize(1);
  mesh.blocks[0].type = triangle_type;
  mesh.blocks[0].entity = 1;
  add_facets(mesh.blocks[0], soup, 0, n);
  attach_source(mesh, std::move(file), std::move(soup), NumberFormat::float32);
  return mesh;
}

Mesh read_text_stl(FileBytes file) {
  Scanner scanner(file);
  Soup soup;
  std::vector<Solid> solids;
  for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space())
    solids.push_back(read_solid(scanner, soup));
  if (soup.facets.empty()) scanner.fail("no triangles; save the mesh again");
  if (soup.corners.size() > largest_index)
    scanner.refuse("more triangles than roughmesh handles; split the mesh");
  Mesh mesh;
  add_nodes(mesh, soup);
  add_solids(mesh, soup, solids);
  attach_source(mesh, std::move(file), std::move(soup), NumberFormat::text);
  return mesh;
}

Mesh read_stl(FileBytes file) {
  return is_binary_stl(file.view()) ? read_binary_stl(std::move(file))
                                    : read_text_stl(std::move(file));
}

}  // namespace

const FileFormat stl_format = {
    .format = MeshFormat::stl,
    .extensions = {".stl"},
    .beginning = "begin with \"solid\" or have the size that its number of triangles asks for",
    .recognizes = [](std::string_view bytes,
                     std::string_view) { return is_binary_stl(bytes) || is_text_stl(bytes); },
    .read = read_stl,
    .write_patched = write_patched_stl,
    .check_new = check_stl,
    .write_new = write_new_stl,
    .holds = {.quadrangles = false,
              .full_precision = false,
              .least_dimension = 2,
              .most_dimension = 2},
    .text_holds = Holds{.groups = true,
                        .group_names = true,
                        .group_numbers = false,
                        .quadrangles = false,
                        .least_dimension = 2,
                        .most_dimension = 2},
    .encodings = {Encoding::binary, Encoding::text}};

}  // namespace roughmesh::detail
