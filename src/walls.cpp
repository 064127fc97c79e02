// SPDX-License-Identifier: BSD-3-Clause
#include "walls.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "element_nodes.hpp"
#include "messages.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"

namespace roughmesh::detail {
namespace {

// Facets of one surface by the nodes of their corners.
class FacetsOfSurface {
 public:
  explicit FacetsOfSurface(const Surface& surface)
      : surface_(surface), lookup_(surface.face_offsets, surface.face_points) {}

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
    const auto at = std::lower_bound(surface_.nodes.begin(), surface_.nodes.end(), node);
    if (at == surface_.nodes.end() || *at != node) return -1;
    return surface_.point_of_node[at - surface_.nodes.begin()];
  }

  const Surface& surface_;
  FaceLookup lookup_;
};

// Marks the nodes of faces that are part of no surface: they belong to walls, which stay.
class WallMarker {
 public:
  WallMarker(const Mesh& mesh, std::span<const Surface> surfaces)
      : mesh_(mesh),
        facets_(surfaces.begin(), surfaces.end()),
        moves_(mesh.nodes.size(), 0),
        on_wall_(mesh.nodes.size(), 0) {
    for (const Surface& surface : surfaces)
      for (const Index node : surface.nodes) moves_[node] = 1;
  }

  void add(const ElementType& type, std::span<const Index> nodes, Tag tag) {
    const auto& parts = facets(type);
    const bool is_selected = std::all_of(parts.begin(), parts.end(), [&](const auto& facet) {
      return is_facet_selected(facet, nodes, tag);
    });
    if (is_selected) return;
    for (const Index node : nodes) on_wall_[node] = 1;
  }
  std::vector<std::uint8_t> take() { return std::move(on_wall_); }

 private:
  bool is_facet_selected(std::span<const int> facet, std::span<const Index> nodes, Tag tag) const {
    std::array<Index, 4> corners{};
    for (std::size_t k = 0; k < facet.size(); ++k) {
      corners[k] = nodes[facet[k]];
      if (!moves_[corners[k]]) return false;
    }
    const auto n = std::count_if(facets_.begin(), facets_.end(), [&](const auto& facets) {
      return facets.contains({corners.data(), facet.size()});
    });
    if (n > 1) refuse_overlap(tag, mesh_.nodes[corners[0]]);
    return n == 1;
  }

  [[noreturn]] static void refuse_overlap(Tag tag, const Vec3& x) {
    throw InputError(fmt::format(
        "{} at {} is in two rough surfaces; choose groups that have no element in common",
        tag > 0 ? fmt::format("element {}", tag) : "a face of the boundary", place(x)));
  }

  const Mesh& mesh_;
  std::vector<FacetsOfSurface> facets_;
  std::vector<std::uint8_t> moves_, on_wall_;
};

}  // namespace

std::vector<std::uint8_t> wall_nodes(const Mesh& mesh, std::span<const Surface> surfaces) {
  const int face_dimension = surfaces.front().dimension;
  WallMarker walls(mesh, surfaces);
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) == face_dimension && e < block.size(); ++e)
      walls.add(block.type, block.element(e), block.tags[e]);
  for (const CellFace& face : boundary_faces(mesh, face_dimension + 1))
    walls.add(face.type, face.all(), 0);
  return walls.take();
}

}  // namespace roughmesh::detail
