// SPDX-License-Identifier: BSD-3-Clause
#include "simplex.hpp"

#include <algorithm>

namespace roughmesh::detail {
namespace {

bool stands_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// Measured from the nearer end beyond the ends, so that nothing is lost there to round-off.
double squared_distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 ab = b - a, ax = x - a;
  const double along = ax.dot(ab), square = ab.squaredNorm();
  if (along <= 0) return ax.squaredNorm();
  if (along >= square) return (x - b).squaredNorm();
  return (ax - (along / square) * ab).squaredNorm();
}

// The sides decide unless x is above the inside: barycentric coordinates of its foot, times n^2.
double squared_distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const double to_sides =
      std::min({squared_distance_to_segment(a, b, x), squared_distance_to_segment(b, c, x),
                squared_distance_to_segment(a, c, x)});
  const Vec3 ab = b - a, ac = c - a, ax = x - a, n = ab.cross(ac);
  const double square = n.squaredNorm();
  const double of_b = n.dot(ax.cross(ac)), of_c = n.dot(ab.cross(ax));
  if (!(square > 0) || of_b < 0 || of_c < 0 || of_b + of_c > square) return to_sides;
  const double height = n.dot(ax);
  return std::min(to_sides, height * height / square);
}

void append_polygon(std::span<const Vec3> x, std::vector<PlacedSimplex>& simplices) {
  const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
    simplices.emplace_back(std::array{x[a], x[b], x[c]});
  };
  triangle(0, 1, 2);
  if (x.size() < 4) return;
  triangle(0, 2, 3);
  triangle(0, 1, 3);
  triangle(1, 2, 3);
}

}  // namespace

PlacedSimplex::PlacedSimplex(std::span<const Vec3> positions)
    : n_vertices(static_cast<int>(positions.size())) {
  vertices.fill(positions.front());
  std::copy(positions.begin(), positions.end(), vertices.begin());
  std::sort(vertices.begin(), vertices.begin() + n_vertices, stands_before);
}

Eigen::AlignedBox3d PlacedSimplex::bounds() const {
  Eigen::AlignedBox3d box(vertices.front());
  for (const Vec3& vertex : vertices) box.extend(vertex);
  return box;
}

bool operator<(const PlacedSimplex& a, const PlacedSimplex& b) {
  if (a.n_vertices != b.n_vertices) return a.n_vertices < b.n_vertices;
  return std::lexicographical_compare(a.vertices.begin(), a.vertices.end(), b.vertices.begin(),
                                      b.vertices.end(), stands_before);
}

bool operator==(const PlacedSimplex& a, const PlacedSimplex& b) { return !(a < b) && !(b < a); }

double squared_distance(const PlacedSimplex& simplex, const Vec3& x) {
  const auto& [a, b, c] = simplex.vertices;
  if (simplex.n_vertices == 1) return (x - a).squaredNorm();
  if (simplex.n_vertices == 2) return squared_distance_to_segment(a, b, x);
  return squared_distance_to_triangle(a, b, c, x);
}

void append_simplices(ElementShape shape, std::span<const Vec3> corners,
                      std::vector<PlacedSimplex>& simplices) {
  if (dimension(shape) < 2) simplices.emplace_back(corners);
  if (dimension(shape) == 2) append_polygon(corners, simplices);
  if (dimension(shape) < 3) return;
  for (const std::vector<int>& face : local_faces(shape)) {
    std::array<Vec3, 4> of_face;
    for (std::size_t k = 0; k < face.size(); ++k) of_face[k] = corners[face[k]];
    append_polygon(std::span(of_face).first(face.size()), simplices);
  }
}

}  // namespace roughmesh::detail
