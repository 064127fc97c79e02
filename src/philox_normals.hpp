// SPDX-License-Identifier: BSD-3-Clause
// Philox4x32 and the transform of Box and Muller on the vector registers of the processor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace roughmesh::detail {

/// Blocks of four numbers that are made in one go.
inline constexpr std::size_t philox_capacity = 128;

/// One number for every block, as wide as a lane of the registers.
using PhiloxLanes = std::array<std::uint64_t, philox_capacity>;

/// Counters of blocks and the key that they share; of two words in one number, the first is the low
/// half.
struct PhiloxCounters {
  alignas(64) PhiloxLanes first_and_second{};
  alignas(64) PhiloxLanes third_and_fourth{};
  std::uint64_t key = 0;
};

/// The four words of the blocks, in the low halves; the high halves are not defined.
struct PhiloxWords {
  alignas(64) std::array<PhiloxLanes, 4> lanes;
};

/// Four numbers a block, block after block.
struct BlockNormals {
  alignas(64) std::array<double, 4 * philox_capacity> values;
};

/// Philox4x32-10 of the first n_blocks counters; the words of the other blocks are not defined.
void philox_words(const PhiloxCounters& counters, std::size_t n_blocks, PhiloxWords& words);

/// Box-Muller on words 0, 1 and 2, 3 of the first n_blocks blocks (docs/math.md, eq. 46). Relative
/// error below 6e-16; the last bits depend on the processor, but not on n_blocks or other blocks.
void block_normals(const PhiloxWords& words, std::size_t n_blocks, BlockNormals& normals);

}  // namespace roughmesh::detail
