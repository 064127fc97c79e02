// SPDX-License-Identifier: BSD-3-Clause
#include "surface_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "corner_normals.hpp"
#include "messages.hpp"
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

Vec3 vector_of_face(const Surface& surface, Index face) {
  return face_vector(gather(surface.face(face), surface.points).span(), surface.plane_normal);
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

std::vector<VectorSum> max_sums(const Surface& surface) {
  std::vector<VectorSum> sums(surface.points.size());
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    const std::size_t n = face.size();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3& x = surface.points[face[k]];
      sums[face[k]].add(corner_normal(surface.points[face[(k + 1) % n]] - x,
                                      surface.points[face[(k + n - 1) % n]] - x));
    }
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

// Area vectors; zero where only round-off would decide the direction.
std::vector<Vec3> face_vectors(const Surface& surface) {
  std::vector<Vec3> vectors;
  vectors.reserve(surface.face_tags.size());
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const Corners corners = gather(surface.face(f), surface.points);
    const Vec3 vector = vector_of_face(surface, f);
    const double longest = longest_edge(corners);
    const double least = surface.dimension == 1 ? 0 : least_area * longest * longest;
    vectors.push_back(vector.norm() > least ? vector : Vec3::Zero());
  }
  return vectors;
}

bool is_sharp(const Vec3& a, const Vec3& b, double sharp_angle) {
  if (a.isZero(0) || b.isZero(0)) return false;
  return std::atan2(a.cross(b).norm(), a.dot(b)) > sharp_angle;
}

std::vector<double> edge_lengths(const EdgeTable& edges, const Surface& surface) {
  std::vector<double> lengths;
  if (surface.dimension == 1) {
    for (Index f = 0; f < surface.n_faces(); ++f)
      lengths.push_back(face_area(gather(surface.face(f), surface.points).span()));
    return lengths;
  }
  lengths.reserve(edges.points.size());
  for (const auto& [a, b] : edges.points)
    lengths.push_back((surface.points[b] - surface.points[a]).norm());
  return lengths;
}

MeshSize mesh_size(std::vector<double> lengths) {
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return {*std::min_element(lengths.begin(), middle + 1), *middle,
          *std::max_element(middle, lengths.end())};
}

}  // namespace

void measure_areas(Surface& surface) {
  surface.areas.assign(surface.points.size(), 0);
  surface.area = 0;
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    const double area = face_area(gather(face, surface.points).span());
    surface.area += area;
    for (const Index point : face) surface.areas[point] += area / static_cast<double>(face.size());
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
  for (Index e = 0; e < edges.size(); ++e) {
    const auto sides = edges.edge(e);
    if (sides.size() == 1)
      ++surface.n_border_edges;
    else if (sides.size() > 2)
      ++surface.n_nonmanifold_edges;
    else if (is_sharp(vectors[sides[0].face], vectors[sides[1].face], sharp_angle))
      ++surface.n_sharp_edges;
  }
  surface.mesh_size = mesh_size(edge_lengths(edges, surface));
}

}  // namespace roughmesh::detail
