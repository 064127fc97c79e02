// SPDX-License-Identifier: BSD-3-Clause
// Displacements as Gaussian mixtures see them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"

namespace roughmesh::detail {

/// The coordinates of a displacement x that exp(-|S x|^2 / (2 s^2)), and its sum over images, are
/// functions of: up to three along periodic axes, and the length of what is left of S x.
class MixtureSpace {
 public:
  static constexpr std::size_t most_axes = 3;
  using Coordinates = std::array<double, most_axes>;

  /// @throws InputError  neither `euclidean` nor `periodic`
  explicit MixtureSpace(const Distance& distance);

  std::size_t n_axes() const { return periods_.size(); }
  int n_periodic_axes() const;
  double period(std::size_t axis) const { return periods_[axis]; }  ///< stretched; or 0

  bool is_bounded() const { return periods_.back() > 0; }  ///< no axis is without period

  /// From 0 to period / 2 along periodic axes.
  Coordinates coordinates(const Vec3& displacement) const;

  /// The factor of one axis, summed over the images along it.
  double images(std::size_t axis, double coordinate, double scale) const;

  /// The product of all factors, 1 at 0.
  double gaussian(const Coordinates& x, double scale) const;

  /// The shares that Gaussians of given weights have in the sum over images, divided by its value
  /// at 0 (docs/math.md, eq. 45). What the weights lack of 1 has scales too small for any image.
  std::vector<GaussianTerm> shares(std::span<const GaussianTerm> terms) const;

 private:
  Distance distance_;
  std::vector<double> periods_;  ///< 0, at most once, is the axis without period
};

}  // namespace roughmesh::detail
