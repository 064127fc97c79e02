// SPDX-License-Identifier: BSD-3-Clause
#include "philox_normals.hpp"

// This file is compiled once for every instruction set; the processor decides which one runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "philox_normals.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace roughmesh::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using WordTag = hn::ScalableTag<std::uint64_t>;
using RealTag = hn::ScalableTag<double>;
using Word = hn::Vec<WordTag>;  // 32 bits each, in the low half; the high half is anything
using Real = hn::Vec<RealTag>;

/// Plain numbers: a register whose size only the processor knows cannot be in an array.
struct RoundKeys {
  std::array<std::uint64_t, 10> first, second;
};

RoundKeys round_keys(std::uint64_t key) {
  RoundKeys keys{};
  auto first = static_cast<std::uint32_t>(key), second = static_cast<std::uint32_t>(key >> 32);
  for (std::size_t round = 0; round < 10; ++round) {
    keys.first[round] = first;
    keys.second[round] = second;
    first += 0x9E3779B9;   // the golden ratio
    second += 0xBB67AE85;  // sqrt 3 - 1
  }
  return keys;
}

/// All 64 bits of the product with the low half.
HWY_INLINE Word product(Word a, std::uint32_t b) {
  const WordTag d;
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, (hn::GetLane(a) & 0xFFFFFFFF) * b);
#else
  const hn::Repartition<std::uint32_t, WordTag> halves;
  return hn::MulEven(hn::BitCast(halves, a), hn::BitCast(halves, hn::Set(d, b)));
#endif
}

/// One of ten rounds: J. K. Salmon et al. (2011), doi:10.1145/2063384.2063405.
HWY_INLINE void philox_round(const RoundKeys& keys, std::size_t round, Word& a, Word& b, Word& c,
                             Word& d) {
  const WordTag tag;
  const Word p = product(a, 0xD2511F53), q = product(c, 0xCD9E8D57);
  a = hn::Xor3(hn::ShiftRight<32>(q), b, hn::Set(tag, keys.first[round]));
  c = hn::Xor3(hn::ShiftRight<32>(p), d, hn::Set(tag, keys.second[round]));
  b = q;
  d = p;
}

HWY_INLINE void load_counters(const PhiloxCounters& counters, std::size_t block, Word& a, Word& b,
                              Word& c, Word& d) {
  const WordTag tag;
  a = hn::Load(tag, &counters.first_and_second[block]);
  b = hn::ShiftRight<32>(a);
  c = hn::Load(tag, &counters.third_and_fourth[block]);
  d = hn::ShiftRight<32>(c);
}

HWY_INLINE void store_words(Word a, Word b, Word c, Word d, std::size_t block, PhiloxWords& words) {
  const WordTag tag;
  hn::Store(a, tag, &words.lanes[0][block]);
  hn::Store(b, tag, &words.lanes[1][block]);
  hn::Store(c, tag, &words.lanes[2][block]);
  hn::Store(d, tag, &words.lanes[3][block]);
}

// Two registers a turn, so that the one works while the other waits for its products.
void philox_words(const PhiloxCounters& counters, std::size_t n_blocks, PhiloxWords& words) {
  const RoundKeys keys = round_keys(counters.key);
  const std::size_t lanes = hn::Lanes(WordTag());
  for (std::size_t block = 0; block < n_blocks; block += 2 * lanes) {
    Word a, b, c, d, e, f, g, h;
    load_counters(counters, block, a, b, c, d);
    load_counters(counters, block + lanes, e, f, g, h);
    for (std::size_t round = 0; round < 10; ++round) {
      philox_round(keys, round, a, b, c, d);
      philox_round(keys, round, e, f, g, h);
    }
    store_words(a, b, c, d, block, words);
    store_words(e, f, g, h, block + lanes, words);
  }
}

