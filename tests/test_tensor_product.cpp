// SPDX-License-Identifier: BSD-3-Clause
// Products of small matrices with boxes are those of plain loops on every instruction set of this
// processor, at any address, and touch nothing beyond their arrays.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/instruction_sets.hpp"
#include "tensor_product.hpp"

namespace roughmesh::detail {
namespace {

using test::on_every_instruction_set;

// Numbers are at most 1, so that a sum of n products of up to four of them is at most n, and both
// sides round each of its terms a few times: relative to n, a few n units in the last place.
double rounding(int n) { return 4.0 * n * n * 0x1p-53; }

double random_number() {
  static std::mt19937 random(11);
  return std::uniform_real_distribution(-1.0, 1.0)(random);
}

/// Exactly as long as said, so that the sanitizers see whatever is read behind the end.
std::vector<double> random_numbers(int n) {
  std::vector<double> numbers(static_cast<std::size_t>(n));
  std::generate(numbers.begin(), numbers.end(), random_number);
  numbers.shrink_to_fit();
  return numbers;
}

SmallMatrix random_matrix(int n_rows, int n_columns) {
  return {n_rows, n_columns, random_numbers(n_rows * n_columns)};
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Checks a product with rows of `width` numbers, `shift` numbers after where an array begins.
void expect_product(int n_rows, int n_columns, int width, int shift) {
  SCOPED_TRACE(testing::PrintToString(std::array{n_rows, n_columns, width, shift}));
  const SmallMatrix a = random_matrix(n_rows, n_columns);
  const std::vector<double> b = random_numbers(shift + n_columns * width);
  const std::vector<double> before = random_numbers(shift + n_rows * width);
  std::vector<double> after = before;
  add_product(a, b.data() + shift, width, after.data() + shift);
  for (int k = 0; k < shift; ++k) EXPECT_EQ(after[at(k)], before[at(k)]);
  for (int i = 0; i < n_rows; ++i)
    for (int j = 0; j < width; ++j) {
      double sum = before[at(shift + i * width + j)];
      for (int k = 0; k < n_columns; ++k) sum += a(i, k) * b[at(shift + k * width + j)];
      EXPECT_NEAR(after[at(shift + i * width + j)], sum, rounding(n_columns + 1)) << i << " " << j;
    }
}

// Whole vectors and every rest of one, at addresses that no vector is aligned to.
TEST(AddProduct, IsThreeLoopsOnEveryInstructionSet) {
  on_every_instruction_set([] {
    for (int width = 1; width <= 33; ++width)
      for (const int shift : {0, 1, 3}) {
        expect_product(1, 1, width, shift);
        expect_product(5, 3, width, shift);
        expect_product(3, 17, width, shift);
      }
  });
}

void expect_tensor_product(const std::array<int, 3>& from, const std::array<int, 3>& to) {
  SCOPED_TRACE(testing::PrintToString(from) + " to " + testing::PrintToString(to));
  std::array<SmallMatrix, 3> m;
  for (std::size_t a = 0; a < 3; ++a) m[a] = random_matrix(to[a], from[a]);
  const int n = from[0] * from[1] * from[2];
  const std::vector<double> values = random_numbers(n);
  const std::vector<double> before = random_numbers(to[0] * to[1] * to[2]);
  std::vector<double> after = before;
  add_tensor_product(m, values, after);
  for (int i = 0; i < to[0]; ++i)
    for (int j = 0; j < to[1]; ++j)
      for (int k = 0; k < to[2]; ++k) {
        const std::size_t result = at((i * to[1] + j) * to[2] + k);
        double sum = before[result];
        for (int x = 0; x < from[0]; ++x)
          for (int y = 0; y < from[1]; ++y)
            for (int z = 0; z < from[2]; ++z)
              sum += m[0](i, x) * m[1](j, y) * m[2](k, z) *
                     values[at((x * from[1] + y) * from[2] + z)];
        EXPECT_NEAR(after[result], sum, rounding(n + 1)) << i << " " << j << " " << k;
      }
}

TEST(AddTensorProduct, IsSixLoopsOnEveryInstructionSet) {
  on_every_instruction_set([] {
    expect_tensor_product({1, 1, 1}, {1, 1, 1});
    expect_tensor_product({5, 7, 3}, {2, 3, 9});
    expect_tensor_product({1, 9, 13}, {1, 4, 6});
    expect_tensor_product({4, 1, 2}, {8, 5, 1});
  });
}

/// The numbers behind the box are finite, but so large that any weight on them shows.
void expect_interpolation(const std::array<int, 3>& size) {
  SCOPED_TRACE(testing::PrintToString(size));
  const int n = size[0] * size[1] * size[2];
  std::vector<double> values = random_numbers(n);
  values.resize(at(n + tensor_lanes - 1), 1e300);
  values.shrink_to_fit();
  std::array<NodeWeights, 3> w{};
  for (std::size_t a = 0; a < 3; ++a) std::generate_n(w[a].begin(), size[a], random_number);
  double sum = 0;
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < size[1]; ++j)
      for (int k = 0; k < size[2]; ++k)
        sum +=
            w[0][at(i)] * w[1][at(j)] * w[2][at(k)] * values[at((i * size[1] + j) * size[2] + k)];
  EXPECT_NEAR(interpolate(w, values.data(), size), sum, rounding(n));
}

TEST(Interpolate, IsThreeLoopsOnEveryInstructionSet) {
  on_every_instruction_set([] {
    for (int n = 1; n <= 16; ++n) {
      expect_interpolation({n, n, n});
      expect_interpolation({1, n, n});
      expect_interpolation({1, 1, n});
      expect_interpolation({n, n, 1});
      expect_interpolation({3, 5, n});
    }
  });
}

}  // namespace
}  // namespace roughmesh::detail
