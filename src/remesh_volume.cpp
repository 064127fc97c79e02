// SPDX-License-Identifier: BSD-3-Clause
#include "remesh_volume.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"

#include "corners.hpp"
#include "messages.hpp"
#include "new_tags.hpp"
#include "remesh_task.hpp"

namespace roughmesh::detail {
namespace {

using Flags = std::vector<std::uint8_t>;
using Edge = std::pair<Index, Index>;  // ascending

Edge make_edge(Index a, Index b) { return std::minmax(a, b); }

bool is_in(const std::vector<Edge>& sorted, const Edge& edge) {
  return std::binary_search(sorted.begin(), sorted.end(), edge);
}

void sort_once(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

// The mesh and which of its regions are meshed anew.
struct Touched {
  const Mesh& mesh;
  const VolumeRegions& regions;
  const Flags& is_touched;  // per region

  bool has(std::size_t block, Index element) const {
    const auto& of_block = regions.of_block[block];
    return !of_block.empty() && is_touched[of_block[element]] != 0;
  }
  template <class Visit>
  void for_each_cell(Visit&& visit) const {
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
      for (Index e = 0; e < mesh.blocks[b].size(); ++e)
        if (has(b, e)) visit(mesh.blocks[b], e);
  }
  template <class Visit>
  void for_each_face(Visit&& visit) const {
    for (const RegionFace& face : regions.faces)
      if (std::any_of(face.regions.begin(), face.regions.end(),
                      [&](Index region) { return region >= 0 && is_touched[region] != 0; }))
        visit(face.face);
  }
};

void check_cells(const Touched& touched) {
  touched.for_each_cell([](const ElementBlock& block, Index e) {
    if (block.type.shape != ElementShape::tetrahedron)
      throw InputError(
          fmt::format("element {} beside the rough surface is a {}: --volume remesh makes "
                      "tetrahedra only, which would not fit it; take --volume move",
                      block.tags[e], name(block.type)));
    require_movable_order(block.type, block.tags[e]);
  });
}

// Nodes that only elements of touched regions have.
Flags inner_nodes(const Touched& touched) {
  Flags is_inner(touched.mesh.nodes.size(), 0);
  touched.for_each_cell([&](const ElementBlock& block, Index e) {
    for (const Index node : block.element(e)) is_inner[node] = 1;
  });
  touched.for_each_face([&](const CellFace& face) {
    for (const Index node : face.all()) is_inner[node] = 0;
  });
  return is_inner;
}

[[noreturn]] void refuse_inner(const std::string& what, const Vec3& x) {
  throw InputError(
      fmt::format("{} lies inside a volume beside the rough surface, at {}, and would be lost with "
                  "its elements; take --volume move",
                  what, place(x)));
}

void check_inner_nodes(const Mesh& mesh, const Flags& is_inner) {
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) < 3 && e < block.size(); ++e)
      for (const Index node : block.element(e))
        if (is_inner[node] != 0)
          refuse_inner(fmt::format("element {} ({})", block.tags[e], name(block.type)),
                       mesh.nodes[node]);
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const auto& [slave, master] : link.nodes)
      for (const Index node : {slave, master})
        if (is_inner[node] != 0)
          refuse_inner(fmt::format("periodic node {}", mesh.node_tags[node]), mesh.nodes[node]);
}

// Lines that join two nodes of the faces straight through a volume.
void check_inner_lines(const Touched& touched) {
  std::vector<Edge> on_faces, lines;
  touched.for_each_face([&](const CellFace& face) {
    const auto c = face.corners();
    for (std::size_t k = 0; k < c.size(); ++k)
      on_faces.push_back(make_edge(c[k], c[(k + 1) % c.size()]));
  });
  sort_once(on_faces);
  for (const ElementBlock& block : touched.mesh.blocks)
    for (Index e = 0; block.type.shape == ElementShape::line && e < block.size(); ++e) {
      const Edge edge = make_edge(block.element(e)[0], block.element(e)[1]);
      if (!is_in(on_faces, edge)) lines.push_back(edge);
    }
  if (lines.empty()) return;
  sort_once(lines);
  touched.for_each_cell([&](const ElementBlock& block, Index e) {
    for (const auto& [i, j] : local_edges(block.type.shape)) {
      const Edge edge = make_edge(block.element(e)[i], block.element(e)[j]);
      if (is_in(lines, edge))
        refuse_inner(
            fmt::format("the line between nodes {} and {}", touched.mesh.node_tags[edge.first],
                        touched.mesh.node_tags[edge.second]),
            touched.mesh.nodes[edge.first]);
    }
  });
}

void check_regions(const Touched& touched) {
  check_cells(touched);
  check_inner_nodes(touched.mesh, inner_nodes(touched));
  check_inner_lines(touched);
}

