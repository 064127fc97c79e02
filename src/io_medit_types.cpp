// SPDX-License-Identifier: BSD-3-Clause
// Keywords of Medit's sections of elements and the order of their nodes.
#include <algorithm>

#include "io_medit.hpp"
#include "node_orders.hpp"

namespace roughmesh::detail {

std::span<const MeditElements> medit_elements() {
  using enum ElementShape;
  const auto section = [](std::string_view keyword, int code, const NodeOrder& order) {
    return MeditElements{keyword, code, order.type, places_in_gmsh_order(order)};
  };
  static const std::vector<MeditElements> table = {
      section("Edges", 5, {.type = {line, 1, 2}}),
      section("Triangles", 6, {.type = {triangle, 1, 3}}),
      section("Quadrilaterals", 7, {.type = {quadrangle, 1, 4}}),
      section("Tetrahedra", 8, {.type = {tetrahedron, 1, 4}}),
      section("Prisms", 9, {.type = {prism, 1, 6}}),
      section("Hexahedra", 10, {.type = {hexahedron, 1, 8}}),
      section("Pyramids", 49, {.type = {pyramid, 1, 5}}),
      section("EdgesP2", 25, {.type = {line, 2, 3}, .nodes = "0 1 01"}),
      section("TrianglesP2", 24, {.type = {triangle, 2, 6}, .nodes = "0 1 2 01 12 20"}),
      section("QuadrilateralsQ2", 27,
              {.type = {quadrangle, 2, 9}, .nodes = "0 1 2 3 01 12 23 30 0123"}),
      section("TetrahedraP2", 30,
              {.type = {tetrahedron, 2, 10}, .nodes = "0 1 2 3 01 12 20 03 13 23"})};
  return table;
}

const MeditElements* medit_elements_of(const ElementType& type) {
  const auto table = medit_elements();
  const auto found = std::find_if(table.begin(), table.end(), [&](const MeditElements& elements) {
    return elements.type == type;
  });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace roughmesh::detail
