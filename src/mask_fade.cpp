// SPDX-License-Identifier: BSD-3-Clause
#include "mask_fade.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "group_lookup.hpp"
#include "parallel.hpp"
#include "simplex_tree.hpp"
#include "smooth_step.hpp"
#include "surface_edges.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 1024;

PhysicalGroup require_group(const Mesh& mesh, const Surface& surface, const std::string& text) {
  const auto group = text.empty() ? std::nullopt : find_group(mesh, text, surface.dimension - 1);
  if (!group)
    throw InputError(fmt::format("mask: there is no physical group '{}'; {}", text,
                                 mesh.groups.empty()
                                     ? "the mesh has none"
                                     : "groups of the mesh: " + list_of_labels(mesh.groups)));
  if (!has_elements(mesh, *group))
    throw InputError(
        fmt::format("mask: physical group '{}' (dimension {}) has no element; choose another", text,
                    group->dimension));
  return *group;
}

// ---- Borders: where one face, or one line of a curve, ends ----

std::vector<PlacedSimplex> border_of(const Surface& surface) {
  if (surface.border_edges.empty())
    throw InputError(
        "fade: the surface is closed and has no border to fade from; name a physical group to fade "
        "from, or leave the fade out");
  const auto n_corners = static_cast<std::size_t>(surface.dimension);
  std::vector<PlacedSimplex> border;
  for (const auto& [i, j] : surface.border_edges) {
    const std::array ends = {surface.points[i], surface.points[j]};
    border.emplace_back(std::span(ends).first(n_corners));
  }
  return border;
}

// ---- Groups: their elements near the surface ----

// Nodes of the surface stand at their points, from which they may be 1e-9 of its size away, so that
// the distance of a point from its own elements is exactly 0.
std::vector<Vec3> positions_on_points(const Mesh& mesh, const Surface& surface) {
  std::vector<Vec3> positions(mesh.nodes);
  for (std::size_t k = 0; k < surface.nodes.size(); ++k)
    positions[surface.nodes[k]] = surface.points[surface.point_of_node[k]];
  return positions;
}

struct Corners8 {
  std::array<Vec3, 8> positions;
  std::size_t n = 0;

  std::span<const Vec3> span() const { return {positions.data(), n}; }
};

Corners8 corners_of(const ElementBlock& block, Index element, std::span<const Vec3> positions) {
  Corners8 corners;
  corners.n = static_cast<std::size_t>(n_corners(block.type.shape));
  for (std::size_t k = 0; k < corners.n; ++k) {
    corners.positions[k] = positions[block.element(element)[k]];
    if (!corners.positions[k].allFinite())
      throw InputError(fmt::format("element {} has a coordinate that is not finite; mend the mesh",
                                   block.tags[element]));
  }
  return corners;
}

Eigen::AlignedBox3d bounds(std::span<const Vec3> positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : positions) box.extend(x);
  return box;
}

// Without the elements from which no point of the surface is within the reach.
std::vector<PlacedSimplex> elements_of(const Mesh& mesh, const Surface& surface,
                                       const PhysicalGroup& group, double reach) {
  const std::vector<Vec3> positions = positions_on_points(mesh, surface);
  Eigen::AlignedBox3d near = bounds(surface.points);
  near.min().array() -= reach;
  near.max().array() += reach;
  std::vector<PlacedSimplex> elements;
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_in_group(block, group)) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const Corners8 corners = corners_of(block, e, positions);
      if (near.intersects(bounds(corners.span())))
        append_simplices(block.type.shape, corners.span(), elements);
    }
  }
  return elements;
}

void require_width(double width) {
  if (width > 0 && std::isfinite(width)) return;
  throw InputError(fmt::format(
      "fade: the width is {}; give a finite length above 0, or fix the group instead", width));
}

}  // namespace

void apply_fade(const Mesh& mesh, const Surface& surface, const Fade& fade,
                std::vector<double>& weights) {
  require_width(fade.width);
  const SimplexTree tree(
      fade.group.empty()
          ? border_of(surface)
          : elements_of(mesh, surface, require_group(mesh, surface, fade.group), fade.width));
  parallel_for(weights.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      weights[i] *= smooth_step(tree.distance_within(surface.points[i], fade.width) / fade.width);
  });
}

void apply_fixed(const Mesh& mesh, const Surface& surface, const std::string& text,
                 std::vector<double>& weights) {
  const PhysicalGroup group = require_group(mesh, surface, text);
  std::vector<std::uint8_t> is_fixed(mesh.nodes.size(), 0);
  for (const ElementBlock& block : mesh.blocks)
    if (is_in_group(block, group))
      for (const Index node : block.nodes) is_fixed[node] = 1;
  bool touches = false;
  for (std::size_t k = 0; k < surface.nodes.size(); ++k) {
    if (!is_fixed[surface.nodes[k]]) continue;
    weights[surface.point_of_node[k]] = 0;
    touches = true;
  }
  if (!touches)
    throw InputError(
        fmt::format("fixed: no point of the surface is on physical group '{}' (dimension {}); name "
                    "a group that touches the surface",
                    text, group.dimension));
}

}  // namespace roughmesh::detail
