// SPDX-License-Identifier: BSD-3-Clause
// How formats order the nodes of an element of order 1 or 2, told by where the nodes lie.
#pragma once

#include <map>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A format's order of the nodes of a type: each by the corners in whose middle it lies, so that
/// "0 1 2 01 12 02" are three corners and then the middles of three edges. Corners have Gmsh's
/// numbers, from 0. Empty where the format has Gmsh's order.
struct NodeOrder {
  ElementType type;
  std::string_view nodes = {};
};

/// For each node in the order of the format its place in Gmsh's order.
std::vector<int> places_in_gmsh_order(const NodeOrder& order);

/// The orders of one format, from it to Gmsh's and back. Types that are not listed have the same
/// order in both; of those it holds no more than 27 nodes.
class NodeOrders {
 public:
  explicit NodeOrders(std::span<const NodeOrder> orders);

  /// Where the file lists Gmsh's node k.
  std::span<const int> in_file(const ElementType& type) const { return find(in_file_, type); }
  /// Where Gmsh lists node k of the file.
  std::span<const int> in_gmsh(const ElementType& type) const { return find(in_gmsh_, type); }

 private:
  using Places = std::map<std::tuple<ElementShape, int, int>, std::vector<int>>;

  static std::span<const int> find(const Places& places, const ElementType& type);

  Places in_file_, in_gmsh_;
};

/// A type with nodes on corners and edges only, of order 1 or 2.
bool is_serendipity(const ElementType& type);
ElementType serendipity_type(ElementShape shape, int order);

/// Position in Gmsh's order of the node on the edge between two corners of an element of order 2.
int middle_node(ElementShape shape, int a, int b);

}  // namespace roughmesh::detail
