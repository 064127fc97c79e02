// SPDX-License-Identifier: BSD-3-Clause
// Finite element descriptors of universal files and the order of their nodes.
#include <algorithm>
#include <array>

#include "io_unv.hpp"

namespace roughmesh::detail {
namespace {

struct Descriptors {
  ElementShape shape;
  int order;
  int usual;  // of new elements: thin shells, solids, rods, tapered and parabolic beams
  std::array<int, 9> numbers;  // filled with 0
};

// Plane stress and strain, plates, membranes, axisymmetric solids, thin and thick shells.
constexpr std::array descriptors = {
    Descriptors{ElementShape::line, 1, 21, {11, 21, 22, 31, 171}},
    Descriptors{ElementShape::line, 2, 24, {23, 24, 32, 172}},
    Descriptors{ElementShape::triangle, 1, 91, {41, 51, 61, 74, 81, 91}},
    Descriptors{ElementShape::triangle, 2, 92, {42, 52, 62, 72, 82, 92}},
    Descriptors{ElementShape::quadrangle, 1, 94, {44, 54, 64, 71, 84, 94}},
    Descriptors{ElementShape::quadrangle, 2, 95, {45, 55, 65, 75, 85, 95}},
    Descriptors{ElementShape::tetrahedron, 1, 111, {111}},
    Descriptors{ElementShape::tetrahedron, 2, 118, {118}},
    Descriptors{ElementShape::prism, 1, 112, {112}},
    Descriptors{ElementShape::prism, 2, 113, {113}},
    Descriptors{ElementShape::hexahedron, 1, 115, {115}},
    Descriptors{ElementShape::hexahedron, 2, 116, {116}},
};

// Around each ring of edges, corners and middles in turn.
constexpr std::array second_order = {
    NodeOrder{{ElementShape::line, 2, 3}, "0 01 1"},
    NodeOrder{{ElementShape::triangle, 2, 6}, "0 01 1 12 2 02"},
    NodeOrder{{ElementShape::quadrangle, 2, 8}, "0 01 1 12 2 23 3 03"},
    NodeOrder{{ElementShape::tetrahedron, 2, 10}, "0 01 1 12 2 02 03 13 23 3"},
    NodeOrder{{ElementShape::prism, 2, 15}, "0 01 1 12 2 02 03 14 25 3 34 4 45 5 35"},
    NodeOrder{{ElementShape::hexahedron, 2, 20},
              "0 01 1 12 2 23 3 03 04 15 26 37 4 45 5 56 6 67 7 47"},
};

constexpr int first_ignored = 121;
constexpr int last_ignored = 161;
constexpr std::array beams = {11, 21, 22, 23, 24};

}  // namespace

UnvType unv_type(Tag descriptor) {
  if (descriptor >= first_ignored && descriptor <= last_ignored) return {true, true, false, {}};
  for (const Descriptors& each : descriptors)
    if (std::find(each.numbers.begin(), each.numbers.end(), descriptor) != each.numbers.end() &&
        descriptor > 0)
      return {true, false, std::find(beams.begin(), beams.end(), descriptor) != beams.end(),
              serendipity_type(each.shape, each.order)};
  return {};
}

int unv_descriptor(const ElementType& type, bool is_plane) {
  for (const Descriptors& each : descriptors)
    if (is_serendipity(type) && each.shape == type.shape && each.order == type.order)
      return is_plane && dimension(type.shape) == 2 ? each.numbers[0] : each.usual;
  return 0;
}

const NodeOrders& unv_node_orders() {
  static const NodeOrders orders(second_order);
  return orders;
}

}  // namespace roughmesh::detail
