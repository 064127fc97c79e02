// SPDX-License-Identifier: BSD-3-Clause
#include "block_finder.hpp"

#include <set>
#include <utility>

namespace roughmesh::detail {

ElementBlock& BlockFinder::find(const ElementType& type, Tag entity, Tag group) {
  const Key key(&type, entity, group);
  if (blocks_->empty() || key != last_key_) {
    const auto [place, is_new] = places_.try_emplace(key, blocks_->size());
    if (is_new) add(type, entity, group);
    last_key_ = key;
    last_place_ = place->second;
  }
  return (*blocks_)[last_place_];
}

void BlockFinder::add(const ElementType& type, Tag entity, Tag group) {
  ElementBlock& block = blocks_->emplace_back();
  block.type = type;
  block.entity = entity;
  if (group != 0) block.physical_groups = {group};
}

void list_used_groups(Mesh& mesh) {
  std::set<std::pair<int, Tag>> used;
  for (const ElementBlock& block : mesh.blocks)
    for (const Tag group : block.physical_groups) used.insert({dimension(block.type.shape), group});
  for (const auto& [dim, tag] : used) mesh.groups.push_back({dim, tag, ""});
}

}  // namespace roughmesh::detail
