// SPDX-License-Identifier: BSD-3-Clause
#include "sectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "disjoint_sets.hpp"
#include "surface_measures.hpp"

namespace roughmesh::detail {
namespace {

EdgeKind kind_of(std::span<const Side> sides, std::span<const EdgeOptions> options,
                 const JoinedSurfaces& joined, std::span<const Vec3> vectors) {
  if (sides.size() == 1) return EdgeKind::border;
  const std::uint32_t surface = joined.surface_of_face[sides[0].face];
  if (sides.size() > 2 || joined.surface_of_face[sides[1].face] != surface) return EdgeKind::sharp;
  return is_sharp(vectors[sides[0].face], vectors[sides[1].face], options[surface].sharp_angle)
             ? EdgeKind::sharp
             : EdgeKind::smooth;
}

std::vector<EdgeKind> kinds_of_edges(std::span<const EdgeOptions> options,
                                     const JoinedSurfaces& joined) {
  const std::vector<Vec3> vectors = sound_vectors(joined);
  std::vector<EdgeKind> kinds;
  kinds.reserve(joined.edges.points.size());
  for (Index e = 0; e < joined.edges.size(); ++e)
    kinds.push_back(kind_of(joined.edges.edge(e), options, joined, vectors));
  return kinds;
}

// Position of a vertex among the corners.
Index corner_at(const JoinedSurfaces& joined, Index face, Index vertex) {
  Index corner = joined.face_offsets[face];
  while (joined.face_corners[corner] != vertex) ++corner;
  return corner;
}

// Corners that are in one sector: at the ends of each smooth edge, those of its two faces.
void unite_across_edges(const JoinedSurfaces& joined, std::span<const EdgeKind> kinds,
                        DisjointSets& corners) {
  for (Index e = 0; e < joined.edges.size(); ++e) {
    if (kinds[e] != EdgeKind::smooth) continue;
    const auto sides = joined.edges.edge(e);
    for (const Index vertex : joined.edges.points[e])
      corners.unite(corner_at(joined, sides[0].face, vertex),
                    corner_at(joined, sides[1].face, vertex));
  }
}

// Where edges make no difference, all corners at a point of a surface.
void unite_at_points(std::span<const EdgeOptions> options, const JoinedSurfaces& joined,
                     DisjointSets& corners) {
  std::vector<std::vector<Index>> first;
  for (const std::vector<Index>& points : joined.vertex_of_point)
    first.emplace_back(points.size(), -1);
  for (Index f = 0; f < joined.n_faces(); ++f) {
    const std::uint32_t surface = joined.surface_of_face[f];
    if (options[surface].rule == EdgeRule::offset) continue;
    for (Index c = joined.face_offsets[f]; c < joined.face_offsets[f + 1]; ++c) {
      Index& corner = first[surface][joined.point_of_corner[c]];
      if (corner < 0) corner = c;
      corners.unite(c, corner);
    }
  }
}

// Weighted by the angle of the face at the corner; a line has the weight 1.
Vec3 weighted_normal(const JoinedSurfaces& joined, Index face, Index corner) {
  const auto vertices = joined.face(face);
  const Vec3 vector = sound_face_vector(gather(vertices, joined.positions), joined.plane_normal);
  if (vector.isZero(0) || joined.dimension == 1) return vector.normalized();
  const std::size_t n = vertices.size();
  const auto k = static_cast<std::size_t>(corner - joined.face_offsets[face]);
  const Vec3& x = joined.positions[vertices[k]];
  const Vec3 a = joined.positions[vertices[(k + 1) % n]] - x;
  const Vec3 b = joined.positions[vertices[(k + n - 1) % n]] - x;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * vector.normalized();
}

// Numbers the sectors by vertex and fills in all but the normals, of which it sums the weighted
// ones.
void collect(const JoinedSurfaces& joined, DisjointSets& corners, Sectors& sectors) {
  std::vector<std::array<Index, 4>> found;  // vertex, surface, point, first corner
  for (Index f = 0; f < joined.n_faces(); ++f)
    for (Index c = joined.face_offsets[f]; c < joined.face_offsets[f + 1]; ++c)
      if (corners.smallest(c) == c)
        found.push_back({joined.face_corners[c], static_cast<Index>(joined.surface_of_face[f]),
                         joined.point_of_corner[c], c});
  std::sort(found.begin(), found.end());
  sectors.sector_of_corner.assign(joined.face_corners.size(), -1);
  sectors.offsets.assign(static_cast<std::size_t>(joined.n_vertices()) + 1, 0);
  for (const auto& [vertex, surface, point, corner] : found) {
    sectors.sector_of_corner[corner] = static_cast<Index>(sectors.all.size());
    ++sectors.offsets[vertex + 1];
    sectors.all.push_back({vertex, static_cast<std::uint32_t>(surface), point, Vec3::Zero()});
  }
  std::partial_sum(sectors.offsets.begin(), sectors.offsets.end(), sectors.offsets.begin());
  for (Index f = 0; f < joined.n_faces(); ++f)
    for (Index c = joined.face_offsets[f]; c < joined.face_offsets[f + 1]; ++c) {
      const Index sector = sectors.sector_of_corner[corners.smallest(c)];
      sectors.sector_of_corner[c] = sector;
      sectors.all[sector].normal += weighted_normal(joined, f, c);
    }
}

// A piece of surface with no edge there keeps the normal that it has without any.
void finish_normals(std::span<const Surface> surfaces, Sectors& sectors) {
  constexpr double least = 1e-9;  // what is left of angles that cancel has no direction
  const auto is_same_point = [](const Sector& a, const Sector& b) {
    return a.vertex == b.vertex && a.surface == b.surface && a.point == b.point;
  };
  for (std::size_t i = 0; i < sectors.all.size(); ++i) {
    Sector& sector = sectors.all[i];
    const bool is_alone =
        (i == 0 || !is_same_point(sectors.all[i - 1], sector)) &&
        (i + 1 == sectors.all.size() || !is_same_point(sectors.all[i + 1], sector));
    if (is_alone || !(sector.normal.norm() > least))
      sector.normal = surfaces[sector.surface].normals[sector.point];
    else
      sector.normal.normalize();
  }
}

}  // namespace

Sectors find_sectors(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                     const JoinedSurfaces& joined) {
  Sectors sectors;
  sectors.kind_of_edge = kinds_of_edges(options, joined);
  DisjointSets corners(joined.face_corners.size());
  unite_across_edges(joined, sectors.kind_of_edge, corners);
  unite_at_points(options, joined, corners);
  collect(joined, corners, sectors);
  finish_normals(surfaces, sectors);
  return sectors;
}

std::vector<std::uint8_t> sharp_points(const Surface& surface, double sharp_angle) {
  const JoinedSurfaces joined = join_surfaces({&surface, 1}, surface.nodes);
  const EdgeOptions options{.rule = EdgeRule::offset, .sharp_angle = sharp_angle, .weights = {}};
  const std::vector<EdgeKind> kinds = kinds_of_edges({&options, 1}, joined);
  std::vector<std::uint8_t> is_sharp_point(surface.points.size(), 0);
  for (Index e = 0; e < joined.edges.size(); ++e)
    if (kinds[e] == EdgeKind::sharp)
      for (const Index point : joined.edges.points[e]) is_sharp_point[point] = 1;
  return is_sharp_point;
}

}  // namespace roughmesh::detail
