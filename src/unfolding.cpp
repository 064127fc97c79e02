// SPDX-License-Identifier: BSD-3-Clause
#include "unfolding.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <utility>

#include "foldover_free.hpp"
#include "parallel.hpp"
#include "polygon.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::array layers_of_rounds = {4, 12};
// Below this part of the square of its longest edge the area of a face is round-off.
constexpr double no_area = 1e-14;

bool is_turned(const Corners& before, const Corners& after) {
  double longest = 0;
  for (std::size_t k = 0; k < before.n; ++k)
    longest =
        std::max(longest, (before.positions[(k + 1) % before.n] - before.positions[k]).norm());
  const Vec3 vector = area_vector(before.span());
  return vector.norm() > no_area * longest * longest &&
         !(vector.dot(area_vector(after.span())) > 0);
}

Corners moved(Corners corners, std::span<const Index> face, std::span<const Vec3> displacements) {
  for (std::size_t k = 0; k < face.size(); ++k) corners.positions[k] += displacements[face[k]];
  return corners;
}

// Of a quadrangle the triangles at its corners (docs/math.md, eq. 37). Flat ones cannot be
// unfolded.
std::vector<Simplex> triangles_of(const FaceView& faces, std::span<const Vec3> positions) {
  std::vector<Simplex> triangles;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto corners = faces.face(f);
    const std::size_t n = corners.size();
    for (std::size_t k = 0; k < (n == 3 ? 1 : n); ++k)
      triangles.push_back({corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n], -1});
  }
  std::erase_if(triangles, [&](const Simplex& t) { return is_flat(positions, t); });
  return triangles;
}

bool is_turned(const Simplex& triangle, std::span<const Vec3> positions,
               std::span<const Vec3> displacements) {
  const auto corners = std::span(triangle).first(3);
  const Corners before = gather(corners, positions);
  return is_turned(before, moved(before, corners, displacements));
}

std::vector<Simplex> turned(std::span<const Simplex> triangles, std::span<const Vec3> positions,
                            std::span<const Vec3> displacements) {
  std::vector<Simplex> result;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(result),
               [&](const Simplex& t) { return is_turned(t, positions, displacements); });
  return result;
}

// Vertices of some triangles, and those within some layers of all around them.
NodeFlags near(std::span<const Simplex> some, std::span<const Simplex> triangles,
               std::size_t n_vertices, int n_layers) {
  NodeFlags is_near(n_vertices, 0);
  const auto mark = [&](const Simplex& t, NodeFlags& flags) {
    for (std::size_t k = 0; k < 3; ++k) flags[t[k]] = 1;
  };
  for (const Simplex& t : some) mark(t, is_near);
  for (int layer = 0; layer < n_layers; ++layer) {
    NodeFlags next = is_near;
    for (const Simplex& t : triangles)
      if (is_near[t[0]] != 0 || is_near[t[1]] != 0 || is_near[t[2]] != 0) mark(t, next);
    is_near = std::move(next);
  }
  return is_near;
}

std::vector<Vec3> sum(std::span<const Vec3> a, std::span<const Vec3> b) {
  std::vector<Vec3> result(a.begin(), a.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += b[i];
  return result;
}

}  // namespace

bool has_turned_face(const FaceView& faces, std::span<const Vec3> positions,
                     std::span<const Vec3> displacements) {
  std::atomic<bool> found = false;
  parallel_for(static_cast<std::size_t>(faces.size()), 4096,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t f = begin; f < end && !found; ++f) {
                   const auto face = faces.face(static_cast<Index>(f));
                   const Corners before = gather(face, positions);
                   if (is_turned(before, moved(before, face, displacements))) found = true;
                 }
               });
  return found;
}

void unfold(const SlidingSurface& surface, std::vector<Vec3>& displacements) {
  const std::vector<Simplex> triangles = triangles_of(surface.faces, surface.positions);
  const Simplices simplices{.rest = surface.positions,
                            .all = triangles,
                            .ties = {.sliding = surface.across, .images = {}}};
  std::vector<Simplex> left = turned(triangles, surface.positions, displacements);
  for (const int n_layers : layers_of_rounds) {
    if (left.empty()) return;
    NodeFlags is_free = near(left, triangles, surface.positions.size(), n_layers);
    for (std::size_t v = 0; v < is_free.size(); ++v) is_free[v] &= surface.can_slide[v];
    const std::vector<Vec3> before = sum(surface.positions, displacements);
    std::vector<Vec3> places = before, slid = displacements;
    untangle(simplices, is_free, places);
    for (std::size_t v = 0; v < slid.size(); ++v) slid[v] += places[v] - before[v];
    std::vector<Simplex> still = turned(triangles, surface.positions, slid);
    if (still.size() >= left.size()) continue;
    left = std::move(still);
    displacements = std::move(slid);
  }
}

}  // namespace roughmesh::detail
