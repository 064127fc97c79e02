// SPDX-License-Identifier: BSD-3-Clause
// The check of a rough surface before anything follows it. The bar: 1.3 million triangles in 2.5 s
// on one core, on a sphere with l = 2.5 h.
#include <chrono>
#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"

#include "checked_faces.hpp"
#include "parallel.hpp"
#include "self_intersection.hpp"
#include "support/meshes.hpp"
#include "surface_motion.hpp"

namespace {

using namespace roughmesh;

struct Times {
  double wall = INFINITY, processor = INFINITY;  // the latter over all threads
};

template <class Work>
Times seconds(const Work& work) {
  constexpr int repetitions = 3;
  Times best;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t clock = std::clock();
    work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best.processor =
        std::min(best.processor, static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC);
    best.wall = std::min(best.wall, time.count());
  }
  return best;
}

std::vector<double> unit_heights(const Surface& surface, double length) {
  const Autocorrelation gaussian({.family = Family::gaussian, .length = length});
  const Correlation correlation(surface.points, gaussian, Distance::euclidean());
  return FieldSampler(correlation).heights(0, 0);
}

std::vector<Vec3> rough_nodes(const Mesh& mesh, const Surface& surface,
                              std::span<const double> heights, double rq) {
  std::vector<Vec3> nodes = mesh.nodes;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
    const Index point = surface.point_of_node[i];
    nodes[surface.nodes[i]] += rq * heights[point] * surface.normals[point];
  }
  return nodes;
}

// Pairs of triangles whose boxes overlap: what it takes to visit them, and no more.
void print_reference(const detail::CheckedFaces& faces) {
  const std::vector<std::uint8_t> all(faces.before.size(), 1);
  std::int64_t n_pairs = 0;
  const Times time = seconds([&] {
    n_pairs = 0;
    const detail::TriangleTree tree(faces.facets, faces.before, all);
    for (const auto& task : tree.tasks())
      tree.for_each_pair(task, [&](std::size_t, std::size_t) { return ++n_pairs > 0; });
  });
  fmt::print("boxes alone (reference, one thread): {:.3f} s, {:.1f} million pairs a second\n",
             time.processor, static_cast<double>(n_pairs) / time.processor * 1e-6);
}

void print_row(const char* stage, const Times& time, std::size_t n) {
  fmt::print("  {:<34} {:.3f} s, processor {:.3f} s, {:.2f} million triangles a second of it\n",
             stage, time.wall, time.processor, static_cast<double>(n) / time.processor * 1e-6);
}

void measure(const Mesh& mesh, const Surface& surface, std::span<const Vec3> moved) {
  const std::span surfaces(&surface, 1);
  const SurfaceChecker checker(mesh, surfaces);
  const std::size_t n = surface.face_tags.size();
  const detail::FacesAtRest rest{detail::collect_faces(mesh, 2)};
  const detail::SurfaceMotion motion = detail::move_faces(rest, moved);
  print_row("SurfaceChecker, constructor",
            seconds([&] { const SurfaceChecker again(mesh, surfaces); }), n);
  print_row("  of which collect_faces", seconds([&] { detail::collect_faces(mesh, 2); }), n);
  print_row("SurfaceChecker::check", seconds([&] { checker.check(moved); }), n);
  print_row("  of which find_intersections", seconds([&] {
              detail::find_intersections(rest.in_place(), motion.in_place(), motion.has_moved);
            }),
            n);
  print_row("check_surface, all of it", seconds([&] { check_surface(mesh, surfaces, moved); }), n);
  const SurfaceCheck check = checker.check(moved);
  fmt::print("  found: {} intersections, {} folded faces\n", check.self_intersections,
             check.folded_faces);
}

}  // namespace

int main() {
  const Mesh sphere = test::icosphere(8);
  const Surface surface = select_surface(sphere);
  const double h = surface.mesh_size.median;
  const std::vector<double> heights = unit_heights(surface, 2.5 * h);
  fmt::print("{} triangles, l = 2.5 h\n", surface.n_faces());
  {
    const detail::ThreadLimit limit(1);
    print_reference(detail::collect_faces(sphere, 2));
  }
  for (const double rq_over_h : {0.5, 1.0}) {
    const std::vector<Vec3> moved = rough_nodes(sphere, surface, heights, rq_over_h * h);
    for (const int n_threads : {1, 2}) {
      const detail::ThreadLimit limit(n_threads);
      fmt::print("Rq/h = {}, {} threads\n", rq_over_h, n_threads);
      measure(sphere, surface, moved);
    }
  }
}
