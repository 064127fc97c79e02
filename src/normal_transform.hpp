// SPDX-License-Identifier: BSD-3-Clause
// Random bits to normal numbers.
#pragma once

#include <array>
#include <cstdint>

namespace roughmesh::detail {

/// Two independent standard normal numbers from two independent words of 64 random bits: the
/// transform of Box and Muller (docs/math.md, eq. 23). Finite for every pair of words: at most
/// sqrt(106 ln 2) = 8.6 in magnitude.
std::array<double, 2> box_muller(std::uint64_t radius_word, std::uint64_t angle_word);

}  // namespace roughmesh::detail
