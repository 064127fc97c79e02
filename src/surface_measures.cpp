// SPDX-License-Identifier: BSD-3-Clause
#include "surface_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "corner_normals.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "polygon.hpp"

namespace roughmesh::detail {
namespace {

// A sum of vectors that has lost twelve digits to cancellation has no direction worth using.
constexpr double least_sum = 1e-12;
// Area over the square of the longest edge below which a face counts as having none.
constexpr double least_area = 1e-14;

// A sum of vectors and of their lengths.
struct VectorSum {
  Vec3 sum = Vec3::Zero();
  double magnitude = 0;

  void add(const Vec3& v) {
    sum += v;
    magnitude += v.norm();
  }
  void add(const VectorSum& more) {
    sum += more.sum;
    magnitude += more.magnitude;
  }
  bool has_direction() const { return sum.norm() > least_sum * magnitude; }
};

constexpr std::size_t grain = 4096;

Vec3 vector_of_face(const Surface& surface, Index face) {
  return face_vector(gather(surface.face(face), surface.points).span(), surface.plane_normal);
}

std::vector<double> face_areas(const Surface& surface) {
  std::vector<double> areas(surface.face_tags.size());
  parallel_for(areas.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      areas[f] = face_area(gather(surface.face(static_cast<Index>(f)), surface.points).span());
  });
  return areas;
}

// Normal of each line over its length (docs/math.md, eq. 35).
std::vector<VectorSum> curve_sums(const Surface& surface) {
  std::vector<VectorSum> sums(surface.points.size());
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const Vec3 normal = vector_of_face(surface, f);
    const double square = normal.squaredNorm();
    if (!(square > 0)) continue;
    for (const Index point : surface.face(f)) sums[point].add(normal / square);
  }
  return sums;
}

VectorSum max_normal(const Surface& surface, std::span<const Index> face, std::size_t corner) {
  const std::size_t n = face.size();
  const Vec3& x = surface.points[face[corner]];
  VectorSum normal;
  normal.add(corner_normal(surface.points[face[(corner + 1) % n]] - x,
                           surface.points[face[(corner + n - 1) % n]] - x));
  return normal;
}

// Faces in portions: the normals of their corners on several threads, then the sums in the order of
// the faces, so that they are the same on any number of threads.
std::vector<VectorSum> max_sums(const Surface& surface) {
  constexpr std::size_t portion = 1 << 15;
  std::vector<VectorSum> sums(surface.points.size());
  std::vector<VectorSum> corners;
  for (std::size_t first = 0; first < surface.face_tags.size(); first += portion) {
    const std::size_t n_faces = std::min(portion, surface.face_tags.size() - first);
    const auto offsets = std::span(surface.face_offsets).subspan(first, n_faces + 1);
    const auto points =
        std::span(surface.face_points).subspan(offsets.front(), offsets.back() - offsets.front());
    corners.resize(points.size());
    parallel_for(n_faces, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        const auto face = surface.face(static_cast<Index>(first + f));
        for (std::size_t k = 0; k < face.size(); ++k)
          corners[offsets[f] - offsets.front() + k] = max_normal(surface, face, k);
      }
    });
    for (std::size_t k = 0; k < points.size(); ++k) sums[points[k]].add(corners[k]);
  }
  return sums;
}

std::vector<VectorSum> area_sums(const Surface& surface) {
  std::vector<VectorSum> sums(surface.points.size());
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const Vec3 vector = vector_of_face(surface, f);
    for (const Index point : surface.face(f)) sums[point].add(vector);
  }
  return sums;
}

[[noreturn]] void refuse_point(const Mesh& mesh, const Surface& surface, Index point) {
  const auto at = std::find(surface.point_of_node.begin(), surface.point_of_node.end(), point);
  const Index node = surface.nodes[at - surface.point_of_node.begin()];
  throw InputError(
      fmt::format("node {} at {} has no normal: its {} or cancel each other; mend the mesh there",
                  mesh.node_tags[node], place(surface.points[point]),
                  surface.dimension == 1 ? "lines have no length" : "faces have no area"));
}

// What the points of each group have together, at each of them.
std::vector<VectorSum> shared_sums(const std::vector<VectorSum>& own,
                                   std::span<const Index> sharer) {
  std::vector<VectorSum> sums(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) sums[sharer[i]].add(own[i]);
  for (std::size_t i = 0; i < own.size(); ++i)
    if (sharer[i] != static_cast<Index>(i)) sums[i] = sums[sharer[i]];
  return sums;
}

std::vector<Index> everyone_alone(const Surface& surface) {
  std::vector<Index> sharer(surface.points.size());
  std::iota(sharer.begin(), sharer.end(), Index{0});
  return sharer;
}