// Nodes on the edges of faces that stay go with the corners that moved, unless they moved
// themselves or have a height of their own (docs/math.md, eq. 38).
std::vector<Vec3> with_followers(const Touched& touched, const Flags& is_rough,
                                 std::span<const Vec3> positions) {
  const std::vector<Vec3>& before = touched.mesh.nodes;
  std::vector<Vec3> result(positions.begin(), positions.end());
  const auto shift = [&](Index node) -> Vec3 { return positions[node] - before[node]; };
  touched.for_each_face([&](const CellFace& face) {
    const auto nodes = face.all();
    for (std::size_t k = 3; k < nodes.size(); ++k) {
      const Index node = nodes[k], a = nodes[k - 3], b = nodes[(k - 2) % 3];
      if (is_rough[node] == 0 && positions[node] == before[node])
        result[node] = before[node] + (shift(a) + shift(b)) / 2;
    }
  });
  return result;
}

/// Puts the new elements where the old ones were.
class Assembly {
 public:
  Assembly(const Touched& touched, std::span<const Vec3> positions)
      : touched_(touched),
        input_(touched.mesh),
        first_block_(touched.regions.n_regions, -1),
        is_negative_(touched.regions.n_regions, 0) {
    const Flags is_inner = inner_nodes(touched);
    new_number_.assign(input_.nodes.size(), -1);
    for (Index node = 0; node < input_.n_nodes(); ++node) {
      if (is_inner[node] != 0) continue;
      new_number_[node] = static_cast<Index>(old_nodes_.size());
      old_nodes_.push_back(node);
      mesh_.nodes.push_back(positions[node]);
      mesh_.node_tags.push_back(input_.node_tags[node]);
    }
    node_tags_.keep_off(input_.node_tags);
    keep_elements();
    collect_middles();
  }

  RemeshedVolume run(const RemeshTask& task, const FilledVolumes& filled) && {
    std::vector<Index> number;  // of the task's nodes, then of its new ones
    for (const Index node : task.node_of_mesh) number.push_back(new_number_[node]);
    for (const Vec3& x : filled.new_nodes) number.push_back(add_node(x));
    for (std::size_t v = 0; v < task.regions.size(); ++v)
      add_region(task.regions[v], filled.tetrahedra[v], number);
    std::erase_if(mesh_.blocks, [](const ElementBlock& block) { return block.tags.empty(); });
    mesh_.groups = input_.groups;
    mesh_.format = input_.format;
    mesh_.source = input_.source;
    return {std::make_shared<const Mesh>(std::move(mesh_)), std::move(old_nodes_)};
  }

 private:
  void keep_elements() {
    mesh_.periodic_links = input_.periodic_links;
    for (PeriodicLink& link : mesh_.periodic_links)
      for (auto& [slave, master] : link.nodes) {
        slave = new_number_[slave];
        master = new_number_[master];
      }
    for (std::size_t b = 0; b < input_.blocks.size(); ++b) {
      const ElementBlock& old = input_.blocks[b];
      ElementBlock& block = mesh_.blocks.emplace_back(
          ElementBlock{old.type, old.entity, old.physical_groups, {}, {}});
      element_tags_.keep_off(old.tags);
      for (Index e = 0; e < old.size(); ++e) {
        if (touched_.has(b, e)) {
          note_region(b, e);
          continue;
        }
        for (const Index node : old.element(e)) block.nodes.push_back(new_number_[node]);
        block.tags.push_back(old.tags[e]);
      }
    }
  }

  // In which block its elements stand, and which way round.
  void note_region(std::size_t b, Index e) {
    const Index region = touched_.regions.of_block[b][e];
    if (first_block_[region] >= 0) return;
    first_block_[region] = static_cast<Index>(b);
    const auto n = input_.blocks[b].element(e);
    is_negative_[region] = determinant(input_.nodes[n[0]], input_.nodes[n[1]], input_.nodes[n[2]],
                                       input_.nodes[n[3]]) < 0;
  }

  void collect_middles() {
    touched_.for_each_face([&](const CellFace& face) {
      const auto nodes = face.all();
      for (std::size_t k = 3; k < nodes.size(); ++k)
        middles_.emplace_back(make_edge(new_number_[nodes[k - 3]], new_number_[nodes[(k - 2) % 3]]),
                              new_number_[nodes[k]]);
    });
    std::sort(middles_.begin(), middles_.end());
  }

  Index add_node(const Vec3& x) {
    mesh_.nodes.push_back(x);
    mesh_.node_tags.push_back(node_tags_.next());
    return mesh_.n_nodes() - 1;
  }

