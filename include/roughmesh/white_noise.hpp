// SPDX-License-Identifier: BSD-3-Clause
// Normal random numbers as a pure function of (seed, realization, key).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace roughmesh {

/// Which stream of numbers; equal streams give equal numbers on every machine and thread.
struct NoiseStream {
  std::uint64_t seed = 0;
  std::uint64_t realization = 0;
};

/// The `key`-th standard normal number of a stream: independent over seeds, realizations and keys.
/// Philox-4x64-10 with key (seed, realization) and counter key / 4, then Box-Muller on its four
/// words. Source: Salmon et al. (2011), SC '11, doi:10.1145/2063384.2063405.
double white_noise(const NoiseStream& stream, std::uint64_t key);

/// white_noise(stream, key) for key = 0 .. n - 1, four numbers for the price of one.
std::vector<double> white_noise_sequence(const NoiseStream& stream, std::size_t n);

/// The random bits below: four words of Philox-4x64-10, for known-answer tests.
std::array<std::uint64_t, 4> random_words(const NoiseStream& stream,
                                          const std::array<std::uint64_t, 4>& counter);

}  // namespace roughmesh
