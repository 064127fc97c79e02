// SPDX-License-Identifier: BSD-3-Clause
// The nearest of many simplices: a balanced binary tree of their bounding boxes.
#pragma once

#include <cstdint>
#include <vector>

#include "simplex.hpp"

namespace roughmesh::detail {

/// A function of the set of simplices only: neither their order nor repetitions change any bit of a
/// distance. O(N log N) to make.
class SimplexTree {
 public:
  explicit SimplexTree(std::vector<PlacedSimplex> simplices);

  /// Distance from x to the nearest simplex if that is at most `limit`, else infinity.
  double distance_within(const Vec3& x, double limit) const;

 private:
  /// Simplices [first, last) in one box. Children lie behind their parent, the left one at once.
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0, last = 0;
    std::uint32_t right = 0;  ///< 0 for a leaf
  };

  std::uint32_t add_nodes(std::uint32_t first, std::uint32_t last);

  std::vector<PlacedSimplex> simplices_;
  std::vector<Node> nodes_;
};

}  // namespace roughmesh::detail
