// SPDX-License-Identifier: BSD-3-Clause
// MSH 2.2: nodes, elements and periodic links.
#include <fmt/format.h>

#include "block_builder.hpp"
#include "file_formats.hpp"
#include "io_msh.hpp"

namespace roughmesh::detail {
namespace {

// Counts are text in binary files too, each on a line of its own.
Tag read_count_line(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  const Tag n = scanner.text_integer();
  if (!reader.is_text() && scanner.line().find_first_not_of(" \t") != std::string_view::npos)
    scanner.fail("something stands behind the count on its line: the file is damaged");
  return n;
}

Tag checked_tag(const Scanner& scanner, Tag tag) {
  if (tag < 0) [[unlikely]]
    scanner.fail(fmt::format("the number {} is negative; renumber the mesh", tag));
  return tag;
}

// The first tag is the physical group, the second the entity; what follows are partitions.
ElementBlock& find_block(MshReader& reader, BlockBuilder& blocks, const ElementType& type,
                         Tag n_tags) {
  Scanner& scanner = reader.scanner;
  const Tag group = n_tags > 0 ? reader.group(scanner.integer()) : 0;
  const Tag entity = n_tags > 1 ? scanner.integer() : 0;
  for (Tag i = 2; i < n_tags; ++i) scanner.integer();
  blocks.set_group(group);
  return blocks.find(type, entity);
}

void read_element(MshReader& reader, BlockBuilder& blocks, const ElementType& type, Tag number,
                  Tag n_tags) {
  ElementBlock& block = find_block(reader, blocks, type, n_tags);
  block.tags.push_back(checked_tag(reader.scanner, number));
  for (int i = 0; i < type.n_nodes; ++i)
    block.nodes.push_back(reader.node(reader.scanner.integer()));
}

// In text each element states its type; in binary a run of elements shares it.
Tag read_run(MshReader& reader, BlockBuilder& blocks, Tag n_left) {
  Scanner& scanner = reader.scanner;
  const bool is_text = reader.is_text();
  Tag number = is_text ? scanner.integer() : 0;
  const ElementType& type = reader.element_type(scanner.integer());
  const Tag n = is_text ? 1 : scanner.integer();
  if (n < 1 || n > n_left)
    scanner.fail(
        fmt::format("{} elements in a run where {} remain: the file is damaged", n, n_left));
  const Tag n_tags = scanner.integer();
  scanner.count(n_tags, reader.least(sizeof(std::int32_t)), "tags");
  for (Tag i = 0; i < n; ++i) {
    if (!is_text) number = scanner.integer();
    read_element(reader, blocks, type, number, n_tags);
  }
  return n;
}

PeriodicLink read_link(MshReader& reader) {
  Scanner& scanner = reader.scanner;
  PeriodicLink link;
  const Tag dim = scanner.text_integer();
  if (dim < 0 || dim > 3) scanner.fail(fmt::format("dimension {} is not 0 to 3", dim));
  link.dimension = static_cast<int>(dim);
  link.entity = scanner.text_integer();
  link.master_entity = scanner.text_integer();
  scanner.skip_space();
  if (scanner.peek() == 'A') {
    if (scanner.text_token() != "Affine") scanner.fail("expected Affine or a number of nodes");
    for (int i = 0; i < 16; ++i) link.affine.push_back(scanner.text_real());
  }
  const std::size_t n = scanner.count(scanner.text_integer(), 4, "pairs of nodes");
  for (std::size_t i = 0; i < n; ++i) {
    const Tag slave = scanner.text_integer();
    reader.add_periodic_pair(link, slave, scanner.text_integer());
  }
  return link;
}

}  // namespace

void read_msh2_nodes(MshReader& reader) {
  const std::size_t text_bytes = 8;     // "1 0 0 0\n"
  const std::size_t binary_bytes = 28;  // an int and three doubles
  const Tag n = read_count_line(reader);
  reader.start_nodes(n, reader.is_text() ? text_bytes : binary_bytes);
  for (Tag i = 0; i < n; ++i) {
    reader.mesh.node_tags.push_back(checked_tag(reader.scanner, reader.scanner.integer()));
    reader.add_position();
  }
  reader.finish_nodes();
}

void read_msh2_elements(MshReader& reader) {
  reader.start_elements();
  const Tag n = read_count_line(reader);
  reader.check_element_count(n);
  reader.scanner.count(n, 8, "elements");  // "1 15 0 1\n", or a number and a node in binary
  BlockBuilder blocks(reader.mesh.blocks);
  for (Tag n_left = n; n_left > 0;) n_left -= read_run(reader, blocks, n_left);
  merge_copies_in_groups(reader.mesh.blocks);
}

void read_msh2_periodic(MshReader& reader) {
  if (!reader.has_nodes) reader.scanner.fail("stands before $Nodes; put it behind");
  const std::size_t n = reader.scanner.count(reader.scanner.text_integer(), 8, "links");
  for (std::size_t i = 0; i < n; ++i) reader.mesh.periodic_links.push_back(read_link(reader));
}

}  // namespace roughmesh::detail
