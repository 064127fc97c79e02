// SPDX-License-Identifier: BSD-3-Clause
#include "element_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "block_builder.hpp"
#include "file_formats.hpp"
#include "node_lookup.hpp"

namespace roughmesh::detail {
namespace {

NodeLookup look_up_nodes(const Mesh& mesh, const std::vector<std::uint64_t>& offsets,
                         const Scanner& scanner) {
  NodeLookup lookup(mesh.node_tags);
  if (const auto duplicate = lookup.duplicate()) {
    const auto i = static_cast<std::size_t>(*duplicate);
    scanner.fail_at(offsets[i], fmt::format("two nodes have the number {}; renumber the mesh",
                                            mesh.node_tags[i]));
  }
  return lookup;
}

}  // namespace

Index ElementTable::add(Row row, std::span<const Tag> nodes) {
  row.first = nodes_.size();
  nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
  rows_.push_back(row);
  return static_cast<Index>(rows_.size()) - 1;
}

std::span<const Tag> ElementTable::nodes(Index element) const {
  const Row& r = row(element);
  return {nodes_.data() + r.first, static_cast<std::size_t>(r.type.n_nodes)};
}

void ElementTable::check_numbers(const Scanner& scanner) const {
  if (rows_.size() > static_cast<std::size_t>(largest_index))
    scanner.refuse("more elements than roughmesh handles; split the mesh");
  std::vector<Tag> numbers(rows_.size());
  std::transform(rows_.begin(), rows_.end(), numbers.begin(),
                 [](const Row& r) { return r.number; });
  if (const auto duplicate = NodeLookup(numbers).duplicate())
    scanner.fail_at(
        row(*duplicate).offset,
        fmt::format("two elements have the number {}; renumber the mesh", row(*duplicate).number));
}

void ElementTable::fill(Mesh& mesh, const std::vector<std::uint64_t>& node_offsets,
                        const std::map<Tag, std::string>& names, const Scanner& scanner) {
  const NodeLookup lookup = look_up_nodes(mesh, node_offsets, scanner);
  check_numbers(scanner);
  std::sort(members_.begin(), members_.end());
  members_.erase(std::unique(members_.begin(), members_.end()), members_.end());
  BlockBuilder blocks(mesh.blocks);
  auto member = members_.begin();
  for (Index e = 0; e < static_cast<Index>(rows_.size()); ++e) {
    std::vector<Tag> groups;
    for (; member != members_.end() && member->first == e; ++member)
      groups.push_back(member->second);
    blocks.set_groups(std::move(groups));
    ElementBlock& block = blocks.find(row(e).type, row(e).entity);
    block.tags.push_back(row(e).number);
    for (const Tag tag : nodes(e)) {
      const Index node = lookup.find(tag);
      if (node < 0)
        scanner.fail_at(row(e).offset,
                        fmt::format("element {} names node {}, which does not exist; save the "
                                    "mesh with all its nodes",
                                    row(e).number, tag));
      block.nodes.push_back(node);
    }
  }
  mesh.groups = used_groups(mesh.blocks, names);
}

}  // namespace roughmesh::detail
