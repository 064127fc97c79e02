// SPDX-License-Identifier: BSD-3-Clause
// Normals of vertices from the corners of the faces at them, by Max's weights (docs/math.md, eq.
// 2).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Contribution of one corner with the edges that leave it, next and previous; zero where one has
/// no length. The fourth power of a length has to be within the range of doubles.
Vec3 corner_normal(const Vec3& next, const Vec3& previous);

/// Unit normals of slots, which are nodes or whatever else a file gives normals to: each slot sums
/// the corners that use it. The sum is zero, and so is the normal, where faces have no area or
/// cancel.
class CornerNormals {
 public:
  /// @param positions  kept by reference, in the order that `nodes` of add_face refer to
  CornerNormals(const std::vector<Vec3>& positions, std::size_t n_slots);

  /// A face of 3 or 4 corners, which stand first; nodes behind them, in the middle of an edge or of
  /// the face, get the mean of the corners. Slots outside of [0, n_slots) stand for none.
  void add_face(std::span<const Index> nodes, std::span<const Index> slots, std::size_t n_corners);
  Vec3 normal(std::size_t slot) const;

 private:
  void add(Index slot, const Vec3& normal);

  const std::vector<Vec3>* positions_;
  double scale_ = 1;  // keeps powers of lengths within the range of doubles
  std::vector<Vec3> sums_;
};

/// Positions of a mesh that was read, in the number format of its source.
std::vector<Vec3> stored_positions(const Mesh& mesh);

/// Normal at each node from all faces of the mesh, its nodes being at `positions`.
std::vector<Vec3> node_normals(const Mesh& mesh, const std::vector<Vec3>& positions);

/// For each node of a mesh that was read, whether a node of a face at it has moved.
std::vector<bool> is_at_moved_face(const Mesh& mesh);

}  // namespace roughmesh::detail
