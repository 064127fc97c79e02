// SPDX-License-Identifier: BSD-3-Clause
#include "triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t grain = 4096;
constexpr float infinite = std::numeric_limits<float>::infinity();
// Coordinates of boxes are within [-1, 1]; a float is off by half of 2^-24 there.
constexpr float round_off = 0x1p-23F;

}  // namespace

const TriangleTree::Box TriangleTree::empty = {{infinite, infinite, infinite},
                                               {-infinite, -infinite, -infinite}};

TriangleTree::TriangleTree(std::span<const Facet> facets, std::span<const Vec3> positions,
                           std::span<const std::uint8_t> is_marked)
    : facets_(facets) {
  const std::size_t n_full = (facets.size() + leaf_size - 1) / leaf_size;
  n_leaves_ = static_cast<std::uint32_t>(std::bit_ceil(std::max<std::size_t>(n_full, 1)));
  leaves_.resize(n_full);
  // Of the last level those that the level above asks for.
  const std::size_t n_nodes = n_leaves_ + n_full + n_full % 2;
  boxes_.assign(std::max<std::size_t>(n_nodes, 2), empty);
  marks_.resize(boxes_.size());
  choose_scale(positions);
  parallel_for(n_full, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) fill_leaf(leaf, positions, is_marked);
  });
  for (std::size_t level = n_leaves_ / 2; level > 0; level /= 2)
    parallel_for(level, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = level + begin; node < level + end; ++node) {
        if (2 * node >= boxes_.size()) break;
        const Box &left = boxes_[2 * node], &right = boxes_[2 * node + 1];
        for (std::size_t k = 0; k < 3; ++k) {
          boxes_[node].low[k] = std::min(left.low[k], right.low[k]);
          boxes_[node].high[k] = std::max(left.high[k], right.high[k]);
        }
        marks_[node] = marks_[2 * node] | marks_[2 * node + 1];
      }
    });
}

// Halves before differences, so that no coordinates of a double overflow.
void TriangleTree::choose_scale(std::span<const Vec3> positions) {
  if (positions.empty()) return;
  Vec3 low = positions.front(), high = low;
  for (const Vec3& x : positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  centre_ = low / 2 + high / 2;
  scale_ = std::max((high / 2 - low / 2).maxCoeff(), std::numeric_limits<double>::min());
}

void TriangleTree::fill_leaf(std::size_t leaf, std::span<const Vec3> positions,
                             std::span<const std::uint8_t> is_marked) {
  Leaf& boxes = leaves_[leaf];
  Box& whole = boxes_[n_leaves_ + leaf];
  for (std::size_t i = 0; i < leaf_size; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.low[k][i] = infinite;  // of no facet
      boxes.high[k][i] = -infinite;
    }
    const std::size_t f = leaf_size * leaf + i;
    if (f >= facets_.size()) continue;
    for (const Index point : facets_[f]) {
      const Vec3 x = (positions[point] - centre_) / scale_;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto c = static_cast<float>(x[static_cast<Eigen::Index>(k)]);
        boxes.low[k][i] = std::min(boxes.low[k][i], c - round_off);
        boxes.high[k][i] = std::max(boxes.high[k][i], c + round_off);
      }
      if (is_marked[point]) marks_[n_leaves_ + leaf] |= static_cast<std::uint8_t>(1U << i);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      whole.low[k] = std::min(whole.low[k], boxes.low[k][i]);
      whole.high[k] = std::max(whole.high[k], boxes.high[k][i]);
    }
  }
}

void TriangleTree::add_if_near(std::uint32_t a, std::uint32_t b, std::vector<Task>& pairs) const {
  if ((marks_[a] | marks_[b]) != 0 && overlap(boxes_[a], boxes_[b])) pairs.push_back({a, b});
}

void TriangleTree::add_children(const Task& pair, std::vector<Task>& pairs) const {
  const std::uint32_t a = 2 * pair.a, b = 2 * pair.b;
  add_if_near(a, b, pairs);
  add_if_near(a, b + 1, pairs);
  if (pair.a != pair.b) add_if_near(a + 1, b, pairs);
  add_if_near(a + 1, b + 1, pairs);
}

std::vector<TriangleTree::Task> TriangleTree::tasks() const {
  constexpr std::size_t enough = 512;
  std::vector<Task> current, next;
  add_if_near(1, 1, current);
  while (!current.empty() && current.size() < enough && !is_leaf(current.front().a)) {
    next.clear();
    for (const Task& pair : current) add_children(pair, next);
    current.swap(next);
  }
  return current;
}

std::uint32_t TriangleTree::overlaps(const Leaf& leaf, std::size_t facet, const Leaf& other) const {
  std::array<std::int32_t, leaf_size> near;
  near.fill(1);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < leaf_size; ++i)
      near[i] &= static_cast<std::int32_t>(leaf.low[k][facet] <= other.high[k][i]) &
                 static_cast<std::int32_t>(other.low[k][i] <= leaf.high[k][facet]);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < leaf_size; ++i) bits |= static_cast<std::uint32_t>(near[i]) << i;
  return bits;
}

TriangleTree::FloatRay::FloatRay(const TriangleTree& tree, const Vec3& from,
                                 const Vec3& direction) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    origin[k] = (from[axis] - tree.centre_[axis]) / tree.scale_;
    inverse[k] = tree.scale_ / direction[axis];
  }
}

// A direction across an axis makes products infinite, or no number where the origin lies on a side
// of the box: max and min keep their first argument then.
bool TriangleTree::FloatRay::meets(const Box& box, double reach) const {
  double enter = 0, leave = reach;
  for (std::size_t k = 0; k < 3; ++k) {
    const double to_low = (box.low[k] - origin[k]) * inverse[k];
    const double to_high = (box.high[k] - origin[k]) * inverse[k];
    const double near = inverse[k] < 0 ? to_high : to_low, far = inverse[k] < 0 ? to_low : to_high;
    if (near > enter) enter = near;
    if (far < leave) leave = far;
  }
  return enter <= leave;
}

}  // namespace roughmesh::detail
