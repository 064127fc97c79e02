// SPDX-License-Identifier: BSD-3-Clause
// Sums of noise under kernels are those of three plain loops, for each kernel, number of axes and
// instruction set of this processor.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <span>

#include <gtest/gtest.h>
#include <hwy/aligned_allocator.h>

#include "lattice_gather.hpp"
#include "support/instruction_sets.hpp"

namespace roughmesh::detail {
namespace {

using test::on_every_instruction_set;
using Axes = std::array<LatticeAxis, 3>;

/// Numbers of order 1 on a box around the kernels of all places, and what follows it.
class TestBox {
 public:
  TestBox(const Axes& axes, const std::vector<Vec3>& places) {
    std::array<std::int64_t, 3> end{};
    box_.first.fill(std::numeric_limits<std::int64_t>::max());
    end.fill(std::numeric_limits<std::int64_t>::min());
    for (const Vec3& x : places)
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t first = kernel_weights(axes[a], x[static_cast<int>(a)]).first;
        box_.first[a] = std::min(box_.first[a], first);
        end[a] = std::max(end[a], first + axes[a].n_points());
      }
    for (std::size_t a = 0; a < 3; ++a) box_.size[a] = end[a] - box_.first[a];
    values_ = hwy::AllocateAligned<double>(n_values());
    std::mt19937 random(5);
    for (double& value : all()) value = std::uniform_real_distribution(-1.0, 1.0)(random);
    box_.values = values_.get();
  }

  const LatticeBox& box() const { return box_; }

  /// Whatever a kernel at this place does not take in, and the numbers behind each column.
  void set_all_but_kernel(const Axes& axes, const Vec3& x, double value) {
    std::array<std::int64_t, 3> low{};
    for (std::size_t a = 0; a < 3; ++a)
      low[a] = kernel_weights(axes[a], x[static_cast<int>(a)]).first - box_.first[a];
    const auto is_taken = [&](std::size_t a, std::int64_t point) {
      return point >= low[a] && point < low[a] + axes[a].n_points();
    };
    for (std::int64_t i = 0; i < box_.size[0]; ++i)
      for (std::int64_t j = 0; j < box_.size[1]; ++j)
        for (std::int64_t k = 0; k < box_.column_length(); ++k)
          if (!is_taken(0, i) || !is_taken(1, j) || !is_taken(2, k)) box_.column(i, j)[k] = value;
  }

 private:
  std::size_t n_values() const { return static_cast<std::size_t>(box_.n_values()); }
  std::span<double> all() { return {values_.get(), n_values()}; }

  LatticeBox box_;
  hwy::AlignedFreeUniquePtr<double[]> values_;
};

double plain_sum(const Axes& axes, const LatticeBox& box, const Vec3& place) {
  std::array<AxisWeights, 3> w;
  std::array<std::int64_t, 3> low{};
  for (std::size_t a = 0; a < 3; ++a) {
    w[a] = kernel_weights(axes[a], place[static_cast<int>(a)]);
    low[a] = w[a].first - box.first[a];
  }
  double sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes[0].n_points()); ++i)
    for (std::size_t j = 0; j < static_cast<std::size_t>(axes[1].n_points()); ++j)
      for (std::size_t k = 0; k < static_cast<std::size_t>(axes[2].n_points()); ++k) {
        const auto at = [&](std::size_t a, std::size_t n) {
          return low[a] + static_cast<std::int64_t>(n);
        };
        sum += w[0].weight[i] * w[1].weight[j] * w[2].weight[k] *
               box.column(at(0, i), at(1, j))[at(2, k)];
      }
  return sum;
}

std::vector<Vec3> random_places(std::size_t n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-2.5, 2.5);
  std::vector<Vec3> places(n);
  for (Vec3& x : places) x = {coordinate(random), coordinate(random), coordinate(random)};
  return places;
}

std::vector<std::uint32_t> all_of(const std::vector<Vec3>& places) {
  std::vector<std::uint32_t> members(places.size());
  std::iota(members.begin(), members.end(), 0U);
  return members;
}

// Up to 20^3 products of weights, whose squares add up to 1, with numbers of at most 1: their sum
// is at most 20^(3/2), and rounding is a few hundred units in the last place of that.
constexpr double rounding = 1e-12;

void expect_plain_sums(const Axes& axes) {
  const std::vector<Vec3> places = random_places(19);  // no multiple of the lanes of a vector
  const TestBox box(axes, places);
  std::vector<double> sums(places.size(), 0.25);
  gather(axes, box.box(), all_of(places), places.data(), sums.data());
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_NEAR(sums[i], plain_sum(axes, box.box(), places[i]), rounding) << i;
}

TEST(Gather, IsThreeLoopsForEveryKernel) {
  on_every_instruction_set([] {
    for (const KernelWidth& width : kernel_widths()) {
      SCOPED_TRACE(width.n_points);
      const LatticeAxis axis(0.7, width);
      expect_plain_sums({axis, axis, axis});
      expect_plain_sums({LatticeAxis(), axis, axis});
      expect_plain_sums({LatticeAxis(), LatticeAxis(), axis});
    }
    expect_plain_sums({});
  });
}

TEST(Gather, TakesAxesThatDiffer) {
  on_every_instruction_set([] {
    const auto widths = kernel_widths();
    for (std::size_t k = 0; k + 2 < widths.size(); ++k) {
      SCOPED_TRACE(k);
      const LatticeAxis a(0.7, widths[k]), b(1.1, widths[k + 2]), flat;
      for (const double period : {0.8, 2.0, 9.0}) {
        const LatticeAxis c(0.7, widths[k + 1], period);
        expect_plain_sums({a, b, c});
        expect_plain_sums({c, a, b});
        expect_plain_sums({flat, c, b});
        expect_plain_sums({a, b, flat});
        expect_plain_sums({c, flat, a});
      }
    }
  });
}