/// c[0] + c[1] z + c[2] z^2 + ...
template <std::size_t N>
HWY_INLINE Real polynomial(const std::array<double, N>& c, Real z) {
  const RealTag d;
  Real sum = hn::Set(d, c[N - 1]);
  for (std::size_t k = N - 1; k-- > 0;) sum = hn::MulAdd(sum, z, hn::Set(d, c[k]));
  return sum;
}

// Each polynomial below equals its function at as many Chebyshev points of the interval of the
// argument of P as it has coefficients; the errors are those of the rounded coefficients, found
// with 60 digits at 4,000 places.

/// sin(pi/4 x) = x (pi/4 + x^2 P(x^2)) on [-1, 1], relative error 1.5e-17.
constexpr std::array<double, 6> sine_coefficients = {-0x1.4abbce625be52p-4,  0x1.466bc6775a476p-9,
                                                     -0x1.32d2cce500387p-15, 0x1.50783208843ebp-22,
                                                     -0x1.e3027dea82bd7p-30, 0x1.e4a9d9166f052p-38};
constexpr double quarter_pi = 0x1.921fb54442d18p-1, quarter_pi_rest = 0x1.1a62633145c07p-55;

/// cos(pi/4 x) = 1 + x^2 P(x^2) on [-1, 1], relative error 2.7e-17.
constexpr std::array<double, 7> cosine_coefficients = {
    -0x1.3bd3cc9be45dep-2,  0x1.03c1f081b5ac0p-6,  -0x1.55d3c7e3cb241p-12, 0x1.e1f5068688d5bp-19,
    -0x1.a6d1eef479be1p-26, 0x1.f9ce245cada0bp-34, -0x1.b2f3eb054afcdp-42};

/// 2 artanh(s) = 2 s + s^3 P(s^2) for |s| <= 3 - sqrt 8, relative error 4.7e-18.
constexpr std::array<double, 7> artanh_coefficients = {
    0x1.5555555555558p-1, 0x1.99999999952e2p-2, 0x1.2492492df148dp-2, 0x1.c71c62e5800a1p-3,
    0x1.7462b4ab2ef6bp-3, 0x1.39fe606542ddep-3, 0x1.2b584aae78a57p-3};

/// base + (word & mask) * ulp(base), exactly: the bits of the word become the last bits of `base`.
HWY_INLINE Real with_last_bits(double base, Word word, std::uint64_t mask) {
  const WordTag d;
  const Word low = hn::And(word, hn::Set(d, mask));
  return hn::BitCast(RealTag(), hn::Or(low, hn::BitCast(d, hn::Set(RealTag(), base))));
}

/// Logarithm of u = m 2^e with m in [sqrt(1/2), sqrt 2), so that e = 0 near 1 and nothing cancels:
/// ln u = e ln 2 + f - s (f - s^2 P(s^2)) with f = m - 1 and s = f / (2 + f).
HWY_INLINE Real logarithm(Real u) {
  const RealTag d;
  const WordTag words;
  constexpr std::uint64_t root_half = 0x3FE6A09E667F3BCD, one = 0x3FF0000000000000;
  const Word shifted = hn::Add(hn::BitCast(words, u), hn::Set(words, one - root_half));
  const Word mantissa =
      hn::Add(hn::And(shifted, hn::Set(words, 0x000FFFFFFFFFFFFF)), hn::Set(words, root_half));
  const Real e = hn::Sub(with_last_bits(0x1p52, hn::ShiftRight<52>(shifted), 0xFFF),
                         hn::Set(d, 0x1p52 + 1023));
  const Real f = hn::Sub(hn::BitCast(d, mantissa), hn::Set(d, 1.0));
  const Real s = hn::Div(f, hn::Add(f, hn::Set(d, 2.0))), z = hn::Mul(s, s);
  const Real rest = hn::NegMulAdd(z, polynomial(artanh_coefficients, z), f);
  return hn::MulAdd(e, hn::Set(d, 0x1.62e42fefa39efp-1), hn::NegMulAdd(s, rest, f));
}

