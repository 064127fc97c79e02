// SPDX-License-Identifier: BSD-3-Clause
// A rough sphere in a box: what the volume stage makes of its elements, by roughness, and what it
// costs beside the harmonic extension alone. Rq is in mean edges h of the sphere, Gaussian
// correlation with l = 1.77 h.
//
//     bench_untangle MESH... [--seeds N]      meshes of sphere_in_box.geo
#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/move_volume.hpp"

namespace {

using namespace roughmesh;

constexpr std::array ratios = {0.3, 0.5, 0.7, 1.0, 1.3};  // Rq / h

double mean_edge(const Surface& surface) {
  double sum = 0;
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const Index begin = surface.face_offsets[f], end = surface.face_offsets[f + 1];
    for (Index k = begin; k < end; ++k)
      sum += (surface.points[surface.face_points[k]] -
              surface.points[surface.face_points[k + 1 < end ? k + 1 : begin]])
                 .norm();
  }
  return sum / static_cast<double>(surface.face_points.size());
}

// Of one roughness, a number per seed.
struct Outcomes {
  std::vector<double> qualities, seconds;
  int n_invalid = 0;
  std::array<int, 4> n_of_method{};

  void add(const Mesh& mesh, const VolumeMover& mover, std::span<const Vec3> displacements) {
    const auto start = std::chrono::steady_clock::now();
    const MovedVolume moved = mover.move(displacements);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    const MeshCheck check = check_mesh(moved.split ? *moved.split : mesh, moved.nodes);
    qualities.push_back(check.min_quality);
    seconds.push_back(time.count());
    n_invalid += check.valid() ? 0 : 1;
    ++n_of_method[static_cast<std::size_t>(moved.method)];
  }
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

void measure(const Mesh& mesh, int n_seeds) {
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const std::span surfaces(&surface, 1);
  const double h = mean_edge(surface);
  const Autocorrelation gaussian({.family = Family::gaussian, .length = 1.77 * h});
  const FieldSampler sampler(Correlation(surface.points, gaussian, Distance::euclidean()), {});
  const VolumeMover harmonic(mesh, surfaces, VolumeMethod::harmonic), full(mesh, surfaces);
  fmt::print("{} tetrahedra, {} faces, smallest scaled Jacobian {:.3f}\n", n_elements(mesh, 3),
             surface.n_faces(), min_quality(mesh));
  fmt::print(
      "Rq/h | harmonic: quality, invalid, s | all stages: quality, least, invalid, s, most s "
      "| by harmonic, map, split\n");
  for (const double ratio : ratios) {
    Outcomes first, all;
    for (int seed = 0; seed < n_seeds; ++seed) {
      std::vector<double> heights = sampler.heights(static_cast<std::uint64_t>(seed), 0);
      for (double& z : heights) z *= ratio * h;
      const std::vector<Vec3> displacements = displace_nodes(surfaces, {&heights, 1});
      first.add(mesh, harmonic, displacements);
      all.add(mesh, full, displacements);
    }
    fmt::print(
        "{:4.1f} | {:7.3f} {:3d} {:6.2f} | {:6.3f} {:6.3f} {:3d} {:6.2f} {:6.2f} | {} {} {}\n",
        ratio, median(first.qualities), first.n_invalid, median(first.seconds),
        median(all.qualities), *std::min_element(all.qualities.begin(), all.qualities.end()),
        all.n_invalid, median(all.seconds),
        *std::max_element(all.seconds.begin(), all.seconds.end()), all.n_of_method[1],
        all.n_of_method[2], all.n_of_method[3]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app;
  std::vector<std::string> paths;
  int n_seeds = 10;
  app.add_option("meshes", paths)->required();
  app.add_option("--seeds", n_seeds);
  CLI11_PARSE(app, argc, argv);
  for (const std::string& path : paths) measure(read_mesh(path), n_seeds);
}