TEST(Gather, SumsItsMembersAlone) {
  on_every_instruction_set([] {
    const LatticeAxis axis(0.7, kernel_widths()[5]);
    const std::vector<Vec3> places = random_places(40);
    const TestBox box({axis, axis, axis}, places);
    for (std::size_t n = 0; n < 20; ++n) {
      std::vector<std::uint32_t> members;
      for (std::size_t k = 0; k < n; ++k) members.push_back(static_cast<std::uint32_t>(39 - 2 * k));
      std::vector<double> some(n + 1, 1.5), all(places.size());
      gather({axis, axis, axis}, box.box(), members, places.data(), some.data());
      gather({axis, axis, axis}, box.box(), all_of(places), places.data(), all.data());
      for (std::size_t m = 0; m < n; ++m)
        EXPECT_EQ(some[m], all[members[m]]) << m;  // the same bits in any company
      EXPECT_EQ(some[n], 1.5);
    }
  });
}

// Vectors reach beyond a kernel, but what they find there has no weight.
TEST(Gather, IgnoresWhatTheKernelDoesNotTakeIn) {
  on_every_instruction_set([] {
    for (const KernelWidth& width : kernel_widths()) {
      const LatticeAxis axis(0.7, width);
      for (const Axes& axes :
           {Axes{axis, axis, axis}, Axes{LatticeAxis(), axis, axis}, Axes{axis, axis, {}}}) {
        const std::vector<Vec3> places = random_places(6);
        const TestBox box(axes, places);
        for (std::uint32_t i = 0; i < places.size(); ++i) {
          double before = 0, after = 1;
          const std::vector<std::uint32_t> member = {i};
          TestBox disturbed(axes, places);
          disturbed.set_all_but_kernel(axes, places[i], 1e300);
          gather(axes, box.box(), member, places.data(), &before);
          gather(axes, disturbed.box(), member, places.data(), &after);
          EXPECT_EQ(before, after) << width.n_points;
        }
      }
    }
  });
}

/// exp(-(x - b j)^2 / s^2) at the points that the axis says, over the root of their squares.
std::vector<double> plain_weights(const LatticeAxis& axis, double x) {
  std::vector<double> weights;
  double squares = 0;
  for (int p = 0; p < axis.n_points(); ++p) {
    const double offset =
        axis.varies() ? x * axis.inverse_spacing() - static_cast<double>(axis.first_point(x)) - p
                      : 0;
    weights.push_back(std::exp(-axis.exponent() * offset * offset));
    squares += weights.back() * weights.back();
  }
  const double factor = axis.amplitude() > 0 ? axis.amplitude() : 1 / std::sqrt(squares);
  for (double& weight : weights) weight *= factor;
  return weights;
}

// The factor from one point to the next is off by at most 10 units of 2^-53 (its exponent is below
// 10, and rounds), and 40 of them are multiplied: 5e-14 of a weight, which is at most 1.
TEST(KernelWeights, AreGaussiansOnEveryInstructionSet) {
  on_every_instruction_set([] {
    for (const KernelWidth& width : kernel_widths())
      for (const LatticeAxis& axis : {LatticeAxis(0.7, width), LatticeAxis(0.7, width, 0.9), {}})
        for (std::size_t n = 1; n <= 17; ++n) {
          std::vector<double> places;
          for (const Vec3& x : random_places(n)) places.push_back(x.z());
          std::vector<AxisWeights> weights(n);
          kernel_weights(axis, places, weights);
          for (std::size_t i = 0; i < n; ++i) {
            const std::vector<double> plain = plain_weights(axis, places[i]);
            for (std::size_t p = 0; p < plain.size(); ++p)
              EXPECT_NEAR(weights[i].weight[p], plain[p], 1e-13) << n << " " << i << " " << p;
          }
        }
  });
}

TEST(KernelWeights, AreZeroBeyondTheKernel) {
  on_every_instruction_set([] {
    for (const KernelWidth& width : kernel_widths())
      for (const LatticeAxis& axis : {LatticeAxis(0.7, width), LatticeAxis(0.7, width, 0.9), {}}) {
        const AxisWeights weights = kernel_weights(axis, 1.234);
        for (std::size_t p = 0; p < weights.weight.size(); ++p)
          if (p < static_cast<std::size_t>(axis.n_points()))
            EXPECT_GT(weights.weight[p], 0);
          else
            EXPECT_EQ(weights.weight[p], 0);
      }
  });
}

TEST(KernelWeights, StartWhereTheAxisSays) {
  on_every_instruction_set([] {
    for (const KernelWidth& width : kernel_widths()) {
      const LatticeAxis axis(0.7, width);
      for (const Vec3& x : random_places(200))
        for (const double unit : {1.0, 1e9}) {
          const double place = x.x() * unit;
          EXPECT_EQ(kernel_weights(axis, place).first, axis.first_point(place)) << place;
        }
      for (int point = -50; point < 50; ++point) {  // where the kernel jumps, and half way
        const double place = 0.5 * point / axis.inverse_spacing();
        EXPECT_EQ(kernel_weights(axis, place).first, axis.first_point(place)) << point;
      }
    }
  });
}

}  // namespace
}  // namespace roughmesh::detail
