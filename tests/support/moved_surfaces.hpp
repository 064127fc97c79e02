// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that move, and their check.
#pragma once

#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/check.hpp"

#include "support/meshes.hpp"
#include "support/only.hpp"

namespace roughmesh::test {

inline std::vector<Vec3> jittered(std::vector<Vec3> nodes, double size, unsigned seed,
                                  const Vec3& along = Vec3::Ones()) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  for (Vec3& x : nodes)
    x += along.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
  return nodes;
}

inline Surface all_of(const Mesh& mesh) { return select_surface(mesh, {.groups = {"all"}}); }

inline SurfaceCheck check(const Mesh& mesh, std::span<const Vec3> moved) {
  const Surface surface = all_of(mesh);
  return check_surface(mesh, test::only(surface), moved);
}

inline SurfaceCheck check(const Mesh& mesh, const std::string& group, std::span<const Vec3> moved) {
  const Surface surface = select_surface(mesh, {.groups = {group}});
  return check_surface(mesh, test::only(surface), moved);
}

inline Mesh joined(Mesh a, const Mesh& b) {
  const Index first = a.n_nodes();
  a.nodes.insert(a.nodes.end(), b.nodes.begin(), b.nodes.end());
  for (ElementBlock block : b.blocks) {
    for (Index& node : block.nodes) node += first;
    for (Tag& tag : block.tags) tag += 50'000;
    a.blocks.push_back(std::move(block));
  }
  test::number_nodes(a);
  return a;
}

inline Mesh moved_by(Mesh mesh, const Vec3& shift) {
  for (Vec3& x : mesh.nodes) x += shift;
  return mesh;
}

// Two plates of one unit, the second above the first.
inline Mesh two_plates(int divisions, double distance) {
  return joined(test::plate(divisions), moved_by(test::plate(divisions), {0, 0, distance}));
}

}  // namespace roughmesh::test
