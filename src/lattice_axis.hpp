// SPDX-License-Identifier: BSD-3-Clause
// One axis of a lattice of white noise under a Gaussian kernel.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace roughmesh::detail {

/// Lattice points that a kernel takes in along an axis, at most.
constexpr int most_lattice_points = 40;

/// Images of a Gaussian with a scale of this many periods or more add up to a constant: their
/// covariance leaves 1 by at most 4 exp(-2 pi^2 1.2^2) = 1.8e-12.
constexpr double flat_periods = 1.2;

/// How many lattice points a kernel takes along an axis, how far apart, and the largest error that
/// the covariance then has along one axis, in units of the variance (docs/math.md, eq. 47).
struct KernelWidth {
  int n_points;
  double spacing;  ///< over the scale s of the Gaussian
  double error;
};

/// Ascending in n_points, each with its best spacing.
std::span<const KernelWidth> kernel_widths();

/// A lattice along one axis, and the Gaussian kernel exp(-(x - b j)^2 / s^2) on it, whose sum of
/// squares is 1 for every x, so that points have unit variance.
class LatticeAxis {
 public:
  /// The field does not vary along it: one lattice point of weight 1.
  LatticeAxis() = default;

  LatticeAxis(double scale, const KernelWidth& width);

  /// Periodic: the spacing divides the period, and indices count modulo n_period(). Does not vary
  /// from flat_periods on.
  LatticeAxis(double scale, const KernelWidth& width, double period);

  bool varies() const { return inverse_spacing_ > 0; }
  double inverse_spacing() const { return inverse_spacing_; }  ///< 0: does not vary
  int n_points() const { return n_points_; }                   ///< P
  std::int64_t n_period() const { return n_period_; }          ///< 0: not periodic
  double exponent() const { return exponent_; }                ///< (b / s)^2
  /// From the middle of a kernel to its first point, in spacings, plus 1 for the floor.
  double lead() const { return lead_; }
  /// exp(-(2 p - 1) exponent()), p from 1 to n_points() - 1.
  double step(int p) const { return step_[static_cast<std::size_t>(p)]; }
  /// Of the kernel, where it reaches round a period; 0: normalize by the sum of squares.
  double amplitude() const { return amplitude_; }

  /// Index of the first of n_points() lattice points that the kernel at x takes in.
  std::int64_t first_point(double x) const {
    return static_cast<std::int64_t>(std::floor(x * inverse_spacing_ + lead_));
  }

  /// The index modulo the period.
  std::int64_t wrapped(std::int64_t point) const;

 private:
  void set_width(int n_points, double exponent);

  double inverse_spacing_ = 0;
  double exponent_ = 0;
  double amplitude_ = 0;
  double lead_ = 0;
  std::array<double, most_lattice_points> step_{};
  int n_points_ = 1;
  std::int64_t n_period_ = 0;
};

/// A row of the map from the noise of one axis to heights: values of consecutive lattice points.
struct AxisRow {
  std::int64_t first = 0;
  int size = 0;
  std::array<double, most_lattice_points + 24> value;
};

/// Covariance of two rows along one axis: the sum over the lattice points they share, modulo the
/// period.
double row_product(const LatticeAxis& axis, const AxisRow& a, const AxisRow& b);

}  // namespace roughmesh::detail
