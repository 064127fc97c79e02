// SPDX-License-Identifier: BSD-3-Clause
#include "split_trapped.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "new_tags.hpp"
#include "volume_faces.hpp"

namespace roughmesh::detail {
namespace {

using Edge = std::pair<Index, Index>;  // ascending
using Tetrahedron = std::array<Index, 4>;

constexpr std::array<std::array<std::size_t, 2>, 6> edges_of_tetrahedron = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

Edge make_edge(Index a, Index b) { return std::minmax(a, b); }

bool can_be_split(const ElementBlock& block) {
  return block.type.shape == ElementShape::tetrahedron && block.type.order == 1;
}

Tetrahedron tetrahedron(const ElementBlock& block, Index element) {
  Tetrahedron result;
  std::copy_n(block.element(element).begin(), 4, result.begin());
  return result;
}

template <class Nodes>
bool any_of(const Nodes& nodes, const NodeFlags& flags) {
  return std::any_of(nodes.begin(), nodes.end(), [&](Index node) { return flags[node] != 0; });
}

void sort_once(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

// Edges whose split would change more than tetrahedra.
std::vector<Edge> edges_to_keep(const Mesh& mesh) {
  std::vector<Edge> edges;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; !can_be_split(block) && e < block.size(); ++e)
      for (const auto& [a, b] : local_edges(block.type.shape))
        edges.push_back(make_edge(block.element(e)[a], block.element(e)[b]));
  for (const CellFace& face : boundary_faces(mesh, 3)) {
    const auto corners = face.corners();
    for (std::size_t k = 0; k < corners.size(); ++k)
      edges.push_back(make_edge(corners[k], corners[(k + 1) % corners.size()]));
  }
  sort_once(edges);
  return edges;
}

// A new node between two nodes with images would have none.
NodeFlags linked_nodes(const Mesh& mesh) {
  NodeFlags linked(mesh.nodes.size(), 0);
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const auto& [slave, master] : link.nodes) linked[slave] = linked[master] = 1;
  return linked;
}

std::vector<Edge> edges_to_split(const Mesh& mesh, const NodeFlags& is_free,
                                 const NodeFlags& marked) {
  std::vector<Edge> edges;
  const NodeFlags linked = linked_nodes(mesh);
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; can_be_split(block) && e < block.size(); ++e) {
      const Tetrahedron t = tetrahedron(block, e);
      if (!any_of(t, marked)) continue;
      for (const auto& [a, b] : edges_of_tetrahedron)
        if (!is_free[t[a]] && !is_free[t[b]] && (!linked[t[a]] || !linked[t[b]]))
          edges.push_back(make_edge(t[a], t[b]));
    }
  sort_once(edges);
  const std::vector<Edge> kept = edges_to_keep(mesh);
  std::vector<Edge> result;
  std::set_difference(edges.begin(), edges.end(), kept.begin(), kept.end(),
                      std::back_inserter(result));
  return result;
}

class Splitter {
 public:
  Splitter(const Mesh& mesh, NodeFlags is_free, const NodeFlags& marked,
           std::span<const Vec3> positions)
      : edges_(edges_to_split(mesh, is_free, marked)),
        is_free_(std::move(is_free)),
        marked_(marked),
        result_{mesh, {positions.begin(), positions.end()}, 0},
        first_new_(mesh.n_nodes()) {
    for (const ElementBlock& block : mesh.blocks) element_tags_.keep_off(block.tags);
    node_tags_.keep_off(mesh.node_tags);
    for (const auto& [a, b] : edges_) add_node(std::array{a, b});
  }

  SplitMesh run() && {
    for (ElementBlock& block : result_.mesh.blocks)
      if (can_be_split(block)) split_block(block);
    return std::move(result_);
  }

 private:
  template <class Corners>
  Index add_node(const Corners& corners) {
    Vec3 rest = Vec3::Zero(), moved = Vec3::Zero();
    for (const Index node : corners) {
      rest += result_.mesh.nodes[node] / static_cast<double>(corners.size());
      moved += result_.positions[node] / static_cast<double>(corners.size());
    }
    result_.mesh.nodes.push_back(rest);
    result_.positions.push_back(moved);
    result_.mesh.node_tags.push_back(node_tags_.next());
    is_free_.push_back(1);
    ++result_.n_new_nodes;
    return result_.mesh.n_nodes() - 1;
  }

  void split_block(ElementBlock& block) {
    const ElementBlock old =
        std::exchange(block, ElementBlock{block.type, block.entity, block.physical_groups, {}, {}});
    for (Index e = 0; e < old.size(); ++e) {
      old_tag_ = old.tags[e];
      const Tetrahedron t = tetrahedron(old, e);
      split_edges(t, any_of(t, marked_), block);
    }
  }

  // Neighbours split the edges that they share in the same order, that of `edges_`, so that their
  // parts fit together.
  void split_edges(const Tetrahedron& t, bool is_needed, ElementBlock& out) {
    std::size_t first = edges_.size(), a = 0, b = 0;
    for (const auto& [i, j] : edges_of_tetrahedron) {
      const auto at = std::lower_bound(edges_.begin(), edges_.end(), make_edge(t[i], t[j]));
      const auto number = static_cast<std::size_t>(at - edges_.begin());
      if (number >= first || *at != make_edge(t[i], t[j])) continue;
      first = number;
      a = i;
      b = j;
    }
    if (first == edges_.size()) return split_middle(t, is_needed, out);
    for (const std::size_t corner : {a, b}) {
      Tetrahedron part = t;
      part[corner] = first_new_ + static_cast<Index>(first);
      split_edges(part, is_needed, out);
    }
  }

  void split_middle(const Tetrahedron& t, bool is_needed, ElementBlock& out) {
    if (!is_needed || any_of(t, is_free_)) return add(t, out);
    const Index middle = add_node(t);
    for (std::size_t corner = 0; corner < t.size(); ++corner) {
      Tetrahedron part = t;
      part[corner] = middle;
      add(part, out);
    }
  }

  void add(const Tetrahedron& t, ElementBlock& out) {
    out.nodes.insert(out.nodes.end(), t.begin(), t.end());
    out.tags.push_back(old_tag_ ? *old_tag_ : element_tags_.next());
    old_tag_.reset();
  }

  std::vector<Edge> edges_;
  NodeFlags is_free_;
  const NodeFlags& marked_;
  SplitMesh result_;
  Index first_new_ = 0;
  NewTags node_tags_{"node"}, element_tags_{"element"};
  std::optional<Tag> old_tag_;  // of the element that is split, until its first part has it
};

}  // namespace

std::optional<SplitMesh> split_trapped(const Mesh& mesh, const NodeFlags& is_free,
                                       const NodeFlags& marked, std::span<const Vec3> positions) {
  SplitMesh result = Splitter(mesh, is_free, marked, positions).run();
  if (result.n_new_nodes == 0) return std::nullopt;
  return result;
}

}  // namespace roughmesh::detail
