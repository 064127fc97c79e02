// SPDX-License-Identifier: BSD-3-Clause
#include "gmsh_element_types.hpp"

#include <array>

namespace roughmesh::detail {
namespace {

constexpr int n_numbers = 138;
using Table = std::array<ElementType, n_numbers>;  // indexed by number; n_nodes is 0 where none is

// Nodes of complete elements of order p, and of those with nodes on their edges only.
constexpr int complete_nodes(ElementShape shape, int p) {
  switch (shape) {
    case ElementShape::point:
      return 1;
    case ElementShape::line:
      return p + 1;
    case ElementShape::triangle:
      return (p + 1) * (p + 2) / 2;
    case ElementShape::quadrangle:
      return (p + 1) * (p + 1);
    case ElementShape::tetrahedron:
      return (p + 1) * (p + 2) * (p + 3) / 6;
    case ElementShape::hexahedron:
      return (p + 1) * (p + 1) * (p + 1);
    case ElementShape::prism:
      return (p + 1) * (p + 1) * (p + 2) / 2;
    case ElementShape::pyramid:
      return (p + 1) * (p + 2) * (2 * p + 3) / 6;
  }
  return 0;
}

struct Edges {
  int n_corners;
  int n_edges;
};

constexpr Edges edges(ElementShape shape) {
  switch (shape) {
    case ElementShape::triangle:
      return {3, 3};
    case ElementShape::quadrangle:
      return {4, 4};
    case ElementShape::tetrahedron:
      return {4, 6};
    case ElementShape::hexahedron:
      return {8, 12};
    case ElementShape::prism:
      return {6, 9};
    case ElementShape::pyramid:
      return {5, 8};
    default:
      return {0, 0};
  }
}

constexpr int edge_nodes(ElementShape shape, int p) {
  return edges(shape).n_corners + (p - 1) * edges(shape).n_edges;
}

struct Run {
  int first_number;
  ElementShape shape;
  int first_order;
  int last_order;
  bool on_edges_only = false;
};

// Consecutive numbers that are consecutive orders of one shape, from the list "Element types" of
// Gmsh's manual and its header GmshDefines.h.
constexpr std::array runs = {
    Run{1, ElementShape::line, 1, 1},
    Run{2, ElementShape::triangle, 1, 1},
    Run{3, ElementShape::quadrangle, 1, 1},
    Run{4, ElementShape::tetrahedron, 1, 1},
    Run{5, ElementShape::hexahedron, 1, 1},
    Run{6, ElementShape::prism, 1, 1},
    Run{7, ElementShape::pyramid, 1, 1},
    Run{8, ElementShape::line, 2, 2},
    Run{9, ElementShape::triangle, 2, 2},
    Run{10, ElementShape::quadrangle, 2, 2},
    Run{11, ElementShape::tetrahedron, 2, 2},
    Run{12, ElementShape::hexahedron, 2, 2},
    Run{13, ElementShape::prism, 2, 2},
    Run{14, ElementShape::pyramid, 2, 2},
    Run{15, ElementShape::point, 1, 1},
    Run{16, ElementShape::quadrangle, 2, 2, true},
    Run{17, ElementShape::hexahedron, 2, 2, true},
    Run{18, ElementShape::prism, 2, 2, true},
    Run{19, ElementShape::pyramid, 2, 2, true},
    Run{20, ElementShape::triangle, 3, 3, true},
    Run{21, ElementShape::triangle, 3, 3},
    Run{22, ElementShape::triangle, 4, 4, true},
    Run{23, ElementShape::triangle, 4, 4},
    Run{24, ElementShape::triangle, 5, 5, true},
    Run{25, ElementShape::triangle, 5, 5},
    Run{26, ElementShape::line, 3, 5},
    Run{29, ElementShape::tetrahedron, 3, 5},
    Run{32, ElementShape::tetrahedron, 4, 5, true},
    Run{36, ElementShape::quadrangle, 3, 5},
    Run{39, ElementShape::quadrangle, 3, 5, true},
    Run{42, ElementShape::triangle, 6, 10},
    Run{47, ElementShape::quadrangle, 6, 10},
    Run{52, ElementShape::triangle, 6, 10, true},
    Run{57, ElementShape::quadrangle, 6, 10, true},
    Run{62, ElementShape::line, 6, 10},
    Run{71, ElementShape::tetrahedron, 6, 10},
    Run{79, ElementShape::tetrahedron, 6, 10, true},
    Run{90, ElementShape::prism, 3, 4},
    Run{92, ElementShape::hexahedron, 3, 9},
    Run{99, ElementShape::hexahedron, 3, 9, true},
    Run{106, ElementShape::prism, 5, 9},
    Run{111, ElementShape::prism, 3, 9, true},
    Run{118, ElementShape::pyramid, 3, 9},
    Run{125, ElementShape::pyramid, 3, 9, true},
    Run{137, ElementShape::tetrahedron, 3, 3, true},
};

constexpr Table make_table() {
  Table table{};
  for (ElementType& type : table) type.n_nodes = 0;
  for (const Run& run : runs)
    for (int p = run.first_order; p <= run.last_order; ++p)
      table[static_cast<std::size_t>(run.first_number + p - run.first_order)] = {
          run.shape, p,
          run.on_edges_only ? edge_nodes(run.shape, p) : complete_nodes(run.shape, p)};
  return table;
}

constexpr Table table = make_table();

}  // namespace

const ElementType* element_type_from_gmsh(Tag number) {
  if (number < 1 || number >= n_numbers) return nullptr;
  const ElementType& type = table[static_cast<std::size_t>(number)];
  return type.n_nodes > 0 ? &type : nullptr;
}

int gmsh_number(const ElementType& type) {
  for (int number = 1; number < n_numbers; ++number)
    if (table[static_cast<std::size_t>(number)] == type) return number;
  return 0;
}

}  // namespace roughmesh::detail
