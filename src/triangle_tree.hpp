// SPDX-License-Identifier: BSD-3-Clause
// A hierarchy of bounding boxes over triangles or segments: which come near each other, which come
// near a ray.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Point numbers of the corners; a segment repeats its second one.
using Facet = std::array<Index, 3>;

/// A complete binary tree of boxes, in its leaves four facets each: neighbours in the order in
/// which the facets come, which should be one like Morton's curve. Boxes are of float, rounded
/// outward. O(N) to make.
class TriangleTree {
 public:
  static constexpr std::size_t leaf_size = 4;

  /// @param facets     kept by reference
  /// @param positions  of the points, finite
  /// @param is_marked  per point; a pair is visited if one of its facets has a marked corner
  TriangleTree(std::span<const Facet> facets, std::span<const Vec3> positions,
               std::span<const std::uint8_t> is_marked);

  /// Two subtrees of one level, whose pairs are one task.
  struct Task {
    std::uint32_t a, b;
  };

  /// All pairs, divided into tasks; depends on the facets and positions only.
  std::vector<Task> tasks() const;

  /// Calls visit(i, j), i < j, once for each pair of the task with overlapping boxes, until it
  /// returns false.
  template <class Visit>
  void for_each_pair(const Task& task, Visit&& visit) const {
    std::vector<Task> waiting = {task};
    while (!waiting.empty()) {
      const Task pair = waiting.back();
      waiting.pop_back();
      if (is_leaf(pair.a)) {
        if (!visit_leaves(pair.a - n_leaves_, pair.b - n_leaves_, visit)) return;
        continue;
      }
      add_children(pair, waiting);
    }
  }

  /// Calls reach = visit(i, reach) for facets whose boxes the ray meets: the places
  /// from + t direction with 0 <= t <= reach, which visit may shorten.
  template <class Visit>
  void for_each_along(const Vec3& from, const Vec3& direction, double reach, Visit&& visit) const {
    const FloatRay ray(*this, from, direction);
    std::array<std::uint32_t, 2 * most_levels> waiting{};
    std::size_t n_waiting = 0;
    waiting[n_waiting++] = 1;
    while (n_waiting > 0) {
      const std::uint32_t node = waiting[--n_waiting];
      if (!ray.meets(boxes_[node], reach)) continue;
      if (!is_leaf(node)) {
        waiting[n_waiting++] = 2 * node + 1;
        waiting[n_waiting++] = 2 * node;
        continue;
      }
      const std::size_t first = leaf_size * (node - n_leaves_);
      for (std::size_t i = first; i < first + leaf_size && i < facets_.size(); ++i)
        reach = visit(i, reach);
    }
  }

 private:
  static constexpr std::size_t most_levels = 32;

  struct Box {
    std::array<float, 3> low, high;
  };
  static const Box empty;  ///< of no facet; overlaps none
  /// The boxes of the facets of a leaf, side by side for vector registers.
  struct Leaf {
    std::array<std::array<float, leaf_size>, 3> low, high;
  };
  /// In the coordinates of the boxes.
  struct FloatRay {
    FloatRay(const TriangleTree& tree, const Vec3& from, const Vec3& direction);
    bool meets(const Box& box, double reach) const;

    std::array<double, 3> origin, inverse;  // of the direction
  };

  bool is_leaf(std::uint32_t node) const { return node >= n_leaves_; }
  /// Without a branch between the six comparisons.
  static bool overlap(const Box& a, const Box& b) {
    int result = 1;
    for (std::size_t k = 0; k < 3; ++k)
      result &= static_cast<int>(a.low[k] <= b.high[k]) & static_cast<int>(b.low[k] <= a.high[k]);
    return result != 0;
  }

  void choose_scale(std::span<const Vec3> positions);
  void fill_leaf(std::size_t leaf, std::span<const Vec3> positions,
                 std::span<const std::uint8_t> is_marked);
  void add_if_near(std::uint32_t a, std::uint32_t b, std::vector<Task>& pairs) const;
  void add_children(const Task& pair, std::vector<Task>& pairs) const;
  std::uint32_t overlaps(const Leaf& leaf, std::size_t facet, const Leaf& other) const;

  template <class Visit>
  bool visit_leaves(std::size_t a, std::size_t b, Visit& visit) const {
    for (std::size_t k = 0; k < leaf_size; ++k) {
      std::uint32_t near = overlaps(leaves_[a], k, leaves_[b]);
      if (!(marks_[n_leaves_ + a] >> k & 1)) near &= marks_[n_leaves_ + b];
      if (a == b) near &= ~0U << (k + 1);
      for (; near != 0; near &= near - 1)
        if (!visit(leaf_size * a + k,
                   leaf_size * b + static_cast<std::size_t>(std::countr_zero(near))))
          return false;
    }
    return true;
  }

  std::span<const Facet> facets_;
  std::uint32_t n_leaves_ = 1;  ///< a power of 2; the last ones may have no facet
  Vec3 centre_ = Vec3::Zero();  ///< of all positions
  double scale_ = 1;            ///< half of their extent
  /// Node k has the children 2k and 2k + 1; leaves come last, without the empty ones.
  std::vector<Box> boxes_;
  std::vector<std::uint8_t> marks_;  ///< per node; of a leaf one bit for each facet
  std::vector<Leaf> leaves_;         ///< those with facets
};

}  // namespace roughmesh::detail
