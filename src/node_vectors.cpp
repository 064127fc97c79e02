// SPDX-License-Identifier: BSD-3-Clause
#include "node_vectors.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "corner_normals.hpp"
#include "io_patch.hpp"

namespace roughmesh::detail {
namespace {

// Normals of the faces at each node, before and after.
struct NodeNormals {
  explicit NodeNormals(const Mesh& mesh)
      : before(node_normals(mesh, mesh.source->positions)),
        after(node_normals(mesh, mesh.nodes)),
        has_changed(is_at_moved_face(mesh)) {}

  std::vector<Vec3> before, after;
  std::vector<bool> has_changed;
};

Vec3 moved_vector(const NodeVector& vector, const NodeNormals& normals) {
  if (!normals.has_changed[vector.node]) return vector.value;
  const Vec3& before = normals.before[vector.node];
  const Vec3& after = normals.after[vector.node];
  if (before.isZero(0) || after.isZero(0)) return vector.value;
  if (!vector.is_normal) return Eigen::Quaterniond::FromTwoVectors(before, after) * vector.value;
  return (vector.value.dot(before) < 0 ? Vec3(-after) : after) + Vec3::Zero();  // no -0
}

}  // namespace

std::vector<MovedVector> moved_vectors(const Mesh& mesh) {
  std::vector<MovedVector> result;
  const std::vector<NodeVector>& vectors = mesh.source->vectors;
  if (vectors.empty()) return result;
  const NodeNormals normals(mesh);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Vec3 value = moved_vector(vectors[i], normals);
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
