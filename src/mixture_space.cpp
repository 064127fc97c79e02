// SPDX-License-Identifier: BSD-3-Clause
#include "mixture_space.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "periodic_bell.hpp"

namespace roughmesh::detail {

// Streaks have axes along which nothing changes.
MixtureSpace::MixtureSpace(const Distance& distance) : distance_(distance) {
  if (distance.kind() != DistanceKind::euclidean && distance.kind() != DistanceKind::periodic)
    throw InputError(
        fmt::format("--distance {} has no Gaussian mixture: it is not positive definite; choose "
                    "--distance euclidean or periodic, or --method cholesky",
                    name(distance.kind())));
  bool has_free_axis = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double period = distance.period()[axis];
    if (period == 0)
      has_free_axis = has_free_axis || distance.stretch().col(axis).any();
    else if (distance.stretch()(axis, axis) != 0)
      periods_.push_back(period * std::abs(distance.stretch()(axis, axis)));
  }
  if (has_free_axis) periods_.push_back(0);
}

int MixtureSpace::n_periodic_axes() const {
  return static_cast<int>(
      std::count_if(periods_.begin(), periods_.end(), [](double period) { return period > 0; }));
}

MixtureSpace::Coordinates MixtureSpace::coordinates(const Vec3& displacement) const {
  Vec3 stretched = distance_.stretch() * displacement;
  Coordinates result{};
  std::size_t next = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double period = distance_.period()[axis] * std::abs(distance_.stretch()(axis, axis));
    if (period == 0) continue;
    result[next++] = std::abs(std::remainder(stretched[axis], period));
    stretched[axis] = 0;
  }
  if (next < n_axes()) result[next] = stretched.norm();
  return result;
}

double MixtureSpace::images(std::size_t axis, double coordinate, double scale) const {
  const double period = periods_[axis];
  return period > 0 ? periodic_bell(coordinate, period, scale) : bell(coordinate, scale);
}

double MixtureSpace::gaussian(const Coordinates& x, double scale) const {
  double product = 1;
  for (std::size_t axis = 0; axis < n_axes(); ++axis)
    if (x[axis] > 0) product *= images(axis, x[axis], scale) / images(axis, 0, scale);
  return product;
}

std::vector<GaussianTerm> MixtureSpace::shares(std::span<const GaussianTerm> terms) const {
  std::vector<GaussianTerm> result(terms.begin(), terms.end());
  double total = 1;
  for (GaussianTerm& term : result) {
    double images_at_0 = 1;
    for (std::size_t axis = 0; axis < n_axes(); ++axis) images_at_0 *= images(axis, 0, term.scale);
    total += term.weight * (images_at_0 - 1);
    term.weight *= images_at_0;
  }
  for (GaussianTerm& term : result) term.weight /= total;
  return result;
}

}  // namespace roughmesh::detail
