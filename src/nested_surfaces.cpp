// SPDX-License-Identifier: BSD-3-Clause
#include "nested_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "disjoint_sets.hpp"
#include "messages.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

using Component = NestedSurfaces::Component;
using Triangle = std::array<Index, 3>;

Component all_triangles(const Mesh& mesh) {
  Component all;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != 2) continue;
    for (Index e = 0; e < block.size(); ++e) {
      if (block.type.shape != ElementShape::triangle || block.type.order != 1)
        throw InputError(
            fmt::format("element {} is a {}: only triangles of order 1 can be filled with "
                        "tetrahedra; divide it",
                        block.tags[e], name(block.type)));
      const auto nodes = block.element(e);
      all.triangles.push_back({nodes[0], nodes[1], nodes[2]});
      all.elements.push_back(block.tags[e]);
    }
  }
  if (all.triangles.empty())
    throw InputError("--volume remesh: the mesh has no closed surface to fill; take --volume none");
  return all;
}

using EdgeOf = std::pair<std::pair<Index, Index>, Index>;  // ascending nodes, triangle

std::vector<EdgeOf> sorted_edges(const std::vector<Triangle>& triangles) {
  std::vector<EdgeOf> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      edges.emplace_back(std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]),
                         static_cast<Index>(t));
  parallel_sort(std::span(edges), std::less<>());
  return edges;
}

DisjointSets join_closed(const Mesh& mesh, const std::vector<Triangle>& triangles) {
  const std::vector<EdgeOf> edges = sorted_edges(triangles);
  DisjointSets sets(triangles.size());
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    while (end < edges.size() && edges[end].first == edges[first].first) ++end;
    if (end - first != 2)
      throw InputError(fmt::format(
          "the edge between {} and {} has {} triangle{}: only a closed surface, two at every edge, "
          "can be filled; close it, or take --volume none",
          place(mesh.nodes[edges[first].first.first]), place(mesh.nodes[edges[first].first.second]),
          end - first, end - first == 1 ? "" : "s"));
    sets.unite(edges[first].second, edges[first + 1].second);
  }
  return sets;
}

std::vector<Component> find_components(const Mesh& mesh) {
  const Component all = all_triangles(mesh);
  DisjointSets sets = join_closed(mesh, all.triangles);
  std::map<Index, std::size_t> component_of_root;
  std::vector<Component> components;
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    const Index root = sets.smallest(static_cast<Index>(t));
    const std::size_t c = component_of_root.try_emplace(root, components.size()).first->second;
    if (c == components.size()) components.emplace_back();
    components[c].triangles.push_back(all.triangles[t]);
    components[c].elements.push_back(all.elements[t]);
  }
  return components;
}

Eigen::AlignedBox3d box_of(const Component& component, std::span<const Vec3> nodes) {
  Eigen::AlignedBox3d box;
  for (const Triangle& t : component.triangles)
    for (const Index node : t) box.extend(nodes[node]);
  return box;
}

// On no other component where they touch at corners and edges.
Vec3 middle(const Triangle& t, std::span<const Vec3> nodes) {
  return nodes[t[0]] / 3 + nodes[t[1]] / 3 + nodes[t[2]] / 3;
}

// Of each component those that enclose it.
std::vector<std::vector<Index>> enclosures(const std::vector<Component>& components,
                                           std::span<const Vec3> nodes) {
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(components.size());
  for (const Component& component : components) boxes.push_back(box_of(component, nodes));
  std::vector<std::vector<Index>> around(components.size());
  parallel_for(components.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t other = 0; other < components.size(); ++other) {
        if (other == c || !boxes[other].contains(boxes[c])) continue;
        const Vec3 x = middle(components[c].triangles.front(), nodes);
        if (std::abs(winding_number(components[other].triangles, nodes, x)) > 0.5)
          around[c].push_back(static_cast<Index>(other));
      }
  });
  return around;
}

}  // namespace

double winding_number(std::span<const std::array<Index, 3>> triangles, std::span<const Vec3> nodes,
                      const Vec3& place) {
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = nodes[t[0]] - place, b = nodes[t[1]] - place, c = nodes[t[2]] - place;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.cross(b).dot(c),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

NestedSurfaces find_nested_surfaces(const Mesh& mesh) {
  NestedSurfaces nested{find_components(mesh)};
  const auto around = enclosures(nested.components, mesh.nodes);
  for (std::size_t c = 0; c < around.size(); ++c) {
    // The innermost is enclosed by all the others.
    const auto innermost =
        std::max_element(around[c].begin(), around[c].end(),
                         [&](Index a, Index b) { return around[a].size() < around[b].size(); });
    if (innermost != around[c].end()) nested.components[c].around = *innermost;
  }
  return nested;
}

}  // namespace roughmesh::detail
