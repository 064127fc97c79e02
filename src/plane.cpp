// SPDX-License-Identifier: BSD-3-Clause
#include "plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace roughmesh::detail {
namespace {

constexpr double flat = 1e-6;  // of the extent: coordinates of six digits still count as a plane

std::vector<Index> nodes_of_elements(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.nodes.size(), 0);
  for (const ElementBlock& block : mesh.blocks)
    if (dimension(block.type.shape) > 0)
      for (const Index node : block.nodes) used[node] = 1;
  std::vector<Index> nodes;
  for (std::size_t node = 0; node < used.size(); ++node)
    if (used[node]) nodes.push_back(static_cast<Index>(node));
  return nodes;
}

bool comes_first(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// The node with the largest measure; of equal ones the first by position.
template <class Measure>
Index farthest(const Mesh& mesh, const std::vector<Index>& nodes, Measure&& measure) {
  Index best = nodes.front();
  double largest = measure(mesh.nodes[best]);
  for (const Index node : nodes) {
    const double value = measure(mesh.nodes[node]);
    if (value < largest) continue;
    if (value == largest && !comes_first(mesh.nodes[node], mesh.nodes[best])) continue;
    best = node;
    largest = value;
  }
  return best;
}

Vec3 with_positive_end(const Vec3& normal) {
  for (int axis = 2; axis >= 0; --axis)
    if (std::abs(normal[axis]) > flat) return normal[axis] < 0 ? Vec3(-normal) : normal;
  return normal;
}

// Normal to a line, as close to the z axis as can be.
Vec3 beside_line(const Vec3& direction) {
  const Vec3 t = direction.normalized();
  return (Vec3::UnitZ() - t.z() * t).normalized();
}

// Through the first node, the one farthest from it and the one farthest from their line.
Vec3 guess_normal(const Mesh& mesh, const std::vector<Index>& nodes, double extent) {
  const Vec3 origin =
      mesh.nodes[*std::min_element(nodes.begin(), nodes.end(), [&](Index a, Index b) {
        return comes_first(mesh.nodes[a], mesh.nodes[b]);
      })];
  const Vec3 along =
      mesh.nodes[farthest(mesh, nodes, [&](const Vec3& x) { return (x - origin).norm(); })] -
      origin;
  const Vec3 t = along.normalized();
  const auto off_line = [&](const Vec3& x) { return t.cross(x - origin).norm(); };
  const Vec3 across = mesh.nodes[farthest(mesh, nodes, off_line)] - origin;
  const Vec3 normal = t.cross(across);
  if (normal.norm() <= flat * extent) return beside_line(along);
  return with_positive_end(normal.normalized());
}

}  // namespace

PlaneFit fit_plane(const Mesh& mesh) {
  const std::vector<Index> nodes = nodes_of_elements(mesh);
  if (nodes.empty()) return {Vec3::UnitZ()};
  Vec3 low = mesh.nodes[nodes.front()], high = low;
  for (const Index node : nodes) {
    low = low.cwiseMin(mesh.nodes[node]);
    high = high.cwiseMax(mesh.nodes[node]);
  }
  const double extent = (high - low).norm();
  for (int axis = 2; axis >= 0; --axis)
    if (high[axis] - low[axis] <= flat * extent) return {Vec3::Unit(axis)};
  const Vec3 normal = guess_normal(mesh, nodes, extent);
  const Vec3 origin = mesh.nodes[nodes.front()];
  const auto off_plane = [&](const Vec3& x) { return std::abs(normal.dot(x - origin)); };
  const Index node = farthest(mesh, nodes, off_plane);
  if (off_plane(mesh.nodes[node]) <= flat * extent) return {normal};
  return {std::nullopt, node, off_plane(mesh.nodes[node])};
}

}  // namespace roughmesh::detail
