// SPDX-License-Identifier: BSD-3-Clause
#include "size_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roughmesh::detail {
namespace {

using Point = std::array<int, 3>;

constexpr double unknown = std::numeric_limits<double>::infinity();

Point last_of(const SizeLattice& lattice) {
  return {lattice.n[0] - 1, lattice.n[1] - 1, lattice.n[2] - 1};
}

template <class Visit>
void for_each(const Point& first, const Point& last, Visit&& visit) {
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int k = first[2]; k <= last[2]; ++k) visit(Point{i, j, k});
}

/// @param cells  along the longest side
SizeLattice lattice_over(std::span<const Vec3> places, int cells) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  SizeLattice lattice{box.min(), box.sizes().maxCoeff() / cells, {}, {}};
  std::size_t size = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = box.sizes()[static_cast<Eigen::Index>(k)];
    lattice.n[k] = static_cast<int>(std::ceil(side / lattice.spacing)) + 2;
    size *= static_cast<std::size_t>(lattice.n[k]);
  }
  lattice.sizes.assign(size, unknown);
  return lattice;
}

// Calls visit(point, weight in linear interpolation) for the corners of the cell around a place.
template <class Visit>
void for_each_corner(const SizeLattice& lattice, const Vec3& x, Visit&& visit) {
  const Vec3 steps = (x - lattice.corner) / lattice.spacing;
  Point first{};
  for (std::size_t k = 0; k < 3; ++k)
    first[k] =
        std::clamp(static_cast<int>(steps[static_cast<Eigen::Index>(k)]), 0, lattice.n[k] - 2);
  for_each(first, {first[0] + 1, first[1] + 1, first[2] + 1}, [&](const Point& p) {
    double weight = 1;
    for (std::size_t k = 0; k < 3; ++k)
      weight *= 1 - std::abs(steps[static_cast<Eigen::Index>(k)] - p[k]);
    visit(p, weight);
  });
}

// From neighbour to neighbour, by sweeps in both directions until nothing changes: two of each do
// for most surfaces.
/// @param is_fixed  of points that keep their size
void spread(const std::vector<std::uint8_t>& is_fixed, SizeLattice& lattice) {
  const double step = growth * lattice.spacing;
  const std::array<double, 4> steps = {0, step, step * std::sqrt(2.0), step * std::sqrt(3.0)};
  const Point last = last_of(lattice);
  bool is_changed = true;
  const auto update = [&](const Point& p) {
    const std::size_t number = lattice.number(p);
    if (is_fixed[number] != 0) return;
    double& size = lattice.sizes[number];
    Point low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::max(p[k] - 1, 0);
      high[k] = std::min(p[k] + 1, last[k]);
    }
    for_each(low, high, [&](const Point& q) {
      const int n_axes = (p[0] != q[0] ? 1 : 0) + (p[1] != q[1] ? 1 : 0) + (p[2] != q[2] ? 1 : 0);
      const double other =
          lattice.sizes[lattice.number(q)] + steps[static_cast<std::size_t>(n_axes)];
      if (other >= size) return;
      size = other;
      is_changed = true;
    });
  };
  while (is_changed) {
    is_changed = false;
    for_each({0, 0, 0}, last, update);
    for_each({0, 0, 0}, last, [&](const Point& p) {
      update({last[0] - p[0], last[1] - p[1], last[2] - p[2]});
    });
  }
}

}  // namespace

SizeLattice growing_sizes(std::span<const Vec3> places, std::span<const double> sizes) {
  constexpr int cells = 32;
  SizeLattice lattice = lattice_over(places, cells);
  for (std::size_t i = 0; i < places.size(); ++i)
    for_each_corner(lattice, places[i], [&](const Point& p, double) {
      double& size = lattice.sizes[lattice.number(p)];
      size = std::min(size, sizes[i] + growth * (lattice.place(p) - places[i]).norm());
    });
  spread(std::vector<std::uint8_t>(lattice.sizes.size(), 0), lattice);
  return lattice;
}

SizeLattice mean_sizes(std::span<const Vec3> places, std::span<const double> sizes) {
  constexpr double fewest = 8, most = 96;  // cells: about two for each node along a side
  const double cells = 2 * std::cbrt(static_cast<double>(places.size()));
  SizeLattice lattice = lattice_over(places, static_cast<int>(std::clamp(cells, fewest, most)));
  std::vector<double> weights(lattice.sizes.size(), 0), sums(lattice.sizes.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i)
    for_each_corner(lattice, places[i], [&](const Point& p, double weight) {
      weights[lattice.number(p)] += weight;
      sums[lattice.number(p)] += weight * sizes[i];
    });
  std::vector<std::uint8_t> is_fixed(lattice.sizes.size(), 0);
  constexpr double least = 1e-3;  // of a node at the far corner of a cell
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] < least) continue;
    lattice.sizes[k] = sums[k] / weights[k];
    is_fixed[k] = 1;
  }
  spread(is_fixed, lattice);
  return lattice;
}

}  // namespace roughmesh::detail
