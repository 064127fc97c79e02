// SPDX-License-Identifier: BSD-3-Clause
// Nodes of elements of order 2 that follow their neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Displacements of the nodes on edges, in faces and inside of elements of order 2, each a weighted
/// mean of those of others (docs/math.md, eq. 38).
class Followers {
 public:
  /// @param cell_dimension  of the elements that deform
  /// @param is_settled      per node: its displacement comes from elsewhere, or is zero
  Followers(const Mesh& mesh, int cell_dimension, const std::vector<std::uint8_t>& is_settled);

  std::span<const Index> nodes() const { return nodes_; }

  /// Fills in the displacements of nodes(), given those of all others.
  void fill(std::span<Vec3> displacements) const;

 private:
  std::vector<Index> nodes_;  // each after those that it depends on
  std::vector<std::size_t> offsets_ = {0};
  std::vector<Index> others_;
  std::vector<double> weights_;
};

}  // namespace roughmesh::detail
