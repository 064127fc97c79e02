// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace roughmesh::detail {
namespace {

// Found by search over the spacing, errors over all places and distances, of which those beside the
// jump of a kernel to its next point are the worst; a test computes them again.
constexpr std::array widths = {KernelWidth{3, 1.167, 6.7e-2},  KernelWidth{4, 1.005, 2.8e-2},
                               KernelWidth{5, 0.907, 7.1e-3},  KernelWidth{6, 0.837, 2.7e-3},
                               KernelWidth{7, 0.770, 7.6e-4},  KernelWidth{8, 0.725, 2.7e-4},
                               KernelWidth{9, 0.682, 8.1e-5},  KernelWidth{10, 0.650, 2.8e-5},
                               KernelWidth{11, 0.619, 8.6e-6}, KernelWidth{12, 0.594, 3.0e-6},
                               KernelWidth{13, 0.571, 9.3e-7}, KernelWidth{14, 0.551, 3.1e-7},
                               KernelWidth{15, 0.532, 9.8e-8}, KernelWidth{16, 0.516, 3.4e-8},
                               KernelWidth{17, 0.501, 1.1e-8}, KernelWidth{18, 0.487, 3.6e-9},
                               KernelWidth{19, 0.474, 1.2e-9}, KernelWidth{20, 0.463, 3.7e-10}};

/// Mean over x of the sum of squares of exp(-(x - b j)^2 / s^2), over all lattice points j modulo
/// the period: what a kernel that reaches round the period is divided by.
double periodic_square_sum(double scale, double spacing, double period) {
  double images = 1;
  for (int n = 1; n * period < 9 * scale; ++n)
    images += 2 * std::exp(-0.5 * (n * period / scale) * (n * period / scale));
  return std::sqrt(std::numbers::pi / 2) * scale / spacing * images;
}

}  // namespace

std::span<const KernelWidth> kernel_widths() { return widths; }

void LatticeAxis::set_width(int n_points, double exponent) {
  n_points_ = n_points;
  exponent_ = exponent;
  lead_ = 1 - 0.5 * n_points;
  for (int p = 1; p < n_points; ++p)
    step_[static_cast<std::size_t>(p)] = std::exp(-(2 * p - 1) * exponent);
}

LatticeAxis::LatticeAxis(double scale, const KernelWidth& width)
    : inverse_spacing_(1 / (width.spacing * scale)) {
  set_width(width.n_points, width.spacing * width.spacing);
}

LatticeAxis::LatticeAxis(double scale, const KernelWidth& width, double period) {
  if (scale >= flat_periods * period) return;
  n_period_ = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(std::ceil(period / (width.spacing * scale))));
  const double spacing = period / static_cast<double>(n_period_);
  inverse_spacing_ = static_cast<double>(n_period_) / period;
  const double reach = width.n_points * width.spacing * scale;
  set_width(std::min(most_lattice_points, static_cast<int>(std::ceil(reach / spacing - 1e-9))),
            (spacing / scale) * (spacing / scale));
  if (n_points_ > n_period_)
    amplitude_ = 1 / std::sqrt(periodic_square_sum(scale, spacing, period));
}

std::int64_t LatticeAxis::wrapped(std::int64_t point) const {
  if (n_period_ == 0) return point;
  const std::int64_t rest = point % n_period_;
  return rest < 0 ? rest + n_period_ : rest;
}

double row_product(const LatticeAxis& axis, const AxisRow& a, const AxisRow& b) {
  double sum = 0;
  const std::int64_t n_a = a.size, n_b = b.size;
  // Shifts of b by whole periods that bring it onto a; one shift, 0, without period.
  const std::int64_t period = axis.n_period();
  const std::int64_t lead = b.first - a.first;
  const auto add_shifted = [&](std::int64_t shift) {
    for (std::int64_t k = std::max<std::int64_t>(0, shift); k < std::min(n_a, shift + n_b); ++k)
      sum += a.value[k] * b.value[k - shift];
  };
  if (period == 0) {
    add_shifted(lead);
    return sum;
  }
  const std::int64_t start = axis.wrapped(lead) - period * ((n_b + period - 1) / period);
  for (std::int64_t shift = start; shift < n_a; shift += period) add_shifted(shift);
  return sum;
}

}  // namespace roughmesh::detail
