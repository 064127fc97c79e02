// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <Random123/philox.h>

#include "philox_normals.hpp"

namespace roughmesh::detail {
namespace {

/// The third counter word of `random_words` for these keys; all other uses have 0 there.
constexpr std::uint64_t lattice_tag = 3;

/// An index, moved by 2^31 so that its high word does not change at zero.
std::uint64_t biased(std::int64_t index) {
  return static_cast<std::uint64_t>(index) + (std::uint64_t{1} << 31);
}

std::uint32_t high_word(std::uint64_t index) { return static_cast<std::uint32_t>(index >> 32); }
std::uint32_t low_word(std::uint64_t index) { return static_cast<std::uint32_t>(index); }

/// As std::copy_n, but without a call for a few numbers: the last four may be copied twice.
void copy(const double* from, std::size_t n, double* to) {
  constexpr std::size_t four = 4 * sizeof(double);
  if (n < 4) {
    for (std::size_t k = 0; k < n; ++k) to[k] = from[k];
    return;
  }
  for (std::size_t k = 0; k + 4 < n; k += 4) std::memcpy(to + k, from + k, four);
  std::memcpy(to + n - 4, from + n - 4, four);
}

/// Number `which` of eq. 46 from two of the words; 0 is the cosine, 1 the sine.
double box_muller_number(std::uint32_t radius_word, std::uint32_t angle_word, int which) {
  const double u = (radius_word + 0.5) * 0x1p-32;
  const double radius = std::sqrt(-2 * std::log(u));
  // Quarter turns come off exactly, so that the mathematics library sees at most pi/4.
  const std::uint32_t turn = angle_word + (std::uint32_t{1} << 29);
  const auto rest = static_cast<std::int32_t>(turn & 0x3FFFFFFF) - (std::int32_t{1} << 29);
  const double angle = std::numbers::pi * 0x1p-31 * (rest + 0.5);
  const int quarter = (static_cast<int>(turn >> 30) + 3 * which) % 4;  // sin a = cos(a - pi/2)
  const double part = quarter % 2 == 0 ? std::cos(angle) : std::sin(angle);
  return quarter == 1 || quarter == 2 ? -radius * part : radius * part;
}

/// Numbers of one run in consecutive blocks; `from` counts numbers.
struct Piece {
  double* to;
  std::size_t from, n;
};

}  // namespace

/// Blocks of four that wait until there are enough of them, and where their numbers belong.
class LatticeNoise::Batch {
 public:
  /// Apart from the counts of the batch, which so stay in registers.
  struct Memory {
    PhiloxCounters counters;
    PhiloxWords words;
    BlockNormals normals;
    std::array<Piece, philox_capacity> pieces;
  };

  Batch(const LatticeNoise& noise, Memory& memory) : noise_(noise), memory_(memory) {}

  void add(const NoiseRun& run) {
    for (std::int32_t done = 0; done < run.n;) done += add_some(run, done);
  }

  void flush() {
    make_numbers(memory_, n_blocks_, n_pieces_);
    n_blocks_ = n_pieces_ = 0;
  }

 private:
  static void make_numbers(Memory& memory, std::size_t n_blocks, std::size_t n_pieces);

  /// Takes the points of the run from `done` on, as many as have room and one key; their number.
  std::int32_t add_some(const NoiseRun& run, std::int32_t done) {
    const std::int64_t z = run.z + done, crop = z & 3, left = std::int64_t{run.n} - done;
    const std::uint64_t x = biased(run.x), y = biased(run.y), block = biased(z >> 2);
    use_key(noise_.key({high_word(x), high_word(y), high_word(block)}));
    const std::int64_t room = static_cast<std::int64_t>(philox_capacity - n_blocks_);
    const std::int64_t one_key = (std::int64_t{1} << 32) - low_word(block);
    const std::int64_t n_blocks = std::min({(crop + left + 3) >> 2, room, one_key});
    const std::int64_t n = std::min(4 * n_blocks - crop, left);
    memory_.pieces[n_pieces_++] = {run.values + done, 4 * n_blocks_ + crop,
                                   static_cast<std::size_t>(n)};
    append(low_word(x) | y << 32, low_word(block), static_cast<std::size_t>(n_blocks));
    return static_cast<std::int32_t>(n);
  }

  void use_key(std::uint64_t key) {
    if (key != key_ || n_blocks_ == philox_capacity) flush();
    key_ = memory_.counters.key = key;
  }

  void append(std::uint64_t first_and_second, std::uint64_t third, std::size_t n_blocks) {
    for (std::size_t k = 0; k < n_blocks; ++k) {
      memory_.counters.first_and_second[n_blocks_ + k] = first_and_second;
      memory_.counters.third_and_fourth[n_blocks_ + k] = third + k;
    }
    n_blocks_ += n_blocks;
  }

  const LatticeNoise& noise_;
  Memory& memory_;
  std::uint64_t key_ = 0;
  std::size_t n_blocks_ = 0, n_pieces_ = 0;
};

void LatticeNoise::Batch::make_numbers(Memory& memory, std::size_t n_blocks, std::size_t n_pieces) {
  if (n_blocks == 0) return;
  philox_words(memory.counters, n_blocks, memory.words);
  block_normals(memory.words, n_blocks, memory.normals);
  for (std::size_t k = 0; k < n_pieces; ++k)
    copy(&memory.normals.values[memory.pieces[k].from], memory.pieces[k].n, memory.pieces[k].to);
}

LatticeNoise::LatticeNoise(const NoiseStream& stream, std::int32_t level)
    : stream_(stream), level_(level), home_key_(computed_key({0, 0, 0})) {}

std::uint64_t LatticeNoise::computed_key(const HighWords& high) const {
  const std::uint64_t level = static_cast<std::uint32_t>(level_);
  return random_words(
      stream_, {high[0] | std::uint64_t{high[1]} << 32, high[2] | level << 32, lattice_tag, 0})[0];
}

std::uint64_t LatticeNoise::key(const HighWords& high) const {
  return (high[0] | high[1] | high[2]) == 0 ? home_key_ : computed_key(high);
}

double LatticeNoise::operator()(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const std::uint64_t bx = biased(x), by = biased(y), block = biased(z >> 2);
  const std::uint64_t k = key({high_word(bx), high_word(by), high_word(block)});
  using Philox = r123::Philox4x32_R<10>;
  const Philox::ctr_type words =
      Philox{}(Philox::ctr_type{{low_word(bx), low_word(by), low_word(block), 0}},
               Philox::key_type{{low_word(k), high_word(k)}});
  const auto pair = static_cast<std::size_t>(z & 2);
  return box_muller_number(words[pair], words[pair + 1], static_cast<int>(z & 1));
}

void LatticeNoise::fill(std::span<const NoiseRun> runs) const {
  Batch::Memory memory;
  Batch batch(*this, memory);
  for (const NoiseRun& run : runs) batch.add(run);
  batch.flush();
}

}  // namespace roughmesh::detail
