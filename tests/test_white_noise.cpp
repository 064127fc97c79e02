// SPDX-License-Identifier: BSD-3-Clause
// The bits are Philox's, the numbers are normal and independent over seeds, realizations and keys.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/white_noise.hpp"

#include "normal_transform.hpp"

namespace roughmesh {
namespace {

using Words = std::array<std::uint64_t, 4>;

constexpr std::uint64_t all_ones = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t n_numbers = 400'000;

/// Mean of a function of k and of the number of key k.
template <class Function>
double mean(const std::vector<double>& numbers, const Function& function) {
  double sum = 0;
  for (const double z : numbers) sum += function(z);
  return sum / static_cast<double>(numbers.size());
}

/// Mean of a_k b_(k + lag): zero with standard error 1 / sqrt(n) if both are independent and have
/// zero mean and unit variance.
double correlation(const std::vector<double>& a, const std::vector<double>& b,
                   std::size_t lag = 0) {
  double sum = 0;
  for (std::size_t k = 0; k + lag < a.size(); ++k) sum += a[k] * b[k + lag];
  return sum / static_cast<double>(a.size() - lag);
}

// Random123 distributes these for philox4x64 with 10 rounds (tests/kat_vectors).
TEST(RandomWords, EqualThePublishedVectors) {
  EXPECT_EQ(random_words({0, 0}, {0, 0, 0, 0}), (Words{0x16554d9eca36314c, 0xdb20fe9d672d0fdc,
                                                       0xd7e772cee186176b, 0x7e68b68aec7ba23b}));
  EXPECT_EQ(
      random_words({all_ones, all_ones}, {all_ones, all_ones, all_ones, all_ones}),
      (Words{0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}));
  EXPECT_EQ(
      random_words(
          {0x452821e638d01377, 0xbe5466cf34e90c6c},
          {0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89}),
      (Words{0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}));
}

// The definition once more, in the textbook's form. The radius is at most 8.6 and the angle, below
// 2 pi, is rounded to 4.4e-16 here, so the two forms differ by less than 8.6 * 1e-15.
TEST(WhiteNoise, IsBoxMullerOfTheWords) {
  for (std::uint64_t block = 0; block < 1000; ++block) {
    const NoiseStream stream{7, 3};
    const Words words = random_words(stream, {block, 0, 0, 0});
    for (std::uint64_t pair = 0; pair < 2; ++pair) {
      const double u = (static_cast<double>(words[2 * pair] >> 11) + 1) / 0x1p53;
      const double v = static_cast<double>(words[2 * pair + 1] >> 11) / 0x1p53;
      const double radius = std::sqrt(-2 * std::log(u)), angle = 2 * std::numbers::pi * v;
      EXPECT_NEAR(white_noise(stream, 4 * block + 2 * pair), radius * std::cos(angle), 1e-14);
      EXPECT_NEAR(white_noise(stream, 4 * block + 2 * pair + 1), radius * std::sin(angle), 1e-14);
    }
  }
}

TEST(WhiteNoise, SequenceEqualsRandomAccess) {
  for (const std::size_t n : {0, 1, 2, 3, 4, 5, 1003}) {
    const NoiseStream stream{n, 12};
    const std::vector<double> sequence = white_noise_sequence(stream, n);
    ASSERT_EQ(sequence.size(), n);
    for (std::size_t key = 0; key < n; ++key) EXPECT_EQ(sequence[key], white_noise(stream, key));
  }
}

TEST(WhiteNoise, EndsOfTheKeysAndStreamsAreFinite) {
  for (const std::uint64_t seed : {std::uint64_t{0}, all_ones})
    for (const std::uint64_t key : {std::uint64_t{0}, all_ones - 1, all_ones})
      EXPECT_TRUE(std::isfinite(white_noise({seed, all_ones}, key)));
}

// 53 bits: the smallest u is 2^-53, so that the radius is at most sqrt(2 * 53 ln 2); u = 1 gives 0.
TEST(BoxMuller, ExtremeWordsGiveFiniteNumbers) {
  const double largest = std::sqrt(106 * std::numbers::ln2);
  for (const std::uint64_t angle : {std::uint64_t{0}, std::uint64_t{1} << 62,
                                    std::uint64_t{1} << 63, std::uint64_t{3} << 62, all_ones}) {
    const auto [x, y] = detail::box_muller(0, angle);
    EXPECT_NEAR(std::hypot(x, y), largest, 1e-14);
    const auto [zero_x, zero_y] = detail::box_muller(all_ones, angle);
    EXPECT_EQ(std::abs(zero_x), 0);
    EXPECT_EQ(std::abs(zero_y), 0);
  }
}

// Quarter turns are exact: no rounded pi enters.
TEST(BoxMuller, QuarterTurnsAreExact) {
  const double r = detail::box_muller(0, 0)[0];
  for (std::uint64_t quarter = 0; quarter < 4; ++quarter) {
    const auto [x, y] = detail::box_muller(0, quarter << 62);
    EXPECT_EQ(x, quarter == 0 ? r : quarter == 2 ? -r : 0);
    EXPECT_EQ(y, quarter == 1 ? r : quarter == 3 ? -r : 0);
  }
}

// E[z^k] = 0, 1, 0, 3 and Var[z^k] = E[z^2k] - E[z^k]^2 = 1, 2, 15, 96 for k = 1..4. Five standard
// errors: p < 6e-7 for each.
TEST(WhiteNoise, HasTheMomentsOfTheNormalDistribution) {
  const double root_n = std::sqrt(static_cast<double>(n_numbers));
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::vector<double> z = white_noise_sequence({seed, 0}, n_numbers);
    EXPECT_NEAR(mean(z, [](double x) { return x; }), 0, 5 / root_n);
    EXPECT_NEAR(mean(z, [](double x) { return x * x; }), 1, 5 * std::sqrt(2.0) / root_n);
    EXPECT_NEAR(mean(z, [](double x) { return x * x * x; }), 0, 5 * std::sqrt(15.0) / root_n);
    EXPECT_NEAR(mean(z, [](double x) { return x * x * x * x; }), 3, 5 * std::sqrt(96.0) / root_n);
  }
}

// The sum over m equally likely bins of (count - expected)^2 / expected has mean m - 1 and variance
// 2 (m - 1), and is nearly normal for m = 256.
TEST(WhiteNoise, FillsEquallyLikelyBinsEvenly) {
  constexpr int n_bins = 256;
  std::array<double, n_bins> counts{};
  for (const double z : white_noise_sequence({1, 1}, n_numbers)) {
    const double probability = 0.5 * std::erfc(-z / std::numbers::sqrt2);
    ++counts[static_cast<std::size_t>(std::min(n_bins - 1.0, n_bins * probability))];
  }
  const double expected = static_cast<double>(n_numbers) / n_bins;
  double chi_square = 0;
  for (const double count : counts)
    chi_square += (count - expected) * (count - expected) / expected;
  EXPECT_NEAR(chi_square, n_bins - 1, 5 * std::sqrt(2.0 * (n_bins - 1)));
}

// Lags 1 to 3 are the neighbours within a block of four. The squares, which the two numbers of a
// Box-Muller pair would share if the radius were used alone, have mean 1 and variance 2.
TEST(WhiteNoise, KeysAreUncorrelatedAndSoAreTheirSquares) {
  const std::vector<double> z = white_noise_sequence({2, 5}, n_numbers);
  std::vector<double> squares;
  for (const double x : z) squares.push_back((x * x - 1) / std::numbers::sqrt2);
  const double bound = 5 / std::sqrt(static_cast<double>(n_numbers));
  for (std::size_t lag = 1; lag <= 16; ++lag) {
    EXPECT_NEAR(correlation(z, z, lag), 0, bound) << "lag " << lag;
    EXPECT_NEAR(correlation(squares, squares, lag), 0, bound) << "lag " << lag;
  }
}

// 200 correlations of 4,096 numbers each: beyond five standard errors once in 8,700 such tests.
TEST(WhiteNoise, AdjacentSeedsAndRealizationsAreUncorrelated) {
  constexpr std::size_t n = 4096;
  const double bound = 5 / std::sqrt(static_cast<double>(n));
  double mean_of_seeds = 0;
  for (std::uint64_t s = 0; s <= 200; ++s) {
    const std::vector<double> z = white_noise_sequence({s, 0}, n);
    EXPECT_NEAR(correlation(z, white_noise_sequence({s + 1, 0}, n)), 0, bound) << "seed " << s;
    EXPECT_NEAR(correlation(white_noise_sequence({0, s}, n), white_noise_sequence({0, s + 1}, n)),
                0, bound)
        << "realization " << s;
    mean_of_seeds += mean(z, [](double x) { return x; }) / 201;
  }
  EXPECT_NEAR(mean_of_seeds, 0, 5 / std::sqrt(201.0 * n));
}

// A seed and a realization are two numbers, not their sum or another mixture.
TEST(WhiteNoise, SeedAndRealizationMayNotBeExchanged) {
  constexpr std::size_t n = 4096;
  const double bound = 5 / std::sqrt(static_cast<double>(n));
  const std::vector<double> z = white_noise_sequence({3, 4}, n);
  EXPECT_NEAR(correlation(z, white_noise_sequence({4, 3}, n)), 0, bound);
  EXPECT_NEAR(correlation(z, white_noise_sequence({2, 5}, n)), 0, bound);
  EXPECT_NEAR(correlation(z, z), 1, 5 * std::sqrt(2.0 / n));
}

}  // namespace
}  // namespace roughmesh