  // Nodes on edges of new elements, where the faces have none.
  void add_middles(std::vector<Edge> edges) {
    sort_once(edges);
    const std::size_t n_on_faces = middles_.size();
    const auto on_face = [&](const Edge& edge) {
      const auto end = middles_.begin() + static_cast<std::ptrdiff_t>(n_on_faces);
      const auto at = std::lower_bound(middles_.begin(), end, std::pair(edge, Index{-1}));
      return at != end && at->first == edge;
    };
    for (const Edge& edge : edges)
      if (!on_face(edge))
        middles_.emplace_back(edge,
                              add_node((mesh_.nodes[edge.first] + mesh_.nodes[edge.second]) / 2));
    std::sort(middles_.begin(), middles_.end());
  }

  Index middle(const Edge& edge) const {
    return std::lower_bound(middles_.begin(), middles_.end(), std::pair(edge, Index{-1}))->second;
  }

  void add_region(Index region, const std::vector<Tetrahedron>& tetrahedra,
                  const std::vector<Index>& number) {
    ElementBlock& block = mesh_.blocks[static_cast<std::size_t>(first_block_[region])];
    std::vector<Tetrahedron> cells = tetrahedra;
    std::vector<Edge> edges;
    for (Tetrahedron& t : cells) {
      for (Index& node : t) node = number[node];
      if (is_negative_[region] != 0) std::swap(t[2], t[3]);
      if (block.type.order == 2)
        for (const auto& [i, j] : local_edges(block.type.shape))
          edges.push_back(make_edge(t[i], t[j]));
    }
    add_middles(std::move(edges));
    for (const Tetrahedron& t : cells) {
      block.nodes.insert(block.nodes.end(), t.begin(), t.end());
      if (block.type.order == 2)
        for (const auto& [i, j] : local_edges(block.type.shape))
          block.nodes.push_back(middle(make_edge(t[i], t[j])));
      block.tags.push_back(element_tags_.next());
    }
  }

  const Touched& touched_;
  const Mesh& input_;
  Mesh mesh_;
  std::vector<Index> old_nodes_, new_number_;
  std::vector<Index> first_block_;  // per region
  Flags is_negative_;               // per region
  std::vector<std::pair<Edge, Index>> middles_;
  NewTags node_tags_{"node"}, element_tags_{"element"};
};

}  // namespace

VolumeRemesher::VolumeRemesher(const Mesh& mesh, std::span<const Surface> surfaces,
                               GmshProgram gmsh)
    : mesh_(mesh), gmsh_(std::move(gmsh)), is_rough_(mesh.nodes.size(), 0) {
  if (dimension(mesh) != 3)
    throw InputError("--volume remesh: the mesh has no volumes to mesh anew; take --volume move");
  regions_ = find_regions(mesh);
  for (const Index node : moved_nodes(surfaces)) is_rough_[node] = 1;
  const Flags is_touched = regions_at(is_rough_);
  check_regions({mesh_, regions_, is_touched});
}

std::vector<std::uint8_t> VolumeRemesher::regions_at(
    std::span<const std::uint8_t> has_moved) const {
  Flags is_touched(static_cast<std::size_t>(regions_.n_regions), 0);
  for (std::size_t b = 0; b < mesh_.blocks.size(); ++b)
    for (std::size_t e = 0; e < regions_.of_block[b].size(); ++e)
      for (const Index node : mesh_.blocks[b].element(static_cast<Index>(e)))
        if (has_moved[node] != 0) is_touched[regions_.of_block[b][e]] = 1;
  return is_touched;
}

namespace {

/// Where nothing moved that a volume touches, there is nothing to mesh anew.
RemeshedVolume keep_all(const Mesh& mesh, std::span<const Vec3> positions) {
  auto same = std::make_shared<Mesh>(mesh);
  same->nodes.assign(positions.begin(), positions.end());
  std::vector<Index> all(positions.size());
  std::iota(all.begin(), all.end(), Index{0});
  return {std::move(same), std::move(all)};
}

}  // namespace

RemeshedVolume VolumeRemesher::remesh(std::span<const Vec3> positions) const {
  Flags has_moved(mesh_.nodes.size(), 0);
  for (const RegionFace& face : regions_.faces)
    for (const Index node : face.face.all())
      has_moved[node] = positions[node] != mesh_.nodes[node] ? 1 : 0;
  const Flags is_touched = regions_at(has_moved);
  if (std::find(is_touched.begin(), is_touched.end(), 1) == is_touched.end())
    return keep_all(mesh_, positions);
  const Touched touched{mesh_, regions_, is_touched};
  check_regions(touched);
  const std::vector<Vec3> places = with_followers(touched, is_rough_, positions);
  const RemeshTask task = make_remesh_task(mesh_, regions_, is_touched, places);
  return Assembly(touched, places).run(task, fill_volumes(task.fill, gmsh_));
}

}  // namespace roughmesh::detail
