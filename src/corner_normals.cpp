// SPDX-License-Identifier: BSD-3-Clause
#include "corner_normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "io_patch.hpp"

namespace roughmesh::detail {
namespace {

bool is_surface(const ElementBlock& block) { return dimension(block.type.shape) == 2; }

// A power of two near the extent: dividing by it changes no digit.
double length_scale(const std::vector<Vec3>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : positions) box.extend(x);
  const double extent = positions.empty() ? 0 : box.sizes().maxCoeff();
  return extent > 0 && std::isfinite(extent) ? std::ldexp(1.0, std::ilogb(extent)) : 1;
}

}  // namespace

Vec3 corner_normal(const Vec3& next, const Vec3& previous) {
  const double squares = next.squaredNorm() * previous.squaredNorm();
  return squares > 0 ? Vec3(next.cross(previous) / squares) : Vec3::Zero();
}

CornerNormals::CornerNormals(const std::vector<Vec3>& positions, std::size_t n_slots)
    : positions_(&positions), scale_(length_scale(positions)), sums_(n_slots, Vec3::Zero()) {}

void CornerNormals::add(Index slot, const Vec3& normal) {
  if (slot >= 0 && static_cast<std::size_t>(slot) < sums_.size()) sums_[slot] += normal;
}

void CornerNormals::add_face(std::span<const Index> nodes, std::span<const Index> slots,
                             std::size_t n_corners) {
  std::array<Vec3, 4> edges;  // edge k goes from corner k to the next
  for (std::size_t k = 0; k < n_corners; ++k)
    edges[k] =
        (*positions_)[nodes[(k + 1) % n_corners]] / scale_ - (*positions_)[nodes[k]] / scale_;
  Vec3 total = Vec3::Zero();
  for (std::size_t k = 0; k < n_corners; ++k) {
    const Vec3 normal = corner_normal(edges[k], -edges[(k + n_corners - 1) % n_corners]);
    add(slots[k], normal);
    total += normal;
  }
  for (std::size_t k = n_corners; k < slots.size(); ++k)
    add(slots[k], total / static_cast<double>(n_corners));
}

Vec3 CornerNormals::normal(std::size_t slot) const {
  const double largest = sums_[slot].lpNorm<Eigen::Infinity>();
  if (!(largest > 0 && std::isfinite(largest))) return Vec3::Zero();
  return (sums_[slot] / largest).normalized() + Vec3::Zero();  // no -0
}

std::vector<Vec3> stored_positions(const Mesh& mesh) {
  std::vector<Vec3> stored = mesh.nodes;
  for (Vec3& x : stored)
    x = x.unaryExpr([&](double value) { return as_stored(*mesh.source, value); });
  return stored;
}

std::vector<Vec3> node_normals(const Mesh& mesh, const std::vector<Vec3>& positions) {
  CornerNormals sums(positions, positions.size());
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_surface(block)) continue;
    const auto n = static_cast<std::size_t>(n_corners(block.type.shape));
    for (Index i = 0; i < block.size(); ++i) sums.add_face(block.element(i), block.element(i), n);
  }
  std::vector<Vec3> normals(positions.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = sums.normal(i);
  return normals;
}

std::vector<bool> is_at_moved_face(const Mesh& mesh) {
  const std::vector<bool> moved = has_moved(mesh);
  std::vector<bool> result(mesh.nodes.size());
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_surface(block)) continue;
    for (Index i = 0; i < block.size(); ++i) {
      const auto face = block.element(i);
      if (std::any_of(face.begin(), face.end(), [&](Index node) { return moved[node]; }))
        for (const Index node : face) result[node] = true;
    }
  }
  return result;
}

}  // namespace roughmesh::detail
