// SPDX-License-Identifier: BSD-3-Clause
// MSH 4.1: entities, nodes, elements and periodic links. Text and binary differ in nothing but how
// a number is written.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "io_msh.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t int_bytes = sizeof(std::int32_t);
constexpr std::size_t long_bytes = sizeof(std::uint64_t);

int read_dimension(Scanner& scanner) {
  const Tag dim = scanner.integer();
  if (dim < 0 || dim > 3) scanner.fail(fmt::format("dimension {} is not 0 to 3", dim));
  return static_cast<int>(dim);
}

void skip_numbers(Scanner& scanner, std::size_t n, std::size_t bytes_each) {
  for (std::size_t i = 0; i < n; ++i) scanner.skip_number(bytes_each);
}

void skip_list(MshReader& reader, std::string_view things) {
  Scanner& scanner = reader.scanner;
  const std::size_t n = scanner.count(scanner.size(), reader.least(int_bytes), things);
  skip_numbers(scanner, n, int_bytes);
}

// A negative number stands for a reversed orientation of the entity in its group.
std::vector<Tag> read_groups(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  const std::size_t n = scanner.count(scanner.size(), reader.least(int_bytes), "physical groups");
  std::vector<Tag> groups;
  for (std::size_t i = 0; i < n; ++i)
    if (const Tag group = reader.group(scanner.integer()); group != 0) groups.push_back(group);
  std::sort(groups.begin(), groups.end());
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  return groups;
}

// Elements between partitions lie on an entity of their own, cut from one of higher dimension: then
// there is no elementary entity of their dimension. Gmsh lists the groups of the latter there,
// whose numbers are those of other groups in the dimension of the cut; they are not taken.
Tag read_partition(MshReader& reader, int dim) {
  Scanner& scanner = reader.scanner;
  const Tag parent_dimension = scanner.integer();
  const Tag parent = scanner.integer();
  skip_list(reader, "partitions");
  return parent_dimension == dim ? parent : 0;
}

void read_entity(MshReader& reader, int dim, bool is_partitioned) {
  Scanner& scanner = reader.scanner;
  const Tag tag = scanner.integer();
  MshEntity entity;
  entity.elementary = is_partitioned ? read_partition(reader, dim) : tag;
  skip_numbers(scanner, dim == 0 ? 3 : 6,
               sizeof(double));  // point or box, which need not be finite
  entity.groups = read_groups(reader);
  if (entity.elementary == 0) entity.groups.clear();
  if (dim > 0) skip_list(reader, "bounding entities");
  reader.entities[{dim, tag}] = std::move(entity);
}

void read_entity_lists(MshReader& reader, bool is_partitioned) {
  Scanner& scanner = reader.scanner;
  std::array<std::size_t, 4> n{};
  for (std::size_t& n_of_dimension : n)
    n_of_dimension = scanner.count(scanner.size(), 5 * reader.least(int_bytes), "entities");
  for (int dim = 0; dim < 4; ++dim)
    for (std::size_t i = 0; i < n[static_cast<std::size_t>(dim)]; ++i)
      read_entity(reader, dim, is_partitioned);
}

void read_node_block(MshReader& reader, std::size_t n_left) {
  Scanner& scanner = reader.scanner;
  const int dim = read_dimension(scanner);
  scanner.integer();  // the entity
  const Tag is_parametric = scanner.integer();
  if (is_parametric != 0 && is_parametric != 1)
    scanner.fail(
        fmt::format("parametric is {}, neither 0 nor 1: the file is damaged", is_parametric));
  const auto n = static_cast<std::size_t>(scanner.size());
  if (n > n_left)
    scanner.fail(fmt::format("{} nodes in a block where {} remain: a count is wrong", n, n_left));
  for (std::size_t i = 0; i < n; ++i) reader.mesh.node_tags.push_back(scanner.size());
  const std::size_t n_parameters = is_parametric == 1 ? static_cast<std::size_t>(dim) : 0;
  for (std::size_t i = 0; i < n; ++i) {
    reader.add_position();
    skip_numbers(scanner, n_parameters, sizeof(double));
  }
}

void check_block(const MshReader& reader, int dim, const ElementType& type, std::size_t n,
                 std::size_t n_left) {
  if (dim != dimension(type.shape))
    reader.scanner.fail(
        fmt::format("a {} in an entity of dimension {}: the file is damaged", name(type), dim));
  if (n > n_left)
    reader.scanner.fail(
        fmt::format("{} elements in a block where {} remain: a count is wrong", n, n_left));
}

