// SPDX-License-Identifier: BSD-3-Clause
#include "curved_elements.hpp"

#include <algorithm>

#include "quadratic_map.hpp"

namespace roughmesh::detail {
namespace {

template <class Visit>
void for_each_cell(const Mesh& mesh, int cell_dimension, Visit&& visit) {
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (Index e = 0;
         dimension(mesh.blocks[b].type.shape) == cell_dimension && e < mesh.blocks[b].size(); ++e)
      visit(ElementOfMesh{static_cast<Index>(b), e});
}

NodeFlags corner_flags(const Mesh& mesh, int cell_dimension) {
  NodeFlags is_corner(mesh.nodes.size(), 0);
  for_each_cell(mesh, cell_dimension, [&](const ElementOfMesh& cell) {
    const auto n = static_cast<std::size_t>(n_corners(cell.type(mesh).shape));
    for (const Index node : cell.nodes(mesh).first(n)) is_corner[node] = 1;
  });
  return is_corner;
}

// Elements whose offset is worked out, layer by layer around the nodes of the surfaces.
std::vector<ElementOfMesh> cells_near(const Mesh& mesh, int cell_dimension, NodeFlags is_near,
                                      int layers) {
  std::vector<ElementOfMesh> cells;
  for (int layer = 0; layer < layers; ++layer) {
    cells.clear();
    NodeFlags next = is_near;
    for_each_cell(mesh, cell_dimension, [&](const ElementOfMesh& cell) {
      const auto nodes = cell.nodes(mesh);
      if (std::none_of(nodes.begin(), nodes.end(), [&](Index n) { return is_near[n] != 0; }))
        return;
      for (const Index node : nodes) next[node] = 1;
      if (quadratic_map(cell.type(mesh)) != nullptr) cells.push_back(cell);
    });
    is_near = std::move(next);
  }
  return cells;
}

// Nodes without an offset have no role: theirs is zero.
NodeRoles roles_of(const Mesh& mesh, std::span<const ElementOfMesh> cells,
                   const NodeFlags& has_none, const NodeFlags& is_settled) {
  NodeRoles roles;
  roles.unknown.assign(mesh.nodes.size(), -1);
  roles.given.assign(mesh.nodes.size(), -1);
  for (const ElementOfMesh& cell : cells)
    for (const Index node : cell.nodes(mesh)) {
      if (has_none[node] || roles.unknown[node] >= 0 || roles.given[node] >= 0) continue;
      if (is_settled[node])
        roles.given[node] = roles.n_given++;
      else
        roles.unknown[node] = roles.n_unknown++;
    }
  return roles;
}

// The nodes with a number, in the order of these.
std::vector<Index> numbered(const std::vector<Index>& numbers, Index n) {
  std::vector<Index> nodes(static_cast<std::size_t>(n));
  for (std::size_t node = 0; node < numbers.size(); ++node)
    if (numbers[node] >= 0)
      nodes[static_cast<std::size_t>(numbers[node])] = static_cast<Index>(node);
  return nodes;
}

NodeFlags either(NodeFlags a, const NodeFlags& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] != 0 || b[i] != 0;
  return a;
}

NodeFlags with_nodes(NodeFlags flags, std::span<const Index> nodes) {
  for (const Index node : nodes) flags[node] = 1;
  return flags;
}

NodeFlags none_of(NodeFlags flags) {
  for (auto& flag : flags) flag = flag == 0;
  return flags;
}

}  // namespace

CurvedElements::CurvedElements(const Mesh& mesh, int cell_dimension, const SettledNodes& known,
                               bool can_repair)
    : mesh_(mesh),
      straight_(mesh, cell_dimension, corner_flags(mesh, cell_dimension)),
      following_(mesh, cell_dimension, NodeFlags(mesh.nodes.size(), 1)) {
  if (straight_.nodes().empty()) return;
  const NodeFlags is_corner = corner_flags(mesh, cell_dimension);
  const auto cells = cells_near(mesh, cell_dimension, known.is_moved, layers);
  const NodeFlags has_no_offset =
      known.keeps_straight.empty() ? is_corner : either(is_corner, known.keeps_straight);
  const NodeRoles roles = roles_of(mesh, cells, has_no_offset, known.is_settled);
  unknown_nodes_ = numbered(roles.unknown, roles.n_unknown);
  given_nodes_ = numbered(roles.given, roles.n_given);
  extension_ = std::make_unique<const QuadraticExtension>(mesh, cells, roles);
  const NodeFlags has_place = either(is_corner, known.is_settled);
  following_ = {mesh, cell_dimension, with_nodes(has_place, unknown_nodes_)};
  if (can_repair) repair_.emplace(mesh, cell_dimension, none_of(either(has_place, has_no_offset)));
}

void CurvedElements::place(std::span<Vec3> positions) const {
  if (straight_.nodes().empty()) return;
  std::vector<Vec3> shifts(mesh_.nodes.size());
  for (std::size_t i = 0; i < shifts.size(); ++i) shifts[i] = positions[i] - mesh_.nodes[i];
  std::vector<Vec3> straight = shifts;
  straight_.fill(straight);
  std::vector<Vec3> offsets;
  offsets.reserve(given_nodes_.size());
  for (const Index node : given_nodes_) offsets.push_back(shifts[node] - straight[node]);
  offsets = extension_->extend(offsets);
  for (std::size_t i = 0; i < offsets.size(); ++i)
    shifts[unknown_nodes_[i]] = straight[unknown_nodes_[i]] + offsets[i];
  following_.fill(shifts);
  for (const Index node : unknown_nodes_) positions[node] = mesh_.nodes[node] + shifts[node];
  for (const Index node : following_.nodes()) positions[node] = mesh_.nodes[node] + shifts[node];
  if (repair_) repair_->mend(positions);
}

}  // namespace roughmesh::detail
