// SPDX-License-Identifier: BSD-3-Clause
// Stages of a volume mesh of 660,000 tetrahedra, each beside a reference of the same run: one
// product of the stiffness matrix with a vector, which moves the same memory as one iteration of
// conjugate gradients. Three components are solved for, so that n iterations cost about 3 n
// products on one thread.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"

#include "harmonic.hpp"
#include "support/cells.hpp"

namespace {

using namespace roughmesh;

template <class Work>
double seconds(const Work& work) {
  constexpr int repetitions = 3;
  double best = INFINITY;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count());
  }
  return best;
}

// A box whose tetrahedra have volumes and shapes as uneven as those of a mesh generator.
Mesh uneven_box(int divisions) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, divisions);
  std::erase_if(mesh.blocks, [](const ElementBlock& b) {
    return b.physical_groups == std::vector<Tag>{2} && b.type == test::triangle_type;
  });
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.2 / divisions, 0.2 / divisions);
  for (Vec3& x : mesh.nodes) {
    const Vec3 shift(uniform(random), uniform(random), uniform(random));
    if (x.minCoeff() > 0 && x.maxCoeff() < 1 && x.z() != 0.5) x += shift;
  }
  return mesh;
}

// The system the mover assembles, rebuilt from what is known about this mesh.
detail::HarmonicExtension rebuild(const Mesh& mesh, const Surface& surface) {
  detail::NodeRoles roles;
  roles.given.assign(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    roles.given[surface.nodes[i]] = surface.point_of_node[i];
  roles.n_given = surface.n_points();
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    const Vec3& x = mesh.nodes[node];
    const bool on_box = x.minCoeff() == 0 || x.maxCoeff() == 1;
    roles.unknown.push_back(on_box || roles.given[node] >= 0 ? -1 : roles.n_unknown++);
  }
  std::vector<detail::Simplex> tetrahedra;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; block.type == test::tetrahedron_type && e < block.size(); ++e) {
      const auto t = block.element(e);
      tetrahedra.push_back({t[0], t[1], t[2], t[3]});
    }
  return {mesh.nodes, tetrahedra, roles};
}

double product_seconds(const detail::ExtensionSystem::Matrix& stiffness) {
  constexpr int products = 20;
  Eigen::VectorXd x = Eigen::VectorXd::Ones(stiffness.cols()), y = x;
  return seconds([&] {
           for (int i = 0; i < products; ++i) {
             y.noalias() = stiffness * x;
             x.swap(y);
             x /= x.lpNorm<Eigen::Infinity>();
           }
         }) /
         products;
}

void print(const char* stage, double time, double product) {
  fmt::print("{:<28} {:.3f} s = {:5.0f} products\n", stage, time, time / product);
}

}  // namespace

int main() {
  constexpr int divisions = 48;
  const Mesh mesh = uneven_box(divisions);
  const SurfaceOptions options{.groups = {"middle"}};
  const Surface surface = select_surface(mesh, options);
  std::vector<double> heights;
  for (const Vec3& x : surface.points)
    heights.push_back(0.5 / divisions * std::sin(40 * x.x()) * std::cos(40 * x.y()));
  const std::span surfaces(&surface, 1);
  const std::vector<Vec3> displacements = displace_nodes(surfaces, {&heights, 1});
  const VolumeMover mover(mesh, surfaces);
  const std::vector<Vec3> moved = mover.move(displacements).nodes;

  const detail::HarmonicExtension extension = rebuild(mesh, surface);
  const auto& stiffness = extension.stiffness();
  const double product = product_seconds(stiffness);
  constexpr double bytes_per_entry = sizeof(double) + sizeof(Index);
  fmt::print("{} tetrahedra, {} unknowns, {} entries, {} cores\n", n_elements(mesh, 3),
             stiffness.rows(), stiffness.nonZeros(), std::thread::hardware_concurrency());
  fmt::print("one product (reference): {:.2f} ms, {:.1f} GB/s\n", product * 1e3,
             static_cast<double>(stiffness.nonZeros()) * bytes_per_entry / product * 1e-9);
  print("select_surface", seconds([&] { select_surface(mesh, options); }), product);
  print("VolumeMover, constructor", seconds([&] { const VolumeMover again(mesh, surfaces); }),
        product);
  print("VolumeMover::move", seconds([&] { mover.move(displacements); }), product);
  print("check_mesh", seconds([&] { check_mesh(mesh, moved); }), product);

  const Mesh sphere = test::icosphere(8);
  const Surface fine = select_surface(sphere);
  const double time = seconds([&] { select_surface(sphere); });
  fmt::print("select_surface of {} faces: {:.3f} s, {:.2f} million faces a second\n",
             fine.n_faces(), time, static_cast<double>(fine.n_faces()) / time * 1e-6);
}
