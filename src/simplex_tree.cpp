// SPDX-License-Identifier: BSD-3-Clause
#include "simplex_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t most_levels = 33;  // halving 2^32 simplices

int longest_axis(const Eigen::AlignedBox3d& box) {
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  return static_cast<int>(axis);
}

// Twice the middle; ties are broken by the simplices themselves, so that each half is one set.
bool lies_before(const PlacedSimplex& a, const PlacedSimplex& b, int axis) {
  const auto place = [axis](const PlacedSimplex& s) {
    const auto [low, high] =
        std::minmax({s.vertices[0][axis], s.vertices[1][axis], s.vertices[2][axis]});
    return low + high;
  };
  const double x = place(a), y = place(b);
  return x != y ? x < y : a < b;
}

}  // namespace

SimplexTree::SimplexTree(std::vector<PlacedSimplex> simplices) : simplices_(std::move(simplices)) {
  std::sort(simplices_.begin(), simplices_.end());
  simplices_.erase(std::unique(simplices_.begin(), simplices_.end()), simplices_.end());
  if (simplices_.size() > std::numeric_limits<std::uint32_t>::max())
    throw InputError("a mask starts from more than 2^32 elements; choose a smaller group");
  if (!simplices_.empty()) add_nodes(0, static_cast<std::uint32_t>(simplices_.size()));
}

// Halves have equal numbers of simplices, so the recursion is as deep as their logarithm.
std::uint32_t SimplexTree::add_nodes(std::uint32_t first, std::uint32_t last) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, first, last, 0});
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = first; i < last; ++i) box.extend(simplices_[i].bounds());
  nodes_[self].box = box;
  if (last - first <= leaf_size) return self;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(simplices_.begin() + first, simplices_.begin() + middle,
                   simplices_.begin() + last,
                   [axis = longest_axis(box)](const PlacedSimplex& a, const PlacedSimplex& b) {
                     return lies_before(a, b, axis);
                   });
  add_nodes(first, middle);
  const std::uint32_t right = add_nodes(middle, last);
  nodes_[self].right = right;
  return self;
}

double SimplexTree::distance_within(const Vec3& x, double limit) const {
  if (nodes_.empty()) return std::numeric_limits<double>::infinity();
  double nearest = limit * limit;
  bool is_within = false;
  std::array<std::uint32_t, most_levels + 1> waiting{};  // one sibling per level
  std::size_t n_waiting = 0;
  waiting[n_waiting++] = 0;
  while (n_waiting > 0) {
    const std::uint32_t self = waiting[--n_waiting];
    const Node& node = nodes_[self];
    if (node.box.squaredExteriorDistance(x) > nearest) continue;
    if (node.right == 0) {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        const double square = squared_distance(simplices_[i], x);
        is_within = is_within || square <= nearest;
        nearest = std::min(nearest, square);
      }
      continue;
    }
    std::uint32_t near = self + 1, far = node.right;
    if (nodes_[far].box.squaredExteriorDistance(x) < nodes_[near].box.squaredExteriorDistance(x))
      std::swap(near, far);
    waiting[n_waiting++] = far;
    waiting[n_waiting++] = near;
  }
  return is_within ? std::sqrt(nearest) : std::numeric_limits<double>::infinity();
}

}  // namespace roughmesh::detail
