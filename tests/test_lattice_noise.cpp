// SPDX-License-Identifier: BSD-3-Clause
// The noise of a lattice is Philox's and Box-Muller's on every instruction set of this processor,
// belongs to places and not to runs, and is normal and independent.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include "lattice_noise.hpp"
#include "parallel.hpp"
#include "philox_normals.hpp"
#include "support/instruction_sets.hpp"

namespace roughmesh {
namespace {

using namespace detail;
using test::on_every_instruction_set;
using Block = std::array<std::uint32_t, 4>;
using Point = std::array<std::int64_t, 3>;

constexpr std::int64_t two_to_31 = std::int64_t{1} << 31;
constexpr std::int64_t two_to_32 = std::int64_t{1} << 32;

std::uint64_t joined(std::uint32_t low, std::uint32_t high) {
  return low | std::uint64_t{high} << 32;
}

void set_counter(PhiloxCounters& counters, std::size_t block, const Block& counter) {
  counters.first_and_second[block] = joined(counter[0], counter[1]);
  counters.third_and_fourth[block] = joined(counter[2], counter[3]);
}

Block words_of(const PhiloxWords& words, std::size_t block) {
  Block low{};
  for (std::size_t k = 0; k < 4; ++k) low[k] = static_cast<std::uint32_t>(words.lanes[k][block]);
  return low;
}

Block vector_philox(const Block& counter, std::uint64_t key) {
  PhiloxCounters counters;
  PhiloxWords words;
  counters.key = key;
  set_counter(counters, 0, counter);
  philox_words(counters, 1, words);
  return words_of(words, 0);
}

Block random123(const Block& counter, std::uint64_t key) {
  using Philox = r123::Philox4x32_R<10>;
  const Philox::ctr_type words = Philox{}(
      Philox::ctr_type{{counter[0], counter[1], counter[2], counter[3]}},
      Philox::key_type{{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)}});
  return {words[0], words[1], words[2], words[3]};
}

/// Numbers of the points (x, y, z .. z + n - 1), as one run.
std::vector<double> filled(const LatticeNoise& noise, const Point& point, std::int32_t n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  const NoiseRun run{point[0], point[1], point[2], n, values.data()};
  noise.fill({&run, 1});
  return values;
}

/// Numbers of the n^3 points from `first` on, the third index running fastest.
std::vector<double> cube(const LatticeNoise& noise, const Point& first, std::int32_t n) {
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> values(size * size * size);
  std::vector<NoiseRun> runs;
  for (std::int64_t i = 0; i < n; ++i)
    for (std::int64_t j = 0; j < n; ++j)
      runs.push_back({first[0] + i, first[1] + j, first[2], n,
                      &values[static_cast<std::size_t>(i * n + j) * size]});
  noise.fill(runs);
  return values;
}

/// Mean of a_k b_k: zero with standard error 1 / sqrt(n) if both are independent and have zero mean
/// and unit variance.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / static_cast<double>(a.size());
}

double six_errors(std::size_t n) { return 6 / std::sqrt(static_cast<double>(n)); }

