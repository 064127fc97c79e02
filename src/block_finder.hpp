// SPDX-License-Identifier: BSD-3-Clause
// Sorts the elements of a file into blocks while they are read.
#pragma once

#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The block of each (type, entity, group), in order of first appearance. Files list long runs of
/// the same, so the last one found is tried first.
class BlockFinder {
 public:
  explicit BlockFinder(std::vector<ElementBlock>& blocks) : blocks_(&blocks) {}

  /// @param type   told apart by its address: one of a table that outlives the finder
  /// @param group  0 for none
  ElementBlock& find(const ElementType& type, Tag entity, Tag group);

 private:
  using Key = std::tuple<const ElementType*, Tag, Tag>;

  void add(const ElementType& type, Tag entity, Tag group);

  std::vector<ElementBlock>* blocks_;
  std::map<Key, std::size_t> places_;
  Key last_key_;
  std::size_t last_place_ = 0;
};

/// Fills Mesh::groups with the groups that blocks are in, without names.
void list_used_groups(Mesh& mesh);

}  // namespace roughmesh::detail
