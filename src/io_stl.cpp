// SPDX-License-Identifier: BSD-3-Clause
// STL: loose triangles with a normal each. Corners at equal positions become one node.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "io_patch.hpp"
#include "scanner.hpp"
#include "text.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t header_bytes = 80;
constexpr std::size_t facet_bytes = 50;  // twelve float32 and two bytes of attributes
constexpr ElementType triangle{ElementShape::triangle, 1, 3};

// Triangles of a file before their corners are glued.
struct Soup {
  std::vector<Vec3> corners;  // three for each facet
  std::vector<StlFacet> facets;
};

bool comes_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// Numbers the distinct positions by first appearance. Comparison as numbers makes 0 and -0 equal,
// and sorting has no worst case that a file could be made for.
std::vector<Index> glue(const std::vector<Vec3>& corners) {
  std::vector<Index> order(corners.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    if (comes_before(corners[a], corners[b])) return true;
    return !comes_before(corners[b], corners[a]) && a < b;
  });
  std::vector<Index> first(corners.size());  // corner that stands for all at its position
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || corners[order[i]] != corners[order[i - 1]];
    first[order[i]] = is_new ? order[i] : first[order[i - 1]];
  }
  return first;
}

void add_nodes(Mesh& mesh, Soup& soup) {
  const std::vector<Index> first = glue(soup.corners);
  std::vector<Index> node_of_corner(first.size());
  for (std::size_t c = 0; c < first.size(); ++c) {
    const bool is_new = first[c] == static_cast<Index>(c);
    node_of_corner[c] = is_new ? mesh.n_nodes() : node_of_corner[first[c]];
    if (is_new) mesh.nodes.push_back(soup.corners[c]);
    soup.facets[c / 3].nodes[c % 3] = node_of_corner[c];
  }
  mesh.node_tags.resize(mesh.nodes.size());
  std::iota(mesh.node_tags.begin(), mesh.node_tags.end(), Tag{1});
}

void add_facets(ElementBlock& block, const Soup& soup, std::size_t begin, std::size_t end) {
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
  std::memcpy(&n, bytes.data() + header_bytes, sizeof n);
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
    facet.normal = header_bytes + sizeof(std::uint32_t) + facet_bytes * f;
    for (std::size_t k = 0; k < 3; ++k) {
      facet.vertices[k] = facet.normal + 3 * sizeof(float) * (k + 1);
      soup.corners.push_back(binary_corner(file, facet.vertices[k]));
    }
  }
  return soup;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
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
    block.type = triangle;
    block.entity = number;
    add_facets(block, soup, solid.begin, solid.end);
    if (solid.name.empty()) continue;
    const auto [group, is_new] = groups.try_emplace(solid.name, number);
    block.physical_groups = {group->second};
    if (is_new) mesh.groups.push_back({2, number, solid.name});
  }
}

// Zero for a triangle without area.
Vec3 normal_of_stored(const MeshSource& source, const std::array<Vec3, 3>& corners) {
  std::array<Vec3, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
    x[k] = corners[k].unaryExpr([&](double value) { return as_stored(source, value); });
  const Vec3 a = x[1] - x[0], b = x[2] - x[0];
  // Scaled first, so that neither tiny nor huge triangles leave the range of doubles.
  const double scale = std::max(a.lpNorm<Eigen::Infinity>(), b.lpNorm<Eigen::Infinity>());
  const Vec3 area = (a / scale).cross(b / scale);
  const double length = area.norm();
  if (!(length > 0 && std::isfinite(length))) return Vec3::Zero();
  return area / length + Vec3::Zero();  // no -0
}

bool is_binary_stl(std::string_view bytes) {
  const std::size_t start = header_bytes + sizeof(std::uint32_t);
  return bytes.size() >= start && bytes.size() == start + facet_bytes * n_binary_facets(bytes);
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
  mesh.blocks[0].type = triangle;
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

void write_patched_stl(const Mesh& mesh, OutputFile& output) {
  const MeshSource& source = *mesh.source;
  TriplePatcher patcher(source, output);
  for (const StlFacet& facet : source.facets) {
    std::array<Vec3, 3> corners;
    bool has_moved = false;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.nodes[facet.nodes[k]];
      has_moved |= !same_bits(corners[k], source.positions[facet.nodes[k]]);
    }
    if (!has_moved) continue;
    patcher.replace(facet.normal, normal_of_stored(source, corners));
    for (std::size_t k = 0; k < 3; ++k)
      patcher.replace(facet.vertices[k], source.positions[facet.nodes[k]], corners[k]);
  }
  patcher.finish();
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
    .write_patched = write_patched_stl};

}  // namespace roughmesh::detail
