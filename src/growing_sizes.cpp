// SPDX-License-Identifier: BSD-3-Clause
#include "growing_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace roughmesh::detail {
namespace {

using Place3 = std::array<int, 3>;

struct Lattice {
  Vec3 corner;
  double spacing;
  Place3 n;  // points along each axis, at least 2

  std::size_t number(const Place3& p) const {
    return static_cast<std::size_t>(p[0]) +
           static_cast<std::size_t>(n[0]) *
               (static_cast<std::size_t>(p[1]) +
                static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(p[2]));
  }
  std::size_t size() const {
    return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) *
           static_cast<std::size_t>(n[2]);
  }
  Vec3 place(const Place3& p) const { return corner + spacing * Vec3(p[0], p[1], p[2]); }
  Place3 cell_of(const Vec3& x) const {
    Place3 p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      p[k] = std::clamp(static_cast<int>((x[i] - corner[i]) / spacing), 0, n[k] - 2);
    }
    return p;
  }
  template <class Visit>
  void for_each(const Place3& first, const Place3& last, Visit&& visit) const {
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i) visit(Place3{i, j, k});
  }
  Place3 last() const { return {n[0] - 1, n[1] - 1, n[2] - 1}; }
};

Lattice lattice_over(std::span<const Vec3> places) {
  constexpr int cells = 32;
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  Lattice lattice{box.min(), box.sizes().maxCoeff() / cells, {}};
  // A layer around, so that what bulges out of the box has a size too.
  lattice.corner -= Vec3::Constant(lattice.spacing);
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = box.sizes()[static_cast<Eigen::Index>(k)];
    lattice.n[k] = static_cast<int>(std::ceil(side / lattice.spacing)) + 3;
  }
  return lattice;
}

// Sizes at the corners of the cells of the places, from these.
std::vector<double> sizes_beside(const Lattice& lattice, std::span<const Vec3> places,
                                 std::span<const double> sizes) {
  std::vector<double> result(lattice.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place3 first = lattice.cell_of(places[i]);
    lattice.for_each(first, {first[0] + 1, first[1] + 1, first[2] + 1}, [&](const Place3& p) {
      double& size = result[lattice.number(p)];
      size = std::min(size, sizes[i] + growth * (lattice.place(p) - places[i]).norm());
    });
  }
  return result;
}

// From neighbour to neighbour, by sweeps in both directions until nothing changes: two of each do
// for most surfaces.
void spread(const Lattice& lattice, std::vector<double>& sizes) {
  bool is_changed = true;
  const auto update = [&](const Place3& p) {
    double& size = sizes[lattice.number(p)];
    const Place3 last = lattice.last();
    Place3 low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::max(p[k] - 1, 0);
      high[k] = std::min(p[k] + 1, last[k]);
    }
    lattice.for_each(low, high, [&](const Place3& q) {
      const double step = std::sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                                    (p[2] - q[2]) * (p[2] - q[2]));
      const double other = sizes[lattice.number(q)] + growth * lattice.spacing * step;
      if (other >= size) return;
      size = other;
      is_changed = true;
    });
  };
  while (is_changed) {
    is_changed = false;
    const Place3 last = lattice.last();
    lattice.for_each({0, 0, 0}, last, update);
    lattice.for_each({0, 0, 0}, last, [&](const Place3& p) {
      update({last[0] - p[0], last[1] - p[1], last[2] - p[2]});
    });
  }
}

}  // namespace

SizeMap growing_sizes(std::span<const Vec3> places, std::span<const double> sizes) {
  const Lattice lattice = lattice_over(places);
  SizeMap map;
  map.sizes = sizes_beside(lattice, places, sizes);
  spread(lattice, map.sizes);
  lattice.for_each({0, 0, 0}, lattice.last(),
                   [&](const Place3& p) { map.places.push_back(lattice.place(p)); });
  const Place3 last = lattice.last();
  lattice.for_each({0, 0, 0}, {last[0] - 1, last[1] - 1, last[2] - 1}, [&](const Place3& p) {
    auto& cell = map.hexahedra.emplace_back();
    constexpr std::array<Place3, 8> corners = {
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    for (std::size_t c = 0; c < corners.size(); ++c)
      cell[c] = static_cast<Index>(
          lattice.number({p[0] + corners[c][0], p[1] + corners[c][1], p[2] + corners[c][2]}));
  });
  return map;
}

}  // namespace roughmesh::detail