std::size_t read_element_block(MshReader& reader, std::size_t n_left) {
  Scanner& scanner = reader.scanner;
  ElementBlock block;
  const int dim = read_dimension(scanner);
  block.entity = scanner.integer();
  block.type = reader.element_type(scanner.integer());
  const auto n_nodes = static_cast<std::size_t>(block.type.n_nodes);
  const std::size_t n =
      scanner.count(scanner.size(), (1 + n_nodes) * reader.least(long_bytes), "elements");
  check_block(reader, dim, block.type, n, n_left);
  block.tags.reserve(n);
  block.nodes.reserve(n * n_nodes);
  for (std::size_t i = 0; i < n; ++i) {
    block.tags.push_back(scanner.size());
    for (std::size_t k = 0; k < n_nodes; ++k) block.nodes.push_back(reader.node(scanner.size()));
  }
  if (n > 0) reader.mesh.blocks.push_back(std::move(block));
  return n;
}

PeriodicLink read_link(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  PeriodicLink link;
  link.dimension = read_dimension(scanner);
  link.entity = scanner.integer();
  link.master_entity = scanner.integer();
  const Tag n_affine = scanner.size();
  if (n_affine != 0 && n_affine != 16)
    scanner.fail(fmt::format("{} numbers of an affine map, neither 0 nor 16", n_affine));
  for (Tag i = 0; i < n_affine; ++i) link.affine.push_back(scanner.real());
  const std::size_t n =
      scanner.count(scanner.size(), 2 * reader.least(long_bytes), "pairs of nodes");
  for (std::size_t i = 0; i < n; ++i) {
    const Tag slave = scanner.size();
    reader.add_periodic_pair(link, slave, scanner.size());
  }
  return link;
}

// Smallest and largest number: Gmsh itself writes 2^64 - 1 for the smallest of none.
void skip_tag_range(Scanner& scanner) { skip_numbers(scanner, 2, long_bytes); }

}  // namespace

void read_msh4_entities(MshReader& reader) { read_entity_lists(reader, false); }

void read_msh4_partitioned_entities(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  scanner.size();  // number of partitions
  const std::size_t n_ghosts =
      scanner.count(scanner.size(), 2 * reader.least(int_bytes), "ghost entities");
  skip_numbers(scanner, 2 * n_ghosts, int_bytes);
  read_entity_lists(reader, true);
}

void read_msh4_nodes(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  const std::size_t n_blocks = scanner.count(scanner.size(), 4 * reader.least(int_bytes), "blocks");
  const auto n = scanner.size();
  reader.start_nodes(n, 4 * reader.least(long_bytes));
  skip_tag_range(scanner);
  for (std::size_t i = 0; i < n_blocks; ++i)
    read_node_block(reader, static_cast<std::size_t>(n) - reader.mesh.nodes.size());
  if (reader.mesh.n_nodes() != n)
    scanner.fail(fmt::format("the blocks hold {} nodes where {} are announced: a count is wrong",
                             reader.mesh.n_nodes(), n));
  reader.finish_nodes();
}

void read_msh4_elements(MshReader& reader) {
  reader.start_elements();
  Scanner& scanner = reader.scanner;
  const std::size_t n_blocks = scanner.count(scanner.size(), 4 * reader.least(int_bytes), "blocks");
  const Tag n = scanner.size();
  reader.check_element_count(n);
  std::size_t n_left = scanner.count(n, 2 * reader.least(long_bytes), "elements");
  skip_tag_range(scanner);
  for (std::size_t i = 0; i < n_blocks; ++i) n_left -= read_element_block(reader, n_left);
  if (n_left != 0)
    scanner.fail(
        fmt::format("the blocks hold {} elements fewer than announced: a count is wrong", n_left));
}

void read_msh4_periodic(MshReader& reader) {
  if (!reader.has_nodes) reader.scanner.fail("stands before $Nodes; put it behind");
  Scanner& scanner = reader.scanner;
  const std::size_t n = scanner.count(scanner.size(), 5 * reader.least(int_bytes), "links");
  for (std::size_t i = 0; i < n; ++i) reader.mesh.periodic_links.push_back(read_link(reader));
}

}  // namespace roughmesh::detail
