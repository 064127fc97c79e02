// SPDX-License-Identifier: BSD-3-Clause
// Classes of points, nodes or patches that grow together.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Disjoint sets of 0 .. n - 1, each named by its smallest member; nearly linear time.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }

  Index smallest(Index i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];  // halves the path for the next time
      i = parent_[i];
    }
    return i;
  }

  void unite(Index i, Index j) {
    i = smallest(i);
    j = smallest(j);
    if (i != j) parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace roughmesh::detail
