// SPDX-License-Identifier: BSD-3-Clause
// White noise on the points of a lattice without end.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "roughmesh/white_noise.hpp"

namespace roughmesh::detail {

/// A run of lattice points along the third axis: values[k] belongs to the point (x, y, z + k).
struct NoiseRun {
  std::int64_t x = 0, y = 0, z = 0;
  std::int32_t n = 0;
  double* values = nullptr;
};

/// Standard normal numbers w(x, y, z) of one lattice of a field (docs/math.md, eq. 46): a pure
/// function of (seed, realization, level, x, y, z). At most sqrt(66 ln 2) = 6.8 in magnitude.
class LatticeNoise {
 public:
  LatticeNoise(const NoiseStream& stream, std::int32_t level);

  /// One number, by the mathematics library: the reference for `fill`.
  double operator()(std::int64_t x, std::int64_t y, std::int64_t z) const;

  /// The same numbers to 1e-15 of their size, on the vector registers of the processor. Last bits
  /// may differ between processors, never between calls, partitions into runs or threads. Runs may
  /// be of any length; give many short ones in one call. Indices are at most 2^62 in magnitude.
  void fill(std::span<const NoiseRun> runs) const;

 private:
  /// High words of the three indices of a block: zero up to 2^31 points from the origin, 2^33 in z.
  using HighWords = std::array<std::uint32_t, 3>;
  class Batch;

  std::uint64_t key(const HighWords& high) const;
  std::uint64_t computed_key(const HighWords& high) const;

  NoiseStream stream_;
  std::int32_t level_;
  std::uint64_t home_key_;  ///< of high words all zero
};

}  // namespace roughmesh::detail
