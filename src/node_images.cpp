// SPDX-License-Identifier: BSD-3-Clause
#include "node_images.hpp"

#include <algorithm>

#include "roughmesh/periodic.hpp"

namespace roughmesh::detail {
namespace {

// Of the distance between a node and its image, by which images by translation may differ.
constexpr double same_shift = 1e-6;

bool is_translation(const Mesh& mesh, const PeriodicLink& link) {
  const auto shift = [&](const std::pair<Index, Index>& nodes) -> Vec3 {
    return mesh.nodes[nodes.first] - mesh.nodes[nodes.second];
  };
  const Vec3 first = shift(link.nodes.front());
  return std::all_of(link.nodes.begin(), link.nodes.end(), [&](const auto& nodes) {
    return (shift(nodes) - first).norm() <= same_shift * first.norm();
  });
}

}  // namespace

NodeLinks node_links(const Mesh& mesh) {
  NodeLinks links{DisjointSets(mesh.nodes.size()), std::vector<std::uint8_t>(mesh.nodes.size(), 0)};
  for (const PeriodicLink& link : mesh.periodic_links) {
    if (link.nodes.empty()) continue;
    const bool is_translated = is_translation(mesh, link);
    for (const auto& [slave, master] : link.nodes) {
      if (is_translated)
        links.translated.unite(slave, master);
      else
        links.held[slave] = links.held[master] = 1;
    }
  }
  return links;
}

void unite_by_position(const Mesh& mesh, std::span<const Index> nodes, const Vec3& period,
                       DisjointSets& classes) {
  std::vector<Vec3> places;
  places.reserve(nodes.size());
  for (const Index node : nodes) places.push_back(mesh.nodes[node]);
  for (const auto& [a, b] : periodic_pairs(places, period)) classes.unite(nodes[a], nodes[b]);
}

}  // namespace roughmesh::detail
