// SPDX-License-Identifier: BSD-3-Clause
// How formats order the nodes of an element, told by where the nodes lie.
#pragma once

#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// A format's own order of the nodes of elements of order 1 or 2.
struct NodeOrder {
  ElementType type;
  /// Gmsh's number of each corner, one digit each; empty where both number corners alike.
  std::string_view corners = {};
  /// For each further node, the corners (numbers of the format) of the edge, face or cell in whose
  /// middle it lies, for example "01 12 20".
  std::string_view middles = {};
};

/// For each node in the order of the format its place in Gmsh's order.
std::vector<int> places_in_gmsh_order(const NodeOrder& order);

}  // namespace roughmesh::detail
