// SPDX-License-Identifier: BSD-3-Clause
#include "second_order.hpp"

#include "element_nodes.hpp"

namespace roughmesh::detail {

// The table gives nodes on edges before the middles that need them, and whatever else a node of an
// element depends on is settled or was met in an earlier element.
Followers::Followers(const Mesh& mesh, int cell_dimension,
                     const std::vector<std::uint8_t>& is_settled) {
  std::vector<std::uint8_t> is_known = is_settled;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != cell_dimension || block.type.order != 2) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto nodes = block.element(e);
      for (const FollowingNode& following : following_nodes(block.type)) {
        const Index node = nodes[following.node];
        if (is_known[node]) continue;
        is_known[node] = 1;
        nodes_.push_back(node);
        for (const auto& [other, weight] : following.of_others) {
          others_.push_back(nodes[other]);
          weights_.push_back(weight);
        }
        offsets_.push_back(others_.size());
      }
    }
  }
}

void Followers::fill(std::span<Vec3> displacements) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = offsets_[i]; k < offsets_[i + 1]; ++k)
      sum += weights_[k] * displacements[others_[k]];
    displacements[nodes_[i]] = sum;
  }
}

}  // namespace roughmesh::detail
