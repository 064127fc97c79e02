// SPDX-License-Identifier: BSD-3-Clause
// What readers share while a file becomes a mesh: blocks of elements, groups and numbers.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "scanner.hpp"

namespace roughmesh::detail {

inline constexpr ElementType point_type{ElementShape::point, 1, 1};
inline constexpr ElementType line_type{ElementShape::line, 1, 2};
inline constexpr ElementType triangle_type{ElementShape::triangle, 1, 3};
inline constexpr ElementType quadrangle_type{ElementShape::quadrangle, 1, 4};

/// Sorts elements into one block for each (type, entity, set of groups), in order of first
/// appearance. Files list long runs of the same, so the last block of each shape is tried first.
class BlockBuilder {
 public:
  /// @param blocks  kept by reference
  explicit BlockBuilder(std::vector<ElementBlock>& blocks) : blocks_(&blocks) {}

  void set_groups(std::vector<Tag> groups);  ///< of the elements to come; ascending
  void set_group(Tag group);                 ///< likewise; 0 for none

  /// The block of the next element, for the caller to add its number and nodes.
  ElementBlock& find(const ElementType& type, Tag entity = 0);

  void add(const ElementType& type, Tag number, std::span<const Index> nodes);
  void add_face(Tag number, std::span<const Index> corners) {
    add(corners.size() == 4 ? quadrangle_type : triangle_type, number, corners);
  }

 private:
  using Key = std::tuple<ElementShape, int, int, Tag, std::size_t>;  // order, nodes, entity, set
  struct Found {
    Key key = {};
    std::size_t block = static_cast<std::size_t>(-1);
  };

  std::vector<ElementBlock>* blocks_;
  std::map<Key, std::size_t> places_;
  std::array<Found, 8> last_;  // of each shape
  std::map<std::vector<Tag>, std::size_t> sets_ = {{{}, 0}};
  std::vector<Tag> groups_;
  std::size_t set_ = 0;  // number of groups_ in sets_
};

/// The groups that blocks are in, by dimension and number, with the names of their numbers.
std::vector<PhysicalGroup> used_groups(const std::vector<ElementBlock>& blocks,
                                       const std::map<Tag, std::string>& names = {});

/// Numbers the nodes of a mesh 1, 2, 3, ...
void number_nodes(Mesh& mesh);

/// @throws FormatError  no elements  @throws InputError  more than an Index counts
void check_element_count(const Scanner& scanner, Tag n);

}  // namespace roughmesh::detail
