// SPDX-License-Identifier: BSD-3-Clause
// One Gaussian of the mixture on its lattice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/white_noise.hpp"

#include "lattice_axis.hpp"
#include "lattice_gather.hpp"
#include "lattice_noise.hpp"
#include "lattice_space.hpp"
#include "scale_mixture.hpp"

namespace roughmesh::detail {

/// White noise on a lattice under a Gaussian kernel: a field of variance `weight` and covariance
/// weight exp(-r^2 / (2 scale^2)), up to `error` (docs/math.md, eq. 47).
struct LatticeLevel {
  std::int32_t key = 0;  ///< of its noise
  double scale = 0;
  double weight = 0;
  double error = 0;
  std::array<LatticeAxis, 3> axes;
};

/// Appends the runs of noise of `n` points along the third axis, from the point `first` on: several
/// where they go round a period.
void append_runs(const std::array<LatticeAxis, 3>& axes, const std::array<std::int64_t, 3>& first,
                 std::int64_t n, double* values, std::vector<NoiseRun>& runs);

/// Levels whose errors add up to at most `error`, with as little work as that takes.
/// @param distance  typical one of neighbours, which decides how many places share a lattice point;
///                  0: many
/// @throws InputError  an error too small for any kernel
std::vector<LatticeLevel> make_levels(std::span<const MixtureTerm> terms, const LatticeSpace& space,
                                      double error, double distance);

/// Edge of the cells that add_level() works on at a time, in lattice spacings. In space the box of
/// a cell is larger than the cache of a core, but the columns that a surface marks in it are not:
/// the larger the cell, the less often neighbours make the same noise.
constexpr double cell_points(int n_axes) { return n_axes == 3 ? 72 : n_axes == 2 ? 128 : 4096; }

/// Adds the level to the heights, in the order before sorting, of the sorted places i with
/// n_skipped[i] <= number.
void add_level(const LatticeLevel& level, const NoiseStream& stream, const SortedPlaces& places,
               std::span<const std::uint8_t> n_skipped, int number, std::span<double> heights);

/// Covariance that add_level() gives two places.
double level_covariance(const LatticeLevel& level, const Vec3& x, const Vec3& y);

}  // namespace roughmesh::detail
