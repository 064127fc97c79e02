// SPDX-License-Identifier: BSD-3-Clause
#include "surface_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>

#include "messages.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 4096;
constexpr double cells_per_diagonal = 1e9;

// Numbers of a cell along the axes, of up to 31 bits each: those of x and y, then that of z.
using Cell = std::array<std::uint64_t, 2>;

// Positions relative to the bounding box of the surface, in steps of 1e-9 of its diagonal.
struct Grid {
  Vec3 corner;
  double step = 0;

  bool reaches(const Vec3& x) const {
    const Vec3 steps = (x - corner) / step;
    return (steps.array() > -1).all() && (steps.array() < cells_per_diagonal + 1).all();
  }
  Cell cell(const Vec3& x) const {
    const auto along = [&](int axis) {
      return static_cast<std::uint64_t>(std::floor((x[axis] - corner[axis]) / step + 1.5));
    };
    return {along(0) << 32 | along(1), along(2)};
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
  std::vector<PlacedNode> placed(nodes.size());
  parallel_for(placed.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      placed[i] = {grid.cell(mesh.nodes[nodes[i]]), nodes[i]};
  });
  parallel_sort(std::span(placed), [&](const PlacedNode& a, const PlacedNode& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    const Vec3 &x = mesh.nodes[a.node], &y = mesh.nodes[b.node];
    return x != y ? lexicographically_less(x, y) : a.node < b.node;
  });
  return placed;
}

// Nodes that are not used, in cells of those that are.
Index count_coincident_nodes(const Mesh& mesh, const std::vector<std::uint8_t>& used,
                             const Grid& grid, std::span<const PlacedNode> placed) {
  std::vector<Index> counts((used.size() + grain - 1) / grain, 0);
  parallel_for(used.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (used[node] || !grid.reaches(mesh.nodes[node])) continue;
      const Cell cell = grid.cell(mesh.nodes[node]);
      const auto at =
          std::lower_bound(placed.begin(), placed.end(), cell,
                           [](const PlacedNode& a, const Cell& b) { return a.cell < b; });
      counts[begin / grain] += at != placed.end() && at->cell == cell;
    }
  });
  return std::accumulate(counts.begin(), counts.end(), Index{0});
}

}  // namespace

WeldedPoints weld_points(const Mesh& mesh, std::span<const Index> face_nodes) {
  const std::vector<std::uint8_t> used = used_nodes(mesh, face_nodes);
  const std::vector<Index> nodes = distinct_nodes(used);
  const Grid grid = make_grid(mesh, nodes);
  const std::vector<PlacedNode> placed = sorted_by_position(mesh, nodes, grid);
  WeldedPoints welded;
  welded.point_of_node.assign(mesh.nodes.size(), -1);
  welded.points.reserve(placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (i == 0 || placed[i].cell != placed[i - 1].cell)
      welded.points.push_back(mesh.nodes[placed[i].node]);
    welded.point_of_node[placed[i].node] = static_cast<Index>(welded.points.size()) - 1;
  }
  if (nodes.size() < mesh.nodes.size())
    welded.n_coincident_nodes = count_coincident_nodes(mesh, used, grid, placed);
  return welded;
}

}  // namespace roughmesh::detail
