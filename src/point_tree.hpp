// SPDX-License-Identifier: BSD-3-Clause
// Points seen from one of them: near ones singly, far ones in groups.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/distance.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Points in a cube of Morton's curve, and one that stands for all of them.
struct PointCell {
  Index begin = 0, end = 0;  ///< of them along the curve
  Index next = 0;            ///< the first cell that is none of its parts
  Index point = 0;           ///< the one nearest to their mean place
  double radius = 0;         ///< of the sphere around it that holds them
};

/// An octree of points. A sum over all points of a function that varies on the scale of the
/// distance, or more slowly, takes some thousand terms.
class PointTree {
 public:
  /// @param places  kept by reference
  /// @param distance  any but that along a curve
  PointTree(std::span<const Vec3> places, const Distance& distance);

  const std::vector<Index>& curve() const { return curve_; }
  std::size_t n_cells() const { return cells_.size(); }
  std::span<const Index> points(std::size_t cell) const { return points(cells_[cell]); }

  /// Calls on_cell(number, point) for each largest cell whose diameter is at most `angle` times its
  /// distance from the place, and on_point(point) for each point in none of them.
  template <class OnPoint, class OnCell>
  void visit(const Vec3& from, double angle, OnPoint&& on_point, OnCell&& on_cell) const {
    const double radii = 1 + 2 / angle;  // infinite for the angle 0, at which no cell is far
    for (std::size_t c = 0; c < cells_.size();) {
      const PointCell& cell = cells_[c];
      const bool is_far = distance_(from, places_[cell.point]) > radii * cell.radius;
      const bool is_leaf = static_cast<std::size_t>(cell.next) == c + 1;
      if (is_far)
        on_cell(c, cell.point);
      else if (is_leaf)
        for (const Index point : points(cell)) on_point(point);
      c = is_far || is_leaf ? static_cast<std::size_t>(cell.next) : c + 1;
    }
  }

 private:
  std::span<const Index> points(const PointCell& cell) const {
    return std::span(curve_).subspan(cell.begin, cell.end - cell.begin);
  }
  void add_cell(std::span<const std::uint64_t> codes, Index begin, Index end);
  void find_centres(std::span<const Vec3> along_curve);

  std::span<const Vec3> places_;
  Distance distance_;
  std::vector<Index> curve_;
  std::vector<PointCell> cells_;  // each before its parts
};

}  // namespace roughmesh::detail
