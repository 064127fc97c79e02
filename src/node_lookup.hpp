// SPDX-License-Identifier: BSD-3-Clause
// From the number a file gives to a node to its place in Mesh::nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A table where the numbers are dense, else a sorted list: files may number nodes up to 2^63 - 1,
/// and no choice of numbers makes a lookup slower than a binary search.
class NodeLookup {
 public:
  NodeLookup() = default;
  explicit NodeLookup(std::span<const Tag> tags);

  /// Position in Mesh::nodes; -1 where no node has the number.
  Index find(Tag tag) const {
    if (!sorted_.empty()) return find_sorted(tag);
    const auto slot = static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(first_);
    return slot < dense_.size() ? dense_[slot] : Index{-1};
  }

  /// The later of two nodes with the same number, if there are such.
  std::optional<Index> duplicate() const { return duplicate_; }

 private:
  void fill_dense(std::span<const Tag> tags, std::size_t n_slots);
  void fill_sorted(std::span<const Tag> tags);
  Index find_sorted(Tag tag) const;

  Tag first_ = 0;
  std::vector<Index> dense_;
  std::vector<std::pair<Tag, Index>> sorted_;
  std::optional<Index> duplicate_;
};

}  // namespace roughmesh::detail
