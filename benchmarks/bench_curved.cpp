// SPDX-License-Identifier: BSD-3-Clause
// A rough sphere in a box of curved tetrahedra: what spreading the offset of mid-side nodes into
// the volume (docs/math.md, eq. 62) is worth, and what it costs. Rq is in mean edges h between
// corners of the sphere, Gaussian correlation with l = 1.77 h. The value is the least Jacobian over
// that of the straight element (eq. 61); in the column "chord" only the surface is curved.
//
//     bench_curved MESH... [--seeds N]     of sphere_in_box.geo with gmsh -order 2
#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
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

#include "curved_quality.hpp"
#include "second_order.hpp"

namespace {

using namespace roughmesh;

constexpr std::array ratios = {0.1, 0.3, 0.5, 0.7};  // Rq / h

double mean_corner_edge(const Mesh& mesh, const Surface& surface) {
  double sum = 0;
  std::size_t n = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != surface.dimension) continue;
    for (Index e = 0; e < block.size(); ++e)
      for (const auto& [a, b] : local_edges(block.type.shape)) {
        sum += (mesh.nodes[block.element(e)[a]] - mesh.nodes[block.element(e)[b]]).norm();
        ++n;
      }
  }
  return sum / static_cast<double>(n);
}

struct Outcome {
  double least = std::numeric_limits<double>::infinity();
  int n_invalid = 0;

  void add(const Outcome& other) {
    least = std::min(least, other.least);
    n_invalid += other.n_invalid;
  }
};

// The least coefficient, without any subdivision.
Outcome curved(const Mesh& mesh, std::span<const Vec3> nodes) {
  Outcome outcome;
  for (const ElementBlock& block : mesh.blocks) {
    const auto* polynomial = detail::JacobianPolynomial::of(block.type);
    if (dimension(block.type.shape) != 3 || polynomial == nullptr) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto element = block.element(e);
      const auto c = detail::jacobian_coefficients(*polynomial, element, nodes, {});
      const double straight = detail::straight_jacobian(block.type.shape, element, nodes, {});
      outcome.least = std::min(outcome.least, *std::min_element(c.begin(), c.end()) / straight);
      outcome.n_invalid += polynomial->least(c).is_positive ? 0 : 1;
    }
  }
  return outcome;
}

// Nodes inside on the middle of their edges.
std::vector<Vec3> on_chords(const Mesh& mesh, const Surface& surface, std::vector<Vec3> nodes) {
  std::vector<std::uint8_t> is_settled(mesh.nodes.size(), 0);
  for (const Index node : surface.nodes) is_settled[node] = 1;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.size(); ++e)
      for (int k = 0; k < n_corners(block.type.shape); ++k) is_settled[block.element(e)[k]] = 1;
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] -= mesh.nodes[i];
  detail::Followers(mesh, 3, is_settled).fill(nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] += mesh.nodes[i];
  return nodes;
}

void measure(const Mesh& mesh, int n_seeds) {
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const std::span surfaces(&surface, 1);
  const double h = mean_corner_edge(mesh, surface);
  const Autocorrelation gaussian({.family = Family::gaussian, .length = 1.77 * h});
  const FieldSampler sampler(Correlation(surface.points, gaussian, Distance::euclidean()), {});
  const VolumeMover harmonic(mesh, surfaces, VolumeMethod::harmonic), full(mesh, surfaces);
  fmt::print("{} tetrahedra, {} faces, h = {:.4f}, least value {:.3f}\n", n_elements(mesh, 3),
             surface.n_elements, h, curved(mesh, mesh.nodes).least);
  fmt::print("Rq/h | chord, invalid | harmonic, invalid | mended, invalid, s, check of all, s\n");
  for (const double ratio : ratios) {
    Outcome chord, spread, mended;
    double seconds = 0, check_seconds = 0;
    for (int seed = 0; seed < n_seeds; ++seed) {
      std::vector<double> heights = sampler.heights(static_cast<std::uint64_t>(seed), 0);
      for (double& z : heights) z *= ratio * h;
      const std::vector<Vec3> displacements = displace_nodes(surfaces, {&heights, 1});
      const std::vector<Vec3> nodes = harmonic.move(displacements).nodes;
      chord.add(curved(mesh, on_chords(mesh, surface, nodes)));
      spread.add(curved(mesh, nodes));
      const auto start = std::chrono::steady_clock::now();
      const MovedVolume moved = full.move(displacements);
      const auto middle = std::chrono::steady_clock::now();
      mended.n_invalid += check_mesh(mesh, moved.nodes).valid() ? 0 : 1;
      const auto end = std::chrono::steady_clock::now();
      mended.least = std::min(mended.least, curved(mesh, moved.nodes).least);
      seconds += std::chrono::duration<double>(middle - start).count() / n_seeds;
      check_seconds += std::chrono::duration<double>(end - middle).count() / n_seeds;
    }
    fmt::print("{:4.1f} | {:6.3f} {:4d} | {:6.3f} {:4d} | {:6.3f} {:3d} {:6.2f} {:6.2f}\n", ratio,
               chord.least, chord.n_invalid, spread.least, spread.n_invalid, mended.least,
               mended.n_invalid, seconds, check_seconds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app;
  std::vector<std::string> paths;
  int n_seeds = 3;
  app.add_option("meshes", paths)->required();
  app.add_option("--seeds", n_seeds);
  CLI11_PARSE(app, argc, argv);
  for (const std::string& path : paths) measure(read_mesh(path), n_seeds);
}