// Random123 distributes these for philox4x32 with 10 rounds (tests/kat_vectors).
TEST(PhiloxWords, EqualThePublishedVectors) {
  constexpr std::uint32_t ones = 0xffffffff;
  on_every_instruction_set([] {
    EXPECT_EQ(vector_philox({0, 0, 0, 0}, 0),
              (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(vector_philox({ones, ones, ones, ones}, joined(ones, ones)),
              (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(vector_philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
                            joined(0xa4093822, 0x299f31d0)),
              (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
  });
}

TEST(PhiloxWords, EqualThoseOfRandom123InEveryLane) {
  on_every_instruction_set([] {
    std::mt19937 generator(1);
    const auto random = [&generator] { return static_cast<std::uint32_t>(generator()); };
    for (std::size_t n_blocks = 1; n_blocks <= philox_capacity; ++n_blocks) {
      PhiloxCounters counters;
      std::array<Block, philox_capacity> blocks{};
      counters.key = joined(random(), random());
      for (std::size_t k = 0; k < n_blocks; ++k)
        set_counter(counters, k, blocks[k] = {random(), random(), random(), random()});
      PhiloxWords words;
      philox_words(counters, n_blocks, words);
      for (std::size_t k = 0; k < n_blocks; ++k)
        ASSERT_EQ(words_of(words, k), random123(blocks[k], counters.key)) << k;
    }
  });
}

/// Box-Muller in long double, quarter turns taken off exactly.
std::array<long double, 2> exact_normals(std::uint32_t radius_word, std::uint32_t angle_word) {
  const long double radius = std::sqrt(-2 * std::log((radius_word + 0.5L) * 0x1p-32L));
  const std::int64_t quarter = (std::int64_t{angle_word} + (1 << 29)) >> 30;
  const auto rest = static_cast<long double>(angle_word - quarter * (1 << 30)) + 0.5L;
  const long double angle = rest * (0x1p-31L * std::numbers::pi_v<long double>);
  const long double c = radius * std::cos(angle), s = radius * std::sin(angle);
  switch (quarter % 4) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

/// Words 0 .. 3 of every block: often close to the ends of their range, where something could
/// break.
PhiloxWords random_words_with_extremes() {
  static std::mt19937_64 random(2);
  PhiloxWords words;
  for (PhiloxLanes& lane : words.lanes)
    for (std::uint64_t& word : lane) {
      word = random();  // the high half is anything
      const std::uint64_t low = random() >> (random() % 64);
      if (random() % 4 == 0) word = (word & 0xffffffff00000000) | (low & 0xffffffff);
      if (random() % 4 == 0) word = ~word;
    }
  return words;
}

/// The bound on the relative error of one number. In units of 2^-53 = 1.1e-16: the logarithm is off
/// by at most 2 and the root halves that; root, cosine or sine and product round by 1 each; without
/// fused multiply-adds, cosine and sine by one more. `long double` can be no longer than double.
constexpr double rounding = 5 * 0x1p-53 + 5 * std::numeric_limits<long double>::epsilon();

void expect_exact(double value, long double exact) {
  ASSERT_LE(std::abs(value - exact), rounding * std::abs(exact)) << value;
}

TEST(BlockNormals, AreBoxMullerOfTheWords) {
  on_every_instruction_set([] {
    for (int repetition = 0; repetition < 200; ++repetition) {
      const PhiloxWords words = random_words_with_extremes();
      BlockNormals normals;
      block_normals(words, philox_capacity, normals);
      for (std::size_t k = 0; k < philox_capacity; ++k) {
        const Block w = words_of(words, k);
        for (std::size_t pair = 0; pair < 4; pair += 2) {
          const auto [first, second] = exact_normals(w[pair], w[pair + 1]);
          expect_exact(normals.values[4 * k + pair], first);
          expect_exact(normals.values[4 * k + pair + 1], second);
        }
      }
    }
  });
}

// u runs from 2^-33 to 1 - 2^-33, so that radii lie between 1.5e-5 and sqrt(66 ln 2); no angle is a
// whole number of quarter turns, so that no number is zero.
TEST(BlockNormals, ExtremeWordsGiveFiniteNumbersOtherThanZero) {
  const double largest = std::sqrt(66 * std::numbers::ln2), smallest = std::sqrt(0x1p-32);
  on_every_instruction_set([&] {
    for (const std::uint64_t angle :
         {0x0, 0x1fffffff, 0x20000000, 0x3fffffff, 0x40000000, 0x7fffffff})
      for (const std::uint64_t flip : {0x0u, 0xffffffffu}) {
        PhiloxWords words;
        for (PhiloxLanes& lane : words.lanes) lane.fill(0);
        words.lanes[2].fill(0xffffffff);
        words.lanes[1].fill(angle ^ flip);
        words.lanes[3].fill(angle ^ flip);
        BlockNormals normals;
        block_normals(words, 1, normals);
        const auto& z = normals.values;
        EXPECT_NEAR(std::hypot(z[0], z[1]), largest, 1e-14);
        EXPECT_NEAR(std::hypot(z[2], z[3]), smallest, 1e-9 * smallest);  // ln(1 - e) = -e - e^2/2
        for (std::size_t k = 0; k < 4; ++k) EXPECT_GT(std::abs(z[k]), 0) << k;
      }
  });
}

// The single value has errors of its own: logarithm 1 (halved), root, angle, its product, cosine or
// sine and product 1 each, which makes 10.5 units of 2^-53 together with the bound above.
TEST(LatticeNoise, VectorsEqualSingleValuesAnywhere) {
  on_every_instruction_set([] {
    std::mt19937_64 random(3);
    const auto index = [&random](int bits) {
      return static_cast<std::int64_t>(random()) >> (64 - bits);
    };
    for (int repetition = 0; repetition < 1000; ++repetition) {
      const int bits = std::array{4, 31, 33, 41, 60}[static_cast<std::size_t>(repetition % 5)];
      const LatticeNoise noise({random(), random() % 3},
                               static_cast<std::int32_t>(random() % 7) - 3);
      const Point p{index(bits), index(bits), index(bits)};
      const auto n = static_cast<std::int32_t>(1 + random() % 40);
      const std::vector<double> run = filled(noise, p, n);
      for (std::int32_t k = 0; k < n; ++k) {
        const double single = noise(p[0], p[1], p[2] + k);
        ASSERT_NEAR(run[static_cast<std::size_t>(k)], single, 10.5 * 0x1p-53 * std::abs(single))
            << p[0] << " " << p[1] << " " << p[2] + k;
      }
    }
  });
}

// The definition once more (docs/math.md, eq. 46), from the documented functions alone.
TEST(LatticeNoise, IsTheDocumentedFunction) {
  const NoiseStream stream{11, 5};
  for (const std::int32_t level : {-3, 0, 7})
    for (const Point& p :
         {Point{0, 0, 0}, Point{-1, 2, -3}, Point{-two_to_31 - 1, two_to_31, 4 * two_to_31},
          Point{std::int64_t{1} << 40, -(std::int64_t{1} << 41), -(std::int64_t{1} << 45) + 2}}) {
      const auto block = static_cast<std::int64_t>(std::floor(static_cast<double>(p[2]) / 4));
      Block low{}, high{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t index = (k < 2 ? p[k] : block) + two_to_31;
        low[k] = static_cast<std::uint32_t>(index);
        high[k] = static_cast<std::uint32_t>(index >> 32);
      }
      const std::uint64_t key = random_words(
          stream,
          {joined(high[0], high[1]), joined(high[2], static_cast<std::uint32_t>(level)), 3, 0})[0];
      const Block words = random123(low, key);
      const auto k = static_cast<std::size_t>(p[2] - 4 * block);
      const auto pair = exact_normals(words[k / 2 * 2], words[k / 2 * 2 + 1]);
      const LatticeNoise noise(stream, level);
      EXPECT_NEAR(noise(p[0], p[1], p[2]), static_cast<double>(pair[k % 2]), 1e-15 * 6.8);
      EXPECT_NEAR(filled(noise, p, 1)[0], static_cast<double>(pair[k % 2]), 1e-15 * 6.8);
    }
}

/// Pieces of random length, in random order, of the run from `first` on.
std::vector<NoiseRun> random_pieces(const Point& first, std::vector<double>& values,
                                    std::mt19937& random) {
  std::vector<NoiseRun> runs;
  for (std::size_t begin = 0; begin < values.size();) {
    const std::size_t n = std::min(values.size() - begin, std::size_t{random() % 23});
    runs.push_back({first[0], first[1], first[2] + static_cast<std::int64_t>(begin),
                    static_cast<std::int32_t>(n), values.data() + begin});
    begin += n;
  }
  std::shuffle(runs.begin(), runs.end(), random);
  return runs;
}

// Runs that cross a change of the key among them: the third index at -2^33 and 2^33.
TEST(LatticeNoise, AnyPartitionIntoRunsGivesTheSameBits) {
  on_every_instruction_set([] {
    std::mt19937 random(4);
    for (const std::int64_t z : {std::int64_t{-3}, -4 * two_to_31 - 1001, 4 * two_to_31 - 1002})
      for (const std::int64_t x : {std::int64_t{5}, two_to_31}) {
        const LatticeNoise noise({1, 1}, 2);
        const std::vector<double> whole = filled(noise, {x, -7, z}, 2003);
        std::vector<double> parts(whole.size());
        noise.fill(random_pieces({x, -7, z}, parts, random));
        EXPECT_EQ(parts, whole);
      }
  });
}

// Runs of different keys in one call.
TEST(LatticeNoise, RunsFarApartMayShareACall) {
  const LatticeNoise noise({4, 4}, -1);
  std::vector<double> together(300);
  std::vector<NoiseRun> runs;
  for (std::size_t k = 0; k < 100; ++k)
    runs.push_back({.x = static_cast<std::int64_t>(k % 3) * two_to_32,
                    .y = 8,
                    .z = 1,
                    .n = 3,
                    .values = &together[3 * k]});
  noise.fill(runs);
  for (std::size_t k = 0; k < 100; ++k) {
    const std::vector<double> alone = filled(noise, {runs[k].x, 8, 1}, 3);
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), &together[3 * k])) << k;
  }
}

TEST(LatticeNoise, RunsWriteTheirOwnValuesOnly) {
  constexpr double untouched = 1e300;
  const LatticeNoise noise({2, 2}, 0);
  for (std::int32_t n = 0; n <= 20; ++n)
    for (std::int64_t z = 0; z < 4; ++z) {
      std::vector<double> values(40, untouched);
      const NoiseRun run{1, 2, z, n, &values[10]};
      noise.fill({&run, 1});
      for (std::int32_t k = 0; k < 40; ++k)
        EXPECT_EQ(values[static_cast<std::size_t>(k)] == untouched, k < 10 || k >= 10 + n) << n;
    }
  noise.fill({});
}

TEST(LatticeNoise, ThreadsChangeNoBit) {
  const LatticeNoise noise({3, 9}, 1);
  const std::vector<double> whole = filled(noise, {0, 0, -5000}, 10'000);
  std::vector<double> parts(whole.size());
  parallel_for(whole.size(), 101, [&](std::size_t begin, std::size_t end) {
    const NoiseRun run{0, 0, static_cast<std::int64_t>(begin) - 5000,
                       static_cast<std::int32_t>(end - begin), &parts[begin]};
    noise.fill({&run, 1});
  });
  EXPECT_EQ(parts, whole);
}

// E[z^k] = 0, 1, 0, 3 and Var[z^k] = E[z^2k] - E[z^k]^2 = 1, 2, 15, 96 for k = 1..4. Five standard
// errors: p < 6e-7 for each.
TEST(LatticeNoise, HasTheMomentsOfTheNormalDistribution) {
  const std::vector<double> numbers = cube(LatticeNoise({1, 0}, 0), {-50, -50, -50}, 100);
  std::array<double, 4> sums{};
  for (const double z : numbers)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::pow(z, static_cast<double>(k + 1));
  const auto n = static_cast<double>(numbers.size());
  EXPECT_NEAR(sums[0] / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(sums[1] / n, 1, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(sums[2] / n, 0, 5 * std::sqrt(15 / n));
  EXPECT_NEAR(sums[3] / n, 3, 5 * std::sqrt(96 / n));
}

// The sum over m equally likely bins of (count - expected)^2 / expected has mean m - 1 and variance
// 2 (m - 1), and is nearly normal for m = 256.
TEST(LatticeNoise, FillsEquallyLikelyBinsEvenly) {
  constexpr int n_bins = 256;
  const std::vector<double> numbers = cube(LatticeNoise({8, 1}, 0), {0, 0, 0}, 100);
  std::array<double, n_bins> counts{};
  for (const double z : numbers) {
    const double probability = 0.5 * std::erfc(-z / std::numbers::sqrt2);
    ++counts[static_cast<std::size_t>(std::min(n_bins - 1.0, n_bins * probability))];
  }
  const double expected = static_cast<double>(numbers.size()) / n_bins;
  double chi_square = 0;
  for (const double count : counts)
    chi_square += (count - expected) * (count - expected) / expected;
  EXPECT_NEAR(chi_square, n_bins - 1, 5 * std::sqrt(2.0 * (n_bins - 1)));
}

// 12 offsets, the neighbours within a block of four (offsets 1 to 3 in z) among them; squares,
// which the two numbers of a pair share where an angle is lost, have mean 1 and variance 2. Six
// standard errors: p < 2e-9 each.
TEST(LatticeNoise, NeighboursAreUncorrelatedAndSoAreTheirSquares) {
  const LatticeNoise noise({6, 2}, 0);
  const auto squares = [](std::vector<double> z) {
    for (double& x : z) x = (x * x - 1) / std::numbers::sqrt2;
    return z;
  };
  const std::vector<double> here = cube(noise, {-32, -32, -32}, 64);
  for (const Point& step : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{0, 0, 2},
                            Point{0, 0, 3}, Point{0, 0, 4}, Point{1, 1, 0}, Point{1, -1, 0},
                            Point{0, 1, 4}, Point{0, 1, -4}, Point{1, 0, -4}, Point{1, 1, 1}}) {
    const std::vector<double> there = cube(noise, {step[0] - 32, step[1] - 32, step[2] - 32}, 64);
    EXPECT_NEAR(correlation(here, there), 0, six_errors(here.size()))
        << step[0] << step[1] << step[2];
    EXPECT_NEAR(correlation(squares(here), squares(there)), 0, six_errors(here.size()))
        << step[0] << step[1] << step[2];
  }
}

// An index counts with all of its 64 bits, and no axis takes the place of another.
TEST(LatticeNoise, PlacesFarApartAndAxesAreUncorrelated) {
  const LatticeNoise noise({6, 3}, 0);
  const Point origin{100, 200, 1200};  // the third in blocks: 300
  std::vector<std::vector<double>> cubes;
  for (const Point& far :
       {origin, Point{200, 100, 1200}, Point{300, 200, 400}, Point{100, 300, 800},
        Point{100 + two_to_32, 200, 1200}, Point{100, 200 + two_to_32, 1200},
        Point{100, 200, 1200 + 4 * two_to_32}, Point{100 - two_to_32, 200, 1200},
        Point{100 + 2 * two_to_32, 200, 1200}, Point{100 + 256 * two_to_32, 200, 1200}})
    cubes.push_back(cube(noise, far, 32));
  for (std::size_t a = 0; a < cubes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_NEAR(correlation(cubes[a], cubes[b]), 0, six_errors(cubes[a].size())) << a << " " << b;
}

// 402 correlations of 4,096 numbers each, and the mean over all seeds.
TEST(LatticeNoise, AdjacentSeedsAndRealizationsAreUncorrelated) {
  const auto numbers = [](std::uint64_t seed, std::uint64_t realization) {
    return cube(LatticeNoise({seed, realization}, 0), {-8, -8, -8}, 16);
  };
  double mean_of_seeds = 0;
  for (std::uint64_t s = 0; s <= 200; ++s) {
    const std::vector<double> z = numbers(s, 0);
    EXPECT_NEAR(correlation(z, numbers(s + 1, 0)), 0, six_errors(z.size())) << "seed " << s;
    EXPECT_NEAR(correlation(numbers(0, s), numbers(0, s + 1)), 0, six_errors(z.size()))
        << "realization " << s;
    mean_of_seeds += std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(201 * z.size());
  }
  EXPECT_NEAR(mean_of_seeds, 0, six_errors(std::size_t{201} * 4096));
}

TEST(LatticeNoise, SeedRealizationAndLevelMayNotBeExchanged) {
  std::vector<std::vector<double>> cubes;
  for (const std::array<int, 3>& of :
       {std::array{1, 2, 3}, std::array{1, 3, 2}, std::array{2, 1, 3}, std::array{2, 3, 1},
        std::array{3, 1, 2}, std::array{3, 2, 1}})
    cubes.push_back(cube(
        LatticeNoise({static_cast<std::uint64_t>(of[0]), static_cast<std::uint64_t>(of[1])}, of[2]),
        {0, 0, 0}, 16));
  for (std::size_t a = 0; a < cubes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_NEAR(correlation(cubes[a], cubes[b]), 0, six_errors(cubes[a].size())) << a << " " << b;
}

TEST(LatticeNoise, LevelsAreUncorrelated) {
  std::vector<std::vector<double>> levels;
  for (std::int32_t level = -3; level <= 3; ++level)
    levels.push_back(cube(LatticeNoise({5, 5}, level), {-16, -16, -16}, 32));
  for (std::size_t a = 0; a < levels.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_NEAR(correlation(levels[a], levels[b]), 0, six_errors(levels[a].size()))
          << a << " " << b;
}

}  // namespace
}  // namespace roughmesh
