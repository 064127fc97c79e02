// SPDX-License-Identifier: BSD-3-Clause
#include "surface_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "messages.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

using Cell = std::array<std::int64_t, 3>;

constexpr double cells_per_diagonal = 1e9;

// Positions relative to the bounding box of the surface, in steps of 1e-9 of its diagonal.
struct Grid {
  Vec3 corner;
  double step = 0;

  bool reaches(const Vec3& x) const {
    const Vec3 steps = (x - corner) / step;
    return (steps.array() > -1).all() && (steps.array() < cells_per_diagonal + 1).all();
  }
  Cell cell(const Vec3& x) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<std::int64_t>(std::floor((x[axis] - corner[axis]) / step + 0.5));
    return cell;
  }
};

std::vector<std::uint8_t> used_nodes(const Mesh& mesh, std::span<const Index> face_nodes) {
  std::vector<std::uint8_t> used(mesh.nodes.size(), 0);
  for (const Index node : face_nodes) used[node] = 1;
  return used;
}

std::vector<Index> distinct_nodes(const std::vector<std::uint8_t>& used) {
  std::vector<Index> nodes;
  for (std::size_t node = 0; node < used.size(); ++node)
    if (used[node]) nodes.push_back(static_cast<Index>(node));
  return nodes;
}

Grid make_grid(const Mesh& mesh, std::span<const Index> nodes) {
  Vec3 low = mesh.nodes[nodes.front()], high = low;
  for (const Index node : nodes) {
    const Vec3& x = mesh.nodes[node];
    if (!x.allFinite())
      throw InputError(fmt::format("node {} has a coordinate that is not finite; mend the mesh",
                                   mesh.node_tags[node]));
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double diagonal = (high - low).norm();
  if (!(diagonal > 0))
    throw InputError(fmt::format("all {} nodes of the surface are at {}; mend the mesh",
                                 nodes.size(), place(low)));
  return {low, diagonal / cells_per_diagonal};
}

bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

struct PlacedNode {
  Cell cell;
  Index node;
};

// Ties inside a cell go by exact position, so that the first of a cell does not depend on numbers.
std::vector<PlacedNode> sorted_by_position(const Mesh& mesh, std::span<const Index> nodes,
                                           const Grid& grid) {
  std::vector<PlacedNode> placed;
  placed.reserve(nodes.size());
  for (const Index node : nodes) placed.push_back({grid.cell(mesh.nodes[node]), node});
  std::sort(placed.begin(), placed.end(), [&](const PlacedNode& a, const PlacedNode& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    return lexicographically_less(mesh.nodes[a.node], mesh.nodes[b.node]);
  });
  return placed;
}

// For every node of the mesh, the place of its cell in this ascending list or -1.
std::vector<Index> find_cells(const Mesh& mesh, const Grid& grid, std::span<const Cell> cells) {
  std::vector<Index> found(mesh.nodes.size(), -1);
  constexpr std::size_t grain = 4096;
  parallel_for(mesh.nodes.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (!grid.reaches(mesh.nodes[node])) continue;
      const Cell cell = grid.cell(mesh.nodes[node]);
      const auto at = std::lower_bound(cells.begin(), cells.end(), cell);
      if (at != cells.end() && *at == cell) found[node] = static_cast<Index>(at - cells.begin());
    }
  });
  return found;
}

void leave_coincident_nodes(const std::vector<std::uint8_t>& used, WeldedPoints& welded) {
  for (std::size_t node = 0; node < used.size(); ++node) {
    if (used[node] || welded.point_of_node[node] < 0) continue;
    welded.point_of_node[node] = -1;
    ++welded.n_coincident_nodes;
  }
}

}  // namespace

WeldedPoints weld_points(const Mesh& mesh, std::span<const Index> face_nodes) {
  const std::vector<std::uint8_t> used = used_nodes(mesh, face_nodes);
  const std::vector<Index> nodes = distinct_nodes(used);
  const Grid grid = make_grid(mesh, nodes);
  WeldedPoints welded;
  std::vector<Cell> cells;
  for (const PlacedNode& placed : sorted_by_position(mesh, nodes, grid)) {
    if (!cells.empty() && cells.back() == placed.cell) continue;
    cells.push_back(placed.cell);
    welded.points.push_back(mesh.nodes[placed.node]);
  }
  welded.point_of_node = find_cells(mesh, grid, cells);
  leave_coincident_nodes(used, welded);
  return welded;
}

}  // namespace roughmesh::detail
