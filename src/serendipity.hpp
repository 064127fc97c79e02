// SPDX-License-Identifier: BSD-3-Clause
// Orders in which formats list the nodes of an element of order 2 with nodes on its edges.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// How a format orders the nodes of a shape: "0 1 2 01 12 02" are the corners and then the middles
/// of the edges between the corners named, both from 0 in Gmsh's numbers of corners.
struct SecondOrderNodes {
  ElementShape shape;
  std::string_view places;
};

/// A type with nodes on corners and edges only, of order 1 or 2.
bool is_serendipity(const ElementType& type);
ElementType serendipity_type(ElementShape shape, int order);

/// Position in Gmsh's order of the node on the edge between two corners of an element of order 2.
int middle_node(ElementShape shape, int a, int b);

/// From one format's order to Gmsh's and back. Shapes that are not listed, and all of order 1, have
/// the same order in both.
class SerendipityOrder {
 public:
  explicit SerendipityOrder(std::span<const SecondOrderNodes> nodes);

  /// Where the file lists Gmsh's node k.
  std::span<const int> in_file(const ElementType& type) const;
  /// Where Gmsh lists node k of the file.
  std::span<const int> in_gmsh(const ElementType& type) const;

 private:
  std::array<std::vector<int>, 8> in_file_, in_gmsh_;  // of each shape, order 2
};

}  // namespace roughmesh::detail
