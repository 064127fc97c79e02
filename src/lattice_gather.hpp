// SPDX-License-Identifier: BSD-3-Clause
// The inner loop of the method `lattice`: kernel weights, and sums of noise under them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "roughmesh/mesh.hpp"

#include "lattice_axis.hpp"

namespace roughmesh::detail {

/// Doubles of the longest vector register in use, and of a cache line: columns begin at multiples
/// of it, so that no load straddles two lines.
constexpr int gather_lanes = 8;

/// Where the kernel at a place meets the lattice of an axis: weights of the points first,
/// first + 1, ...; zero beyond the kernel.
struct AxisWeights {
  std::int64_t first = 0;
  alignas(64) std::array<double, most_lattice_points + gather_lanes> weight{};
};

/// The weights that gather() uses.
AxisWeights kernel_weights(const LatticeAxis& axis, double x);
void kernel_weights(const LatticeAxis& axis, std::span<const double> places,
                    std::span<AxisWeights> result);

/// Values on a box of lattice points, the third axis contiguous. A column takes column_length()
/// numbers, those behind its last point without meaning, but finite: an odd number of cache lines,
/// so that neighbouring columns do not drive each other out of a cache.
struct LatticeBox {
  std::array<std::int64_t, 3> first{};  ///< index of its first point along each axis
  std::array<std::int64_t, 3> size{};
  double* values = nullptr;  ///< n_values() of them, aligned to 8 * gather_lanes bytes

  std::int64_t column_length() const {
    return ((size[2] + gather_lanes - 1) / gather_lanes | 1) * gather_lanes;
  }
  std::int64_t n_values() const { return size[0] * size[1] * column_length(); }
  double* column(std::int64_t x, std::int64_t y) const {  ///< counted from `first`
    return values + (x * size[1] + y) * column_length();
  }
};

/// Where the columns of a box that needs this point begin: where a kernel stands among the lanes of
/// a vector, and so the last bit of a sum, then depends on its place alone.
constexpr std::int64_t first_of_column(std::int64_t point) {
  return point - (point % gather_lanes + gather_lanes) % gather_lanes;
}

/// sums[m] = sum of the box under the kernel at places[members[m]], for each m.
void gather(const std::array<LatticeAxis, 3>& axes, const LatticeBox& box,
            std::span<const std::uint32_t> members, const Vec3* places, double* sums);

}  // namespace roughmesh::detail