// Directions of the weighted sums, of the plain sums where those have none; refuse(point) throws
// where neither has.
template <class Refuse>
void set_normals(Surface& surface, std::span<const Index> sharer, Refuse&& refuse) {
  const std::vector<VectorSum> sums =
      shared_sums(surface.dimension == 1 ? curve_sums(surface) : max_sums(surface), sharer);
  std::vector<VectorSum> fallback;
  for (Index point = 0; point < surface.n_points(); ++point) {
    const VectorSum* sum = &sums[point];
    if (!sum->has_direction()) {
      if (fallback.empty()) fallback = shared_sums(area_sums(surface), sharer);
      sum = &fallback[point];
    }
    if (!sum->has_direction()) refuse(point);
    surface.normals[point] = sum->sum / sum->sum.norm();
  }
}

double longest_edge(const Corners& corners) {
  double longest = 0;
  for (std::size_t k = 0; k < corners.n; ++k)
    longest = std::max(
        longest, (corners.positions[(k + 1) % corners.n] - corners.positions[k]).squaredNorm());
  return std::sqrt(longest);
}

std::vector<Vec3> face_vectors(const Surface& surface) {
  std::vector<Vec3> vectors(surface.face_tags.size());
  parallel_for(vectors.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      vectors[f] = sound_face_vector(gather(surface.face(static_cast<Index>(f)), surface.points),
                                     surface.plane_normal);
  });
  return vectors;
}

std::vector<double> edge_lengths(const EdgeTable& edges, const Surface& surface) {
  if (surface.dimension == 1) return face_areas(surface);
  std::vector<double> lengths(edges.points.size());
  parallel_for(lengths.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto& [a, b] = edges.points[e];
      lengths[e] = (surface.points[b] - surface.points[a]).norm();
    }
  });
  return lengths;
}

MeshSize mesh_size(std::vector<double> lengths) {
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return {*std::min_element(lengths.begin(), middle + 1), *middle,
          *std::max_element(middle, lengths.end())};
}

struct SpecialEdges {
  std::vector<std::array<Index, 2>> border;
  Index n_nonmanifold = 0, n_sharp = 0;
};

SpecialEdges find_special_edges(const EdgeTable& edges, std::span<const Vec3> vectors,
                                double sharp_angle, std::size_t begin, std::size_t end) {
  SpecialEdges special;
  for (std::size_t e = begin; e < end; ++e) {
    const auto sides = edges.edge(static_cast<Index>(e));
    if (sides.size() == 1) special.border.push_back(edges.points[e]);
    special.n_nonmanifold += sides.size() > 2;
    special.n_sharp +=
        sides.size() == 2 && is_sharp(vectors[sides[0].face], vectors[sides[1].face], sharp_angle);
  }
  return special;
}

}  // namespace

Vec3 sound_face_vector(const Corners& corners, const Vec3& plane_normal) {
  const Vec3 vector = face_vector(corners.span(), plane_normal);
  const double longest = longest_edge(corners);
  const double least = corners.n == 2 ? 0 : least_area * longest * longest;
  return vector.norm() > least ? vector : Vec3::Zero();
}

bool is_sharp(const Vec3& a, const Vec3& b, double sharp_angle) {
  if (a.isZero(0) || b.isZero(0)) return false;
  const double sine = a.cross(b).norm(), cosine = a.dot(b);
  if (sine < sharp_angle / 2 * cosine) return false;  // most edges: an angle is below its tangent
  return std::atan2(sine, cosine) > sharp_angle;
}

void measure_areas(Surface& surface) {
  const std::vector<double> of_faces = face_areas(surface);
  surface.areas.assign(surface.points.size(), 0);
  surface.area = 0;
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    surface.area += of_faces[f];
    for (const Index point : face)
      surface.areas[point] += of_faces[f] / static_cast<double>(face.size());
  }
}

void measure_normals(const Mesh& mesh, Surface& surface) {
  surface.normals.resize(surface.points.size());
  set_normals(surface, everyone_alone(surface),
              [&](Index point) { refuse_point(mesh, surface, point); });
}

void measure_shared_normals(Surface& surface, std::span<const Index> sharer) {
  set_normals(surface, sharer, [&](Index point) {
    throw InputError(
        fmt::format("the faces at {} and at its periodic images cancel each other: no normal is "
                    "common to them; choose the faces of one side",
                    place(surface.points[point])));
  });
}

void measure_edges(const EdgeTable& edges, double sharp_angle, Surface& surface) {
  const std::vector<Vec3> vectors = face_vectors(surface);
  const auto n = static_cast<std::size_t>(edges.size());
  std::vector<SpecialEdges> parts((n + grain - 1) / grain);
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    parts[begin / grain] = find_special_edges(edges, vectors, sharp_angle, begin, end);
  });
  for (const SpecialEdges& part : parts) {
    surface.border_edges.insert(surface.border_edges.end(), part.border.begin(), part.border.end());
    surface.n_nonmanifold_edges += part.n_nonmanifold;
    surface.n_sharp_edges += part.n_sharp;
  }
  surface.n_border_edges = static_cast<Index>(surface.border_edges.size());
  surface.mesh_size = mesh_size(edge_lengths(edges, surface));
}

}  // namespace roughmesh::detail
