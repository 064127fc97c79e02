// SPDX-License-Identifier: BSD-3-Clause
// Names of Abaqus element types and the order of their nodes.
#include <algorithm>
#include <array>
#include <charconv>

#include "io_abaqus.hpp"

namespace roughmesh::detail {
namespace {

// What the number behind the prefix of a name says.
enum class Count : std::uint8_t { nodes, beam, generatrix };

struct Family {
  std::string_view prefix;
  AbaqusRole role;
  Count count = Count::nodes;
};

constexpr std::array families = {
    Family{"C3D", AbaqusRole::solid},
    Family{"DC3D", AbaqusRole::solid},
    Family{"DCC3D", AbaqusRole::solid},
    Family{"AC3D", AbaqusRole::solid},
    Family{"Q3D", AbaqusRole::solid},
    Family{"SC", AbaqusRole::solid},
    Family{"CPS", AbaqusRole::plane},
    Family{"CPE", AbaqusRole::plane},
    Family{"CPEG", AbaqusRole::plane},
    Family{"CAX", AbaqusRole::plane},
    Family{"CGAX", AbaqusRole::plane},
    Family{"DC2D", AbaqusRole::plane},
    Family{"DCC2D", AbaqusRole::plane},
    Family{"AC2D", AbaqusRole::plane},
    Family{"DCAX", AbaqusRole::plane},
    Family{"DCCAX", AbaqusRole::plane},
    Family{"ACAX", AbaqusRole::plane},
    Family{"S", AbaqusRole::sheet},
    Family{"DS", AbaqusRole::sheet},
    Family{"STRI", AbaqusRole::sheet},
    Family{"M3D", AbaqusRole::sheet},
    Family{"SFM3D", AbaqusRole::sheet},
    Family{"R3D", AbaqusRole::sheet},
    Family{"T2D", AbaqusRole::line},
    Family{"T3D", AbaqusRole::line},
    Family{"DC1D", AbaqusRole::line},
    Family{"R2D", AbaqusRole::line},
    Family{"RAX", AbaqusRole::line},
    Family{"B2", AbaqusRole::line, Count::beam},
    Family{"B3", AbaqusRole::line, Count::beam},
    Family{"PIPE2", AbaqusRole::line, Count::beam},
    Family{"PIPE3", AbaqusRole::line, Count::beam},
    Family{"SAX", AbaqusRole::line, Count::generatrix},
    Family{"DSAX", AbaqusRole::line, Count::generatrix},
    Family{"MAX", AbaqusRole::line, Count::generatrix},
};

constexpr std::array<std::string_view, 19> ignored = {
    "MASS", "ROTARYI", "SPRING", "DASHPOT",      "CONN",    "GAP", "JOINT",
    "ITS",  "ITT",     "COH",    "DCOUP",        "HEATCAP", "ISL", "IRS",
    "GK",   "DRAG3",   "SPHERE", "DISTRIBUTING", "PSI"};

constexpr std::array second_order = {
    NodeOrder{{ElementShape::line, 2, 3}, "0 01 1"},
    NodeOrder{{ElementShape::tetrahedron, 2, 10}, "0 1 2 3 01 12 02 03 13 23"},
    NodeOrder{{ElementShape::hexahedron, 2, 20},
              "0 1 2 3 4 5 6 7 01 12 23 03 45 56 67 47 04 15 26 37"},
    NodeOrder{{ElementShape::prism, 2, 15}, "0 1 2 3 4 5 01 12 02 34 45 35 03 14 25"},
    NodeOrder{{ElementShape::pyramid, 2, 13}, "0 1 2 3 4 01 12 23 03 04 14 24 34"},
};

int n_nodes(const Family& family, int number) {
  switch (family.count) {
    case Count::nodes:
      return number == 65 ? 6 : number;  // STRI65: six nodes, five degrees of freedom
    case Count::beam:
      return number == 2 ? 3 : 2;
    case Count::generatrix:
      return number + 1;
  }
  return 0;
}

std::optional<ElementType> type_of(AbaqusRole role, int n) {
  constexpr std::array solids = {ElementShape::tetrahedron, ElementShape::hexahedron,
                                 ElementShape::prism, ElementShape::pyramid};
  constexpr std::array faces = {ElementShape::triangle, ElementShape::quadrangle};
  constexpr std::array lines = {ElementShape::line};
  const auto find = [n](const auto& shapes) -> std::optional<ElementType> {
    for (const ElementShape shape : shapes)
      for (const int order : {1, 2})
        if (serendipity_type(shape, order).n_nodes == n) return serendipity_type(shape, order);
    return {};
  };
  if (role == AbaqusRole::solid) return find(solids);
  return role == AbaqusRole::line ? find(lines) : find(faces);
}

std::optional<AbaqusType> type_in(const Family& family, std::string_view name) {
  if (!name.starts_with(family.prefix)) return {};
  const char* const digits = name.data() + family.prefix.size();
  int number = 0;
  if (std::from_chars(digits, name.data() + name.size(), number).ec != std::errc() || number < 1)
    return {};
  const auto type = type_of(family.role, n_nodes(family, number));
  if (!type) return {};
  return AbaqusType{family.role, *type};
}

}  // namespace

std::optional<AbaqusType> abaqus_type(std::string_view name) {
  for (const Family& family : families)
    if (const auto type = type_in(family, name)) return type;
  if (name.starts_with("FRAME"))
    return AbaqusType{AbaqusRole::line, serendipity_type(ElementShape::line, 1)};
  if (std::any_of(ignored.begin(), ignored.end(),
                  [&](std::string_view prefix) { return name.starts_with(prefix); }))
    return AbaqusType{};
  return {};
}

const NodeOrders& abaqus_node_orders() {
  static const NodeOrders orders(second_order);
  return orders;
}

}  // namespace roughmesh::detail
