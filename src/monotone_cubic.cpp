// SPDX-License-Identifier: BSD-3-Clause
#include "monotone_cubic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roughmesh::detail {
namespace {

// Mean of the slopes on both sides; 0 at an extremum.
double inner_slope(double left, double right) { return left * right > 0 ? (left + right) / 2 : 0; }

}  // namespace

MonotoneCubic::MonotoneCubic(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size()) {
  const std::size_t n = x_.size();
  std::vector<double> secant(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) secant[i] = (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]);
  slope_.front() = secant.front();
  slope_.back() = secant.back();
  for (std::size_t i = 1; i + 1 < n; ++i) slope_[i] = inner_slope(secant[i - 1], secant[i]);
  // Slopes over the secant inside a circle of radius 3 keep the piece monotone.
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (secant[i] == 0) {
      slope_[i] = slope_[i + 1] = 0;
      continue;
    }
    const double radius = std::hypot(slope_[i] / secant[i], slope_[i + 1] / secant[i]);
    if (radius <= 3) continue;
    slope_[i] *= 3 / radius;
    slope_[i + 1] *= 3 / radius;
  }
}

double MonotoneCubic::operator()(double x) const {
  if (!(x > x_.front())) return y_.front();
  if (!(x < x_.back())) return y_.back();
  const auto after = std::upper_bound(x_.begin(), x_.end(), x);
  const auto i = static_cast<std::size_t>(after - x_.begin() - 1);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h, s = 1 - t;
  return s * s * ((1 + 2 * t) * y_[i] + t * h * slope_[i]) +
         t * t * ((1 + 2 * s) * y_[i + 1] - s * h * slope_[i + 1]);
}

double MonotoneCubic::integral() const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
    const double h = x_[i + 1] - x_[i];
    sum += h * ((y_[i] + y_[i + 1]) / 2 + h * (slope_[i] - slope_[i + 1]) / 12);
  }
  return sum;
}

}  // namespace roughmesh::detail
