// SPDX-License-Identifier: BSD-3-Clause
#include "vtk_cells.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "node_orders.hpp"

namespace roughmesh::detail {
namespace {

struct NumberedOrder {
  int number;
  NodeOrder order;
};

// The first triangle of a wedge of order 1 faces outward, that of Gmsh's prism inward. For wedges
// of order 2 VTK's parametric coordinates and the programs that write them have it inward as Gmsh
// does. Pixels and voxels number their corners along the axes.
std::vector<VtkCell> make_table() {
  using enum ElementShape;
  const NumberedOrder orders[] = {
      {1, {.type = {point, 1, 1}}},
      {3, {.type = {line, 1, 2}}},
      {5, {.type = {triangle, 1, 3}}},
      {9, {.type = {quadrangle, 1, 4}}},
      {8, {.type = {quadrangle, 1, 4}, .nodes = "0 1 3 2"}},
      {10, {.type = {tetrahedron, 1, 4}}},
      {12, {.type = {hexahedron, 1, 8}}},
      {11, {.type = {hexahedron, 1, 8}, .nodes = "0 1 3 2 4 5 7 6"}},
      {13, {.type = {prism, 1, 6}, .nodes = "0 2 1 3 5 4"}},
      {14, {.type = {pyramid, 1, 5}}},
      {21, {.type = {line, 2, 3}, .nodes = "0 1 01"}},
      {22, {.type = {triangle, 2, 6}, .nodes = "0 1 2 01 12 20"}},
      {23, {.type = {quadrangle, 2, 8}, .nodes = "0 1 2 3 01 12 23 30"}},
      {28, {.type = {quadrangle, 2, 9}, .nodes = "0 1 2 3 01 12 23 30 0123"}},
      {24, {.type = {tetrahedron, 2, 10}, .nodes = "0 1 2 3 01 12 20 03 13 23"}},
      {25,
       {.type = {hexahedron, 2, 20},
        .nodes = "0 1 2 3 4 5 6 7 01 12 23 30 45 56 67 74 04 15 26 37"}},
      {29,
       {.type = {hexahedron, 2, 27},
        .nodes = "0 1 2 3 4 5 6 7 01 12 23 30 45 56 67 74 04 15 26 37 0374 1265 0154 2376 0123 "
                 "4567 01234567"}},
      {26, {.type = {prism, 2, 15}, .nodes = "0 1 2 3 4 5 01 12 20 34 45 53 03 14 25"}},
      {32,
       {.type = {prism, 2, 18}, .nodes = "0 1 2 3 4 5 01 12 20 34 45 53 03 14 25 0143 1254 2035"}},
      {27, {.type = {pyramid, 2, 13}, .nodes = "0 1 2 3 4 01 12 23 30 04 14 24 34"}}};
  std::vector<VtkCell> table;
  for (const auto& [number, order] : orders)
    table.push_back({number, order.type, places_in_gmsh_order(order)});
  return table;
}

const std::vector<VtkCell>& table() {
  static const std::vector<VtkCell> cells = make_table();
  return cells;
}

}  // namespace

const VtkCell* vtk_cell(Tag number) {
  static const std::vector<const VtkCell*> by_number = [] {
    std::vector<const VtkCell*> result;
    for (const VtkCell& cell : table()) {
      const auto place = static_cast<std::size_t>(cell.number);
      if (result.size() <= place) result.resize(place + 1, nullptr);
      result[place] = &cell;
    }
    return result;
  }();
  const auto place = static_cast<std::uint64_t>(number);
  return place < by_number.size() ? by_number[place] : nullptr;
}

const VtkCell* vtk_cell(const ElementType& type) {
  const auto found = std::find_if(table().begin(), table().end(),
                                  [&](const VtkCell& cell) { return cell.type == type; });
  return found == table().end() ? nullptr : &*found;
}

void check_for_vtk(const Mesh& mesh, const std::filesystem::path& path) {
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0 && vtk_cell(block.type) == nullptr)
      throw InputError(fmt::format("{}: VTK has no {} with {} nodes; write .msh", path.string(),
                                   name(block.type), block.type.n_nodes));
}

}  // namespace roughmesh::detail
