// SPDX-License-Identifier: BSD-3-Clause
// The inner loop of the method `lattice`: kernel weights, and sums of noise under them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "roughmesh/mesh.hpp"

#include "lattice_axis.hpp"

namespace roughmesh::detail {

/// Numbers that vector loads may reach beyond the last point of a kernel along the third axis.
constexpr int gather_padding = 8;

/// Where the kernel at a place meets the lattice of an axis: weights of the points first,
/// first + 1, ...; zero beyond the kernel.
struct AxisWeights {
  std::int64_t first = 0;
  alignas(64) std::array<double, most_lattice_points + gather_padding> weight{};
};

/// The weights that gather() uses.
AxisWeights kernel_weights(const LatticeAxis& axis, double x);
void kernel_weights(const LatticeAxis& axis, std::span<const double> places,
                    std::span<AxisWeights> result);

/// Values on a box of lattice points, the third axis contiguous. After the last value there is room
/// for gather_padding numbers, which are finite.
struct LatticeBox {
  std::array<std::int64_t, 3> first{};  ///< index of its first point along each axis
  std::array<std::int64_t, 3> size{};
  double* values = nullptr;

  double* column(std::int64_t x, std::int64_t y) const {  ///< counted from `first`
    return values + (x * size[1] + y) * size[2];
  }
};

/// heights[i] += factor times the sum of the box under the kernel at places[i], for each i of
/// `members`.
void gather(const std::array<LatticeAxis, 3>& axes, const LatticeBox& box, double factor,
            std::span<const std::uint32_t> members, const Vec3* places, double* heights);

}  // namespace roughmesh::detail
