// SPDX-License-Identifier: BSD-3-Clause
#include "node_vectors.hpp"

#include <cmath>
#include <span>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "io_patch.hpp"

namespace roughmesh::detail {
namespace {

// Sums over the faces at each node, before and after.
struct NodeSums {
  std::vector<Vec3> before, after;
  std::vector<bool> has_changed;
};

// Direction only: scaled, so that neither tiny nor huge edges leave the range of doubles.
Vec3 corner_normal(const Vec3& next, const Vec3& previous, double scale) {
  const Vec3 a = next / scale, b = previous / scale;
  const double squares = a.squaredNorm() * b.squaredNorm();
  return squares > 0 ? Vec3(a.cross(b) / squares) : Vec3::Zero();
}

// Largest edge component of any face of the mesh.
double length_scale(const Mesh& mesh, const std::vector<Vec3>& positions) {
  double scale = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != 2) continue;
    for (Index e = 0; e < block.size(); ++e)
      for (const Index node : block.element(e))
        scale = std::max(
            scale, (positions[node] - positions[block.element(e)[0]]).lpNorm<Eigen::Infinity>());
  }
  return scale > 0 ? scale : 1;
}

// A node in the middle of an edge or face takes the mean of the corners' contributions.
void add_face(std::span<const Index> face, std::size_t n, const std::vector<Vec3>& x, double scale,
              std::vector<Vec3>& sums) {
  Vec3 total = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3& corner = x[face[k]];
    const Vec3 normal =
        corner_normal(x[face[(k + 1) % n]] - corner, x[face[(k + n - 1) % n]] - corner, scale);
    sums[face[k]] += normal;
    total += normal;
  }
  for (std::size_t k = n; k < face.size(); ++k) sums[face[k]] += total / static_cast<double>(n);
}

NodeSums sum_faces(const Mesh& mesh) {
  const std::vector<Vec3>& old = mesh.source->positions;
  const std::size_t n_nodes = mesh.nodes.size();
  NodeSums sums{std::vector<Vec3>(n_nodes, Vec3::Zero()), std::vector<Vec3>(n_nodes, Vec3::Zero()),
                std::vector<bool>(n_nodes, false)};
  const double old_scale = length_scale(mesh, old), new_scale = length_scale(mesh, mesh.nodes);
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != 2) continue;
    const auto n = static_cast<std::size_t>(n_corners(block.type.shape));
    for (Index e = 0; e < block.size(); ++e) {
      const auto face = block.element(e);
      add_face(face, n, old, old_scale, sums.before);
      add_face(face, n, mesh.nodes, new_scale, sums.after);
      bool has_moved = false;
      for (const Index node : face) has_moved |= !same_bits(old[node], mesh.nodes[node]);
      if (has_moved)
        for (const Index node : face) sums.has_changed[node] = true;
    }
  }
  return sums;
}

Vec3 moved_vector(const NodeVector& vector, const NodeSums& sums) {
  if (!sums.has_changed[vector.node]) return vector.value;
  const Vec3 before = sums.before[vector.node].normalized();
  const Vec3 after = sums.after[vector.node].normalized();
  if (!before.allFinite() || !after.allFinite() || before.isZero() || after.isZero())
    return vector.value;
  if (!vector.is_normal) return Eigen::Quaterniond::FromTwoVectors(before, after) * vector.value;
  return (vector.value.dot(before) < 0 ? Vec3(-after) : after) + Vec3::Zero();  // no -0
}

}  // namespace

std::vector<MovedVector> moved_vectors(const Mesh& mesh) {
  std::vector<MovedVector> result;
  const std::vector<NodeVector>& vectors = mesh.source->vectors;
  if (vectors.empty()) return result;
  const NodeSums sums = sum_faces(mesh);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Vec3 value = moved_vector(vectors[i], sums);
    const bool is_shared = i > 0 && vectors[i].offset == vectors[i - 1].offset;
    if (is_shared && !same_bits(value, result.back().value))
      throw InputError(fmt::format(
          "{}: several nodes share a normal or tangent and would need different ones now (node {} "
          "is one); remove the normals from the file",
          mesh.source->file.path.string(), mesh.node_tags[vectors[i].node]));
    if (!is_shared) result.push_back({vectors[i].offset, value});
  }
  // What stays as it was keeps its text.
  std::size_t kept = 0;
  for (std::size_t i = 0, r = 0; i < vectors.size(); ++i) {
    if (i > 0 && vectors[i].offset == vectors[i - 1].offset) continue;
    if (!same_bits(result[r].value, vectors[i].value)) result[kept++] = result[r];
    ++r;
  }
  result.resize(kept);
  return result;
}

}  // namespace roughmesh::detail
