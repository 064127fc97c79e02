// SPDX-License-Identifier: BSD-3-Clause
#include "joined_surfaces.hpp"

#include "disjoint_sets.hpp"
#include "surface_measures.hpp"

namespace roughmesh::detail {
namespace {

// Positions of the nodes of a surface among the moved ones; both are ascending.
std::vector<Index> places_of(const Surface& surface, std::span<const Index> moved) {
  std::vector<Index> places;
  places.reserve(surface.nodes.size());
  auto at = moved.begin();
  for (const Index node : surface.nodes) {
    while (*at != node) ++at;
    places.push_back(static_cast<Index>(at - moved.begin()));
  }
  return places;
}

// For each point of a surface one of its nodes, as a position among the moved ones.
std::vector<Index> node_of_point(const Surface& surface, std::span<const Index> places) {
  std::vector<Index> node(surface.points.size(), -1);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (node[surface.point_of_node[i]] < 0) node[surface.point_of_node[i]] = places[i];
  return node;
}

void number_vertices(std::span<const Surface> surfaces, std::span<const Index> moved,
                     JoinedSurfaces& joined) {
  DisjointSets sets(moved.size());
  std::vector<std::vector<Index>> nodes;  // of the points of each surface
  for (const Surface& surface : surfaces) {
    const std::vector<Index> places = places_of(surface, moved);
    nodes.push_back(node_of_point(surface, places));
    for (std::size_t i = 0; i < places.size(); ++i)
      sets.unite(places[i], nodes.back()[surface.point_of_node[i]]);
  }
  std::vector<Index> vertex_of_class(moved.size(), -1);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    std::vector<Index>& vertices = joined.vertex_of_point.emplace_back();
    for (Index point = 0; point < surfaces[s].n_points(); ++point) {
      Index& vertex = vertex_of_class[sets.smallest(nodes[s][point])];
      if (vertex < 0) {
        vertex = joined.n_vertices();
        joined.positions.push_back(surfaces[s].points[point]);
      }
      vertices.push_back(vertex);
    }
  }
  for (std::size_t i = 0; i < moved.size(); ++i)
    joined.vertex_of_node.push_back(vertex_of_class[sets.smallest(static_cast<Index>(i))]);
}

void add_faces(const Surface& surface, std::uint32_t number, JoinedSurfaces& joined) {
  for (Index f = 0; f < surface.n_faces(); ++f) {
    for (const Index point : surface.face(f)) {
      joined.point_of_corner.push_back(point);
      joined.face_corners.push_back(joined.vertex_of_point[number][point]);
    }
    joined.face_offsets.push_back(static_cast<Index>(joined.face_corners.size()));
    joined.surface_of_face.push_back(number);
  }
}

}  // namespace

JoinedSurfaces join_surfaces(std::span<const Surface> surfaces, std::span<const Index> moved) {
  JoinedSurfaces joined;
  joined.dimension = surfaces.front().dimension;
  joined.plane_normal = surfaces.front().plane_normal;
  number_vertices(surfaces, moved, joined);
  joined.face_offsets.push_back(0);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    add_faces(surfaces[s], static_cast<std::uint32_t>(s), joined);
  joined.edges = make_edges(joined.view(), joined.n_vertices());
  return joined;
}

std::vector<Vec3> sound_vectors(const JoinedSurfaces& joined) {
  std::vector<Vec3> vectors;
  vectors.reserve(joined.surface_of_face.size());
  for (Index f = 0; f < joined.n_faces(); ++f)
    vectors.push_back(
        sound_face_vector(gather(joined.face(f), joined.positions), joined.plane_normal));
  return vectors;
}

}  // namespace roughmesh::detail
