// SPDX-License-Identifier: BSD-3-Clause
#include "wall_faces.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "element_nodes.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 4096;

// Facets of one surface by the nodes of their corners.
class FacetsOfSurface {
 public:
  explicit FacetsOfSurface(const Surface& surface)
      : lookup_(surface.face_offsets, surface.face_points) {
    if (surface.nodes.empty()) return;
    first_node_ = surface.nodes.front();
    point_of_node_.assign(static_cast<std::size_t>(surface.nodes.back() - first_node_) + 1, -1);
    for (std::size_t i = 0; i < surface.nodes.size(); ++i)
      point_of_node_[surface.nodes[i] - first_node_] = surface.point_of_node[i];
  }

  bool contains(std::span<const Index> corners) const {
    std::array<Index, 4> points{};
    for (std::size_t k = 0; k < corners.size(); ++k) {
      points[k] = point_of(corners[k]);
      if (points[k] < 0) return false;
    }
    return lookup_.find({points.data(), corners.size()}) >= 0;
  }

 private:
  Index point_of(Index node) const {
    if (node < first_node_) return -1;
    const auto at = static_cast<std::size_t>(node - first_node_);
    return at < point_of_node_.size() ? point_of_node_[at] : -1;
  }

  FaceLookup lookup_;
  Index first_node_ = 0;
  std::vector<Index> point_of_node_;  // from the first node to the last
};

// Marks the nodes of faces that are part of no surface: they belong to walls, which stay.
class WallMarker {
 public:
  WallMarker(const Mesh& mesh, std::span<const Surface> surfaces)
      : mesh_(mesh), facets_(surfaces.begin(), surfaces.end()), on_wall_(mesh.nodes.size(), 0) {}

  /// Returns whether the face is in two surfaces. Called from several threads.
  bool add(const ElementType& type, std::span<const Index> nodes) {
    bool is_selected = true, is_in_two = false;
    for (const std::vector<int>& facet : facets(type)) {
      const auto n = n_surfaces_with(facet, nodes);
      is_selected = is_selected && n > 0;
      is_in_two = is_in_two || n > 1;
    }
    for (std::size_t k = 0; !is_selected && k < nodes.size(); ++k)
      std::atomic_ref(on_wall_[nodes[k]]).store(1, std::memory_order_relaxed);
    return is_in_two;
  }
  void add_block(const ElementBlock& block) {
    std::vector<Index> in_two((block.tags.size() + grain - 1) / grain, -1);
    parallel_for(block.tags.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = end; i-- > begin;) {
        const auto e = static_cast<Index>(i);
        if (add(block.type, block.element(e))) in_two[begin / grain] = e;
      }
    });
    for (const Index e : in_two)
      if (e >= 0)
        refuse_overlap(fmt::format("element {}", block.tags[e]), block.element(e).front());
  }
  void add_boundary_face(const CellFace& face) {
    if (add(face.type, face.all())) refuse_overlap("a face of the boundary", face.all().front());
  }
  std::vector<std::uint8_t> take() { return std::move(on_wall_); }

  bool is_wall(const ElementType& type, std::span<const Index> nodes) const {
    const auto& all = facets(type);
    return std::any_of(all.begin(), all.end(),
                       [&](const auto& facet) { return n_surfaces_with(facet, nodes) == 0; });
  }

 private:
  std::ptrdiff_t n_surfaces_with(std::span<const int> facet, std::span<const Index> nodes) const {
    std::array<Index, 4> corners{};
    for (std::size_t k = 0; k < facet.size(); ++k) corners[k] = nodes[facet[k]];
    return std::count_if(facets_.begin(), facets_.end(), [&](const FacetsOfSurface& facets) {
      return facets.contains({corners.data(), facet.size()});
    });
  }

  [[noreturn]] void refuse_overlap(const std::string& face, Index node) const {
    throw InputError(fmt::format(
        "{} at {} is in two rough surfaces; choose groups that have no element in common", face,
        place(mesh_.nodes[node])));
  }

  const Mesh& mesh_;
  std::vector<FacetsOfSurface> facets_;
  std::vector<std::uint8_t> on_wall_;
};

bool is_face(const Mesh& mesh, const ElementBlock& block, int face_dimension) {
  return dimension(block.type.shape) == face_dimension && !is_between_partitions(mesh, block);
}

CellFace face_of(const ElementBlock& block, Index element) {
  CellFace face{block.type, {}, block.tags[element]};
  if (block.type.order > 2) face.type = {block.type.shape, 1, n_corners(block.type.shape)};
  const auto nodes = block.element(element).first(static_cast<std::size_t>(face.type.n_nodes));
  std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
  return face;
}

// Of faces on the same corners only the first stays, which is an element if one of them is.
void drop_repetitions(std::vector<WallFace>& faces) {
  std::vector<std::pair<FaceKey, std::size_t>> entries;
  entries.reserve(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    entries.emplace_back(face_key(faces[f].face.corners()), f);
  parallel_sort(std::span(entries), std::less<>());
  std::vector<std::uint8_t> is_repeated(faces.size(), 0);
  for (std::size_t i = 1; i < entries.size(); ++i)
    is_repeated[entries[i].second] = entries[i].first == entries[i - 1].first;
  std::size_t n_kept = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (is_repeated[f] == 0) faces[n_kept++] = faces[f];
  faces.resize(n_kept);
}

}  // namespace

bool is_between_partitions(const Mesh& mesh, const ElementBlock& block) {
  return mesh.format == MeshFormat::msh4 && block.entity == 0 && block.physical_groups.empty() &&
         dimension(block.type.shape) < dimension(mesh);
}

std::vector<std::uint8_t> wall_nodes(const Mesh& mesh, std::span<const Surface> surfaces) {
  const int face_dimension = surfaces.front().dimension;
  WallMarker walls(mesh, surfaces);
  for (const ElementBlock& block : mesh.blocks)
    if (is_face(mesh, block, face_dimension)) walls.add_block(block);
  for (const CellFace& face : boundary_faces(mesh, face_dimension + 1))
    walls.add_boundary_face(face);
  return walls.take();
}

std::vector<WallFace> wall_faces(const Mesh& mesh, std::span<const Surface> surfaces) {
  const int face_dimension = surfaces.front().dimension;
  const WallMarker walls(mesh, surfaces);
  std::vector<WallFace> faces;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    for (Index e = 0; is_face(mesh, block, face_dimension) && e < block.size(); ++e) {
      if (!walls.is_wall(block.type, block.element(e))) continue;
      faces.push_back({face_of(block, e), static_cast<Index>(b)});
    }
  }
  for (const CellFace& face : boundary_faces(mesh, face_dimension + 1))
    if (walls.is_wall(face.type, face.all())) faces.push_back({face, -1});
  drop_repetitions(faces);
  return faces;
}

}  // namespace roughmesh::detail
