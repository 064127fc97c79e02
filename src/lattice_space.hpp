// SPDX-License-Identifier: BSD-3-Clause
// The space in which the method `lattice` works.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "roughmesh/distance.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Stretched coordinates S x of the points (docs/math.md, eq. 11), in which the field is isotropic,
/// with their axes in an order that puts those along which nothing varies first, and reduced to one
/// period. A function of the distance and the dimension only.
class LatticeSpace {
 public:
  /// @param dimension  2: the third axis does not count
  LatticeSpace(const Distance& distance, int dimension);

  Vec3 operator()(const Vec3& x) const;
  bool varies(int axis) const { return varies_[static_cast<std::size_t>(axis)]; }
  double period(int axis) const { return period_[axis]; }  ///< 0: not periodic
  int n_varying() const;

 private:
  Eigen::Matrix3d stretch_;
  std::array<bool, 3> varies_{};
  Vec3 period_ = Vec3::Zero();
};

/// Places along Morton's curve through absolute cells, so that those of one cell of any size follow
/// each other, and so do equal places.
class SortedPlaces {
 public:
  using Range = std::pair<std::size_t, std::size_t>;  ///< first, end

  /// @param cell  edge of the cells, > 0; also of those of 2, 4, ... times the edge
  SortedPlaces(std::vector<Vec3> places, double cell);

  const std::vector<Vec3>& places() const { return places_; }         ///< sorted
  const std::vector<std::uint32_t>& order() const { return order_; }  ///< number of each before
  std::size_t size() const { return places_.size(); }

  /// Where a place stands, by its number before and its coordinates.
  std::size_t position(std::uint32_t number, const Vec3& place) const;

  /// Places in one cell each, of the largest cells with an edge of at most `largest`, or of the
  /// smallest ones there are.
  std::vector<Range> cells(double largest) const { return cells({0, size()}, largest); }

  /// Of places that are a cell themselves.
  std::vector<Range> cells(Range within, double largest) const;

  /// How often the edge may be doubled before cells of different places are no longer told apart.
  int n_doublings(double edge) const;

 private:
  std::uint64_t code(const Vec3& place) const;

  std::vector<Vec3> places_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> codes_;
  double quantum_ = 1;        ///< edge of the smallest cells
  Vec3 base_ = Vec3::Zero();  ///< number of the first of them along each axis
};

}  // namespace roughmesh::detail
