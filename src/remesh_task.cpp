// SPDX-License-Identifier: BSD-3-Clause
#include "remesh_task.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "disjoint_sets.hpp"

namespace roughmesh::detail {
namespace {

// HXT fills the middle of regions with fewer and larger elements than mesh generators that refine
// everywhere; a little less than the old size gives about as many elements as before.
constexpr double share_of_size = 0.8;

bool is_around(const RegionFace& face, std::span<const std::uint8_t> is_touched) {
  return is_touched[face.regions[0]] != 0 ||
         (face.regions[1] >= 0 && is_touched[face.regions[1]] != 0);
}

std::vector<const RegionFace*> faces_around(const VolumeRegions& regions,
                                            std::span<const std::uint8_t> is_touched) {
  std::vector<const RegionFace*> faces;
  for (const RegionFace& face : regions.faces)
    if (is_around(face, is_touched)) faces.push_back(&face);
  return faces;
}

// Sets of faces between the same regions that are joined by edges: the outside of a shell and its
// inside are two, or gmsh could not tell the shell from what it surrounds.
std::vector<Index> sheet_of_each(const std::vector<const RegionFace*>& faces) {
  using EdgeBetween = std::tuple<Index, Index, std::array<Index, 2>>;
  std::vector<std::pair<EdgeBetween, Index>> edges;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto c = faces[f]->face.corners();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(c[k], c[(k + 1) % 3]);
      edges.emplace_back(EdgeBetween{a, b, faces[f]->regions}, static_cast<Index>(f));
    }
  }
  std::sort(edges.begin(), edges.end());
  DisjointSets sets(faces.size());
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i].first == edges[i - 1].first) sets.unite(edges[i].second, edges[i - 1].second);
  std::vector<Index> sheet(faces.size(), -1);
  Index n_sheets = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Index root = sets.smallest(static_cast<Index>(f));
    if (sheet[root] < 0) sheet[root] = n_sheets++;
    sheet[f] = sheet[root];
  }
  return sheet;
}

// Corners of the faces, ascending, and of each node of the mesh its position among them.
std::vector<Index> number_corners(const std::vector<const RegionFace*>& faces, Index n_nodes,
                                  std::vector<Index>& position) {
  position.assign(static_cast<std::size_t>(n_nodes), -1);
  for (const RegionFace* face : faces)
    for (const Index node : face->face.corners()) position[node] = 0;
  std::vector<Index> corners;
  for (Index node = 0; node < n_nodes; ++node) {
    if (position[node] < 0) continue;
    position[node] = static_cast<Index>(corners.size());
    corners.push_back(node);
  }
  return corners;
}

void add_sheets(const std::vector<const RegionFace*>& faces, const std::vector<Index>& position,
                RemeshTask& task) {
  std::map<Index, Index> volume_of_region;
  for (std::size_t v = 0; v < task.regions.size(); ++v)
    volume_of_region[task.regions[v]] = static_cast<Index>(v);
  const std::vector<Index> sheet_of_face = sheet_of_each(faces);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const RegionFace& face = *faces[f];
    const auto s = static_cast<std::size_t>(sheet_of_face[f]);
    if (s == task.fill.sheets.size()) {  // the first of its sheet
      task.fill.sheets.emplace_back();
      const bool is_inside = face.regions[0] == face.regions[1];
      for (const Index region : face.regions) {
        const auto volume = volume_of_region.find(region);
        if (volume == volume_of_region.end()) continue;
        VolumeToFill& of = task.fill.volumes[volume->second];
        (is_inside ? of.inside : of.boundary).push_back(static_cast<Index>(s));
        if (is_inside) break;
      }
    }
    const auto c = face.face.corners();
    task.fill.sheets[s].triangles.push_back({position[c[0]], position[c[1]], position[c[2]]});
    task.fill.sheets[s].elements.push_back(face.face.element);
  }
}

// Of each node the mean edge of the elements around it, in the mesh before it moved.
SizeLattice sizes_before(const Mesh& mesh, const VolumeRegions& regions,
                         std::span<const std::uint8_t> is_touched) {
  std::vector<double> sums(mesh.nodes.size(), 0);
  std::vector<Index> n_edges(mesh.nodes.size(), 0);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (std::size_t e = 0; e < regions.of_block[b].size(); ++e) {
      if (is_touched[regions.of_block[b][e]] == 0) continue;
      const auto t = mesh.blocks[b].element(static_cast<Index>(e));
      for (const auto& [i, j] : local_edges(ElementShape::tetrahedron))
        for (const Index end : {t[i], t[j]}) {
          sums[end] += (mesh.nodes[t[i]] - mesh.nodes[t[j]]).norm();
          ++n_edges[end];
        }
    }
  std::vector<Vec3> places;
  std::vector<double> sizes;
  for (std::size_t node = 0; node < sums.size(); ++node) {
    if (n_edges[node] == 0) continue;
    places.push_back(mesh.nodes[node]);
    sizes.push_back(share_of_size * sums[node] / n_edges[node]);
  }
  return mean_sizes(places, sizes);
}

}  // namespace

RemeshTask make_remesh_task(const Mesh& mesh, const VolumeRegions& regions,
                            std::span<const std::uint8_t> is_touched,
                            std::span<const Vec3> positions) {
  RemeshTask task;
  for (Index region = 0; region < regions.n_regions; ++region)
    if (is_touched[region] != 0) task.regions.push_back(region);
  task.fill.volumes.resize(task.regions.size());
  const std::vector<const RegionFace*> faces = faces_around(regions, is_touched);
  std::vector<Index> position;
  task.node_of_mesh = number_corners(faces, mesh.n_nodes(), position);
  for (const Index node : task.node_of_mesh) task.fill.nodes.push_back(positions[node]);
  add_sheets(faces, position, task);
  task.fill.sizes = sizes_before(mesh, regions, is_touched);
  return task;
}

}  // namespace roughmesh::detail
