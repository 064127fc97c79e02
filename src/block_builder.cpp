// SPDX-License-Identifier: BSD-3-Clause
#include "block_builder.hpp"

#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "file_formats.hpp"

namespace roughmesh::detail {

void BlockBuilder::set_groups(std::vector<Tag> groups) {
  if (groups == groups_) return;
  groups_ = std::move(groups);
  set_ = sets_.try_emplace(groups_, sets_.size()).first->second;
}

void BlockBuilder::set_group(Tag group) {
  const bool is_same = group == 0 ? groups_.empty() : groups_.size() == 1 && groups_[0] == group;
  if (!is_same) set_groups(group == 0 ? std::vector<Tag>() : std::vector<Tag>{group});
}

ElementBlock& BlockBuilder::find(const ElementType& type, Tag entity) {
  const Key key(type.shape, type.order, type.n_nodes, entity, set_);
  Found& last = last_[static_cast<std::size_t>(type.shape)];
  if (last.block >= blocks_->size() || key != last.key) {
    const auto [place, is_new] = places_.try_emplace(key, blocks_->size());
    if (is_new) blocks_->push_back({type, entity, groups_, {}, {}});
    last = {key, place->second};
  }
  return (*blocks_)[last.block];
}

void BlockBuilder::add(const ElementType& type, Tag number, std::span<const Index> nodes) {
  ElementBlock& block = find(type);
  block.tags.push_back(number);
  block.nodes.insert(block.nodes.end(), nodes.begin(), nodes.end());
}

std::vector<PhysicalGroup> used_groups(const std::vector<ElementBlock>& blocks,
                                       const std::map<Tag, std::string>& names) {
  std::set<std::pair<int, Tag>> used;
  for (const ElementBlock& block : blocks)
    for (const Tag group : block.physical_groups) used.insert({dimension(block.type.shape), group});
  std::vector<PhysicalGroup> groups;
  for (const auto& [dim, tag] : used) {
    const auto name = names.find(tag);
    groups.push_back({dim, tag, name == names.end() ? "" : name->second});
  }
  return groups;
}

void number_nodes(Mesh& mesh) {
  mesh.node_tags.resize(mesh.nodes.size());
  std::iota(mesh.node_tags.begin(), mesh.node_tags.end(), Tag{1});
}

void check_element_count(const Scanner& scanner, Tag n) {
  if (n == 0) scanner.fail("no elements; save the mesh after meshing");
  if (n > largest_index)
    scanner.refuse(
        fmt::format("{} elements are more than the {} that roughmesh handles; split the mesh", n,
                    largest_index));
}

}  // namespace roughmesh::detail
