// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/white_noise.hpp"

#include <cmath>
#include <numbers>

#include <Random123/philox.h>

#include "normal_transform.hpp"

namespace roughmesh {
namespace {

constexpr double two_to_minus_53 = 0x1p-53;

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of 2 pi `turn`, turn in [0, 1). Taking off the nearest quarter turn is exact, so
/// that the mathematics library sees angles of at most pi/4, where libraries agree best.
SineCosine sine_cosine_of_turn(double turn) {
  const int quarter = static_cast<int>(std::lround(4 * turn));
  const double angle = 2 * std::numbers::pi * (turn - 0.25 * quarter);
  const double s = std::sin(angle), c = std::cos(angle);
  switch (quarter % 4) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

std::array<double, 4> normal_numbers(const NoiseStream& stream, std::uint64_t block) {
  const std::array<std::uint64_t, 4> words = random_words(stream, {block, 0, 0, 0});
  const auto [a, b] = detail::box_muller(words[0], words[1]);
  const auto [c, d] = detail::box_muller(words[2], words[3]);
  return {a, b, c, d};
}

}  // namespace

namespace detail {

std::array<double, 2> box_muller(std::uint64_t radius_word, std::uint64_t angle_word) {
  // In (0, 1], because the logarithm of 0 is not finite.
  const double u = static_cast<double>((radius_word >> 11) + 1) * two_to_minus_53;
  const double turn = static_cast<double>(angle_word >> 11) * two_to_minus_53;
  const double radius = std::sqrt(-2 * std::log(u));
  const auto [sine, cosine] = sine_cosine_of_turn(turn);
  return {radius * cosine, radius * sine};
}

}  // namespace detail

std::array<std::uint64_t, 4> random_words(const NoiseStream& stream,
                                          const std::array<std::uint64_t, 4>& counter) {
  using Philox = r123::Philox4x64_R<10>;
  const Philox::ctr_type words =
      Philox{}(Philox::ctr_type{{counter[0], counter[1], counter[2], counter[3]}},
               Philox::key_type{{stream.seed, stream.realization}});
  return {words[0], words[1], words[2], words[3]};
}

double white_noise(const NoiseStream& stream, std::uint64_t key) {
  return normal_numbers(stream, key / 4)[key % 4];
}

std::vector<double> white_noise_sequence(const NoiseStream& stream, std::size_t n) {
  std::vector<double> sequence(n);
  for (std::size_t first = 0; first < n; first += 4) {
    const std::array<double, 4> four = normal_numbers(stream, first / 4);
    for (std::size_t lane = 0; lane < 4 && first + lane < n; ++lane)
      sequence[first + lane] = four[lane];
  }
  return sequence;
}

}  // namespace roughmesh
