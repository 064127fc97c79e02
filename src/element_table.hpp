// SPDX-License-Identifier: BSD-3-Clause
// Elements of files that list nodes, elements and sets of elements in any order.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "scanner.hpp"

namespace roughmesh::detail {

/// Elements as they are listed, by the numbers of their nodes, until all nodes and sets are known.
class ElementTable {
 public:
  struct Row {
    ElementType type;
    Tag entity = 0;
    Tag number = 0;
    std::uint64_t offset = 0;  ///< where it stands in the file, for messages
    std::size_t first = 0;     ///< of its nodes
  };

  /// @param nodes  numbers of the file, in Gmsh's order
  Index add(Row row, std::span<const Tag> nodes);
  void add_to_group(Index element, Tag group) { members_.emplace_back(element, group); }

  std::size_t size() const { return rows_.size(); }
  const Row& row(Index element) const { return rows_[static_cast<std::size_t>(element)]; }
  std::span<const Tag> nodes(Index element) const;

  /// Makes the blocks and groups of a mesh whose nodes are complete: one block for each type,
  /// entity and set of groups, in order of first appearance. A group holds elements of one
  /// dimension, so a set of several is one group for each, with the same number and name.
  /// @throws FormatError  a node that does not exist, two elements or nodes with one number
  void fill(Mesh& mesh, const std::vector<std::uint64_t>& node_offsets,
            const std::map<Tag, std::string>& names, const Scanner& scanner);

 private:
  void check_numbers(const Scanner& scanner) const;

  std::vector<Row> rows_;
  std::vector<Tag> nodes_;
  std::vector<std::pair<Index, Tag>> members_;  // (element, group)
};

}  // namespace roughmesh::detail