/// sqrt(-2 ln u), u = (word + 1/2) 2^-32; the ulp of 2^20 is 2^-32, that of numbers below it 2^-33.
HWY_INLINE Real radius(Word word) {
  const RealTag d;
  const Real u = hn::Sub(with_last_bits(0x1p20, word, 0xFFFFFFFF), hn::Set(d, 0x1p20 - 0x1p-33));
  return hn::Sqrt(hn::Mul(hn::Set(d, -2.0), logarithm(u)));
}

/// Flips the sign of x where bit 31 of the word is set.
HWY_INLINE Real flip(Real x, Word word) {
  const WordTag d;
  const Word sign = hn::And(hn::ShiftLeft<32>(word), hn::Set(d, 0x8000000000000000));
  return hn::Xor(x, hn::BitCast(RealTag(), sign));
}

/// Cosine and sine of 2 pi (word + 1/2) 2^-32. After an eighth of a turn is added, the upper two
/// bits count quarters of a turn, and the others tell the distance x pi/4 from it, |x| < 1, by x +
/// 1 in units of 2^-30, the ulp of 2^22. The half is the last of these units.
HWY_INLINE void cosine_sine(Word word, Real& cosine, Real& sine) {
  const RealTag d;
  const WordTag words;
  const Word turn = hn::Add(word, hn::Set(words, std::uint64_t{1} << 29));
  const Real middle = with_last_bits(0x1p22 + 0x1p-30, hn::Add(turn, turn), 0x7FFFFFFF);
  const Real x = hn::Sub(middle, hn::Set(d, 0x1p22 + 1));
  const Real z = hn::Mul(x, x);
  const Real c = hn::MulAdd(z, polynomial(cosine_coefficients, z), hn::Set(d, 1.0));
  const Real high = hn::MulAdd(z, polynomial(sine_coefficients, z), hn::Set(d, quarter_pi_rest));
  const Real s = hn::MulAdd(x, hn::Set(d, quarter_pi), hn::Mul(x, high));
  const Word quarter = hn::Set(words, std::uint64_t{1} << 30);
  const auto is_odd = hn::RebindMask(d, hn::TestBit(turn, quarter));
  cosine = flip(hn::IfThenElse(is_odd, s, c), hn::Add(turn, quarter));
  sine = flip(hn::IfThenElse(is_odd, c, s), turn);
}

HWY_INLINE void box_muller(Word radius_word, Word angle_word, Real& first, Real& second) {
  const Real r = radius(radius_word);
  Real cosine, sine;
  cosine_sine(angle_word, cosine, sine);
  first = hn::Mul(r, cosine);
  second = hn::Mul(r, sine);
}

void block_normals(const PhiloxWords& words, std::size_t n_blocks, BlockNormals& normals) {
  const WordTag d;
  const auto& [radius_a, angle_a, radius_b, angle_b] = words.lanes;
  for (std::size_t block = 0; block < n_blocks; block += hn::Lanes(d)) {
    Real z0, z1, z2, z3;
    box_muller(hn::Load(d, &radius_a[block]), hn::Load(d, &angle_a[block]), z0, z1);
    box_muller(hn::Load(d, &radius_b[block]), hn::Load(d, &angle_b[block]), z2, z3);
    hn::StoreInterleaved4(z0, z1, z2, z3, RealTag(), &normals.values[4 * block]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace roughmesh::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace roughmesh::detail {

HWY_EXPORT(philox_words);
HWY_EXPORT(block_normals);

void philox_words(const PhiloxCounters& counters, std::size_t n_blocks, PhiloxWords& words) {
  HWY_DYNAMIC_DISPATCH(philox_words)(counters, n_blocks, words);
}

void block_normals(const PhiloxWords& words, std::size_t n_blocks, BlockNormals& normals) {
  HWY_DYNAMIC_DISPATCH(block_normals)(words, n_blocks, normals);
}

}  // namespace roughmesh::detail
#endif
