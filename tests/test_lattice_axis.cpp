// SPDX-License-Identifier: BSD-3-Clause
// Along one axis a lattice under a Gaussian kernel has the covariance of a Gaussian, to the error
// that the table of kernels states.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "lattice_axis.hpp"
#include "lattice_gather.hpp"
#include "periodic_bell.hpp"

namespace roughmesh::detail {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

AxisRow make_row(std::int64_t first, const std::vector<double>& values) {
  AxisRow row{first, static_cast<int>(values.size()), {}};
  std::copy(values.begin(), values.end(), row.value.begin());
  return row;
}

std::span<const double> values_of(const AxisRow& row) {
  return std::span(row.value).first(static_cast<std::size_t>(row.size));
}

AxisRow row_at(const LatticeAxis& axis, double x) {
  const AxisWeights weights = kernel_weights(axis, x);
  return make_row(weights.first,
                  {weights.weight.begin(), weights.weight.begin() + axis.n_points()});
}

double covariance(const LatticeAxis& axis, double x, double y) {
  return row_product(axis, row_at(axis, x), row_at(axis, y));
}

double sum_of_squares(const AxisRow& row) {
  double sum = 0;
  for (const double value : values_of(row)) sum += value * value;
  return sum;
}

/// Places in one spacing of an axis of scale 1. The kernel jumps to its next point at 0 (an even
/// number of points) or in the middle: both sides of the jump are among the places, because there
/// the error is largest.
std::vector<double> places_in_a_spacing(const LatticeAxis& axis) {
  constexpr int n = 48;
  std::vector<double> places;
  for (int k = 0; k < n; ++k)
    for (const double shift : {1e-9, 1 - 1e-9})
      places.push_back((k + shift) / n / axis.inverse_spacing());
  return places;
}

/// Largest |covariance - Gaussian| of any two places of a lattice that does not end. It looks the
/// same from each of its points, so that one place lies in the first spacing, and the row of the
/// other is that of a place in the first spacing moved by whole spacings.
double largest_error(const LatticeAxis& axis) {
  const double spacing = 1 / axis.inverse_spacing();
  const std::vector<double> places = places_in_a_spacing(axis);
  std::vector<AxisRow> rows(places.size());
  std::transform(places.begin(), places.end(), rows.begin(),
                 [&](double x) { return row_at(axis, x); });
  // Beyond the reach the covariance is 0; up to 6 scales, where the Gaussian is 1.5e-8, or more.
  const int n_steps = std::max(axis.n_points() + 1, static_cast<int>(std::ceil(6 / spacing)));
  double largest = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < places.size(); ++j) {
      AxisRow moved = rows[j];
      for (int step = 0; step <= n_steps; ++step, ++moved.first) {
        const double r = places[j] + step * spacing - places[i];
        largest = std::max(largest, std::abs(row_product(axis, rows[i], moved) - bell(r, 1)));
      }
    }
  return largest;
}

TEST(KernelWidths, StateTheErrorOfEachKernel) {
  for (const KernelWidth& width : kernel_widths()) {
    const double error = largest_error(LatticeAxis(1, width));
    EXPECT_LE(error, width.error) << width.n_points;
    EXPECT_GE(1.15 * error, width.error) << width.n_points;
  }
}

TEST(KernelWidths, AscendInPointsAndFallInError) {
  const auto widths = kernel_widths();
  for (std::size_t k = 1; k < widths.size(); ++k) {
    EXPECT_EQ(widths[k].n_points, widths[k - 1].n_points + 1);
    EXPECT_LT(widths[k].spacing, widths[k - 1].spacing);
    EXPECT_LT(widths[k].error, widths[k - 1].error);
  }
  // A periodic axis may bring its points together to half the spacing.
  EXPECT_LE(2 * widths.back().n_points, most_lattice_points);
}

// A sum of up to 20 squares of rounded numbers, divided by its own rounded value.
TEST(LatticeAxis, GivesUnitVarianceAtAnyPlace) {
  for (const KernelWidth& width : kernel_widths())
    for (const double x : {0.0, 1e-300, 0.3, -0.3, 7.77, -1e5, 123456.789, 3e8}) {
      const LatticeAxis axis(0.37, width);
      EXPECT_NEAR(sum_of_squares(row_at(axis, x)), 1, 40 * epsilon) << width.n_points << ' ' << x;
    }
}

// The middle of the kernel is within half a spacing of the place, on both sides of the origin.
TEST(LatticeAxis, CentresItsPointsOnThePlace) {
  for (const KernelWidth& width : kernel_widths()) {
    const LatticeAxis axis(2.5, width);
    EXPECT_DOUBLE_EQ(axis.inverse_spacing(), 1 / (2.5 * width.spacing));
    EXPECT_TRUE(axis.varies());
    EXPECT_EQ(axis.n_points(), width.n_points);
    for (double x = -20; x < 20; x += 0.0371) {
      const double middle = static_cast<double>(axis.first_point(x)) + 0.5 * (axis.n_points() - 1);
      EXPECT_LE(std::abs(middle - x * axis.inverse_spacing()), 0.5 + 1e-12) << x;
    }
  }
}

TEST(LatticeAxis, WeightsAreAGaussianOfTheDistanceToThePoints) {
  const double scale = 0.37;
  for (const KernelWidth& width : kernel_widths()) {
    const LatticeAxis axis(scale, width);
    for (const double x : {0.1, -4.32, 17.0}) {
      const AxisRow row = row_at(axis, x);
      const auto kernel = [&](std::size_t k) {
        const double d = x - static_cast<double>(row.first + static_cast<std::int64_t>(k)) /
                                 axis.inverse_spacing();
        return std::exp(-d * d / (scale * scale));
      };
      for (std::size_t k = 1; k < values_of(row).size(); ++k)
        EXPECT_NEAR(row.value[k] / row.value[0] * kernel(0) / kernel(k), 1, 1e-12);
    }
  }
}

// Far from the origin x / spacing keeps 2^-53 of itself, so that a place is known to
// 1e9 * 2^-53 = 1.1e-7 spacings, and a difference of two to twice that. The slope of the Gaussian
// is at most 0.61 a scale, and no spacing is larger than 1.2 scales.
TEST(LatticeAxis, ReachesPlacesABillionSpacingsOff) {
  const double place_error = 2 * 1.2 * 0.61 * 1e9 * 0x1p-53;
  for (const KernelWidth& width : kernel_widths())
    for (const double far : {1e9, -1e9}) {
      const LatticeAxis axis(1, width);
      const double x = far * width.spacing;
      for (const double r : {0.0, 0.25, 1.0, 2.5})
        EXPECT_NEAR(covariance(axis, x, x + r), bell(r, 1), width.error + place_error);
      EXPECT_NEAR(sum_of_squares(row_at(axis, x)), 1, 40 * epsilon);
    }
}

// Where the unit of length is tiny or huge, the same bits: 2^100 is a power of two.
TEST(LatticeAxis, HasNoUnitOfLength) {
  const KernelWidth width = kernel_widths()[9];
  for (const double unit : {0x1p-100, 0x1p100}) {
    const LatticeAxis plain(0.7, width), scaled(0.7 * unit, width);
    const LatticeAxis around(0.7, width, 5), scaled_around(0.7 * unit, width, 5 * unit);
    EXPECT_EQ(covariance(plain, 1.3, 2), covariance(scaled, 1.3 * unit, 2 * unit));
    EXPECT_EQ(covariance(around, 1.3, 2), covariance(scaled_around, 1.3 * unit, 2 * unit));
  }
}

TEST(FlatAxis, HasOnePointOfWeightOne) {
  for (const LatticeAxis& axis : {LatticeAxis(), LatticeAxis(2, kernel_widths()[4], 1.6),
                                  LatticeAxis(1e9, kernel_widths()[9], 1)}) {
    EXPECT_FALSE(axis.varies());
    EXPECT_EQ(axis.n_points(), 1);
    for (const double x : {0.0, -3.5, 1e12}) {
      const AxisRow row = row_at(axis, x);
      EXPECT_EQ(axis.wrapped(row.first), 0);
      EXPECT_EQ(row.size, 1);
      EXPECT_EQ(row.value[0], 1);
    }
    EXPECT_EQ(covariance(axis, -1e9, 77), 1);
  }
}

TEST(PeriodicAxis, WrapsIndices) {
  const LatticeAxis axis(0.7, kernel_widths()[9], 5);
  const std::int64_t n = axis.n_period();
  EXPECT_NEAR(axis.inverse_spacing() * 5, static_cast<double>(n), 1e-12);
  EXPECT_LE(1 / axis.inverse_spacing(), 0.7 * kernel_widths()[9].spacing * (1 + epsilon));
  for (std::int64_t point = -3 * n; point < 3 * n; ++point) {
    const std::int64_t wrapped = axis.wrapped(point);
    EXPECT_TRUE(wrapped >= 0 && wrapped < n);
    EXPECT_EQ((point - wrapped) % n, 0);
  }
  EXPECT_EQ(LatticeAxis(0.7, kernel_widths()[9]).wrapped(-12345), -12345);
}

/// Covariance of normalized images (docs/math.md, eq. 25, for one Gaussian along one axis).
double periodised(double x, double period, double scale) {
  return periodic_bell(x, period, scale) / periodic_bell(0, period, scale);
}

/// From half a scale (constant) to a hundred scales, on either side of where a period is too short
/// to matter among them.
std::vector<double> some_periods() {
  std::vector<double> periods = {(1 - 1e-9) / flat_periods, (1 + 1e-9) / flat_periods};
  for (double period = 0.5; period <= 100; period *= 1.0837) periods.push_back(period);
  return periods;
}

// The spacing is at most that of the table, under a kernel of the same reach, so that the error
// stated there holds here.
TEST(PeriodicAxis, HasTheCovarianceOfAllImages) {
  for (const KernelWidth& width : kernel_widths())
    for (const double period : some_periods()) {
      const LatticeAxis axis(1, width, period);
      double largest = 0;
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 36; ++j) {
          const double x = (i + 1e-9) / 12 * std::min(period, width.spacing);
          const double y = x + std::min(period, 12.0) * (j - 18) / 18;
          largest =
              std::max(largest, std::abs(covariance(axis, x, y) -
                                         periodised(std::remainder(y - x, period), period, 1)));
        }
      EXPECT_LE(largest, width.error) << width.n_points << " points, period " << period;
    }
}

// Around a period everything repeats: places moved by whole periods have the same weights on the
// same points, but for the rounding of the places.
TEST(PeriodicAxis, RepeatsAfterAPeriod) {
  for (const double period : {1.01, 1.7, 3.0, 12.5}) {
    const LatticeAxis axis(1, kernel_widths()[9], period);
    for (const double x : {0.0, 0.1, 0.93, 4.3})
      for (const int n : {-2, -1, 1, 5}) {
        EXPECT_NEAR(covariance(axis, x, x + n * period), covariance(axis, x, x), 1e-13);
        EXPECT_NEAR(covariance(axis, x + n * period, 0.4), covariance(axis, x, 0.4), 1e-13);
      }
  }
}

/// Rows written out on all points of the period, several times round it where they are longer.
std::vector<double> spread_out(const LatticeAxis& axis, const AxisRow& row) {
  std::vector<double> noise(static_cast<std::size_t>(axis.n_period()));
  for (std::size_t k = 0; k < values_of(row).size(); ++k) {
    const std::int64_t point = row.first + static_cast<std::int64_t>(k);
    const std::int64_t n = axis.n_period();
    noise[static_cast<std::size_t>((point % n + n) % n)] += row.value[k];
  }
  return noise;
}

std::vector<double> some_values(std::size_t n, double step) {
  std::vector<double> values;
  for (std::size_t k = 0; k < n; ++k) values.push_back(std::sin(1 + step * static_cast<double>(k)));
  return values;
}

TEST(RowProduct, SumsOverSharedPointsModuloThePeriod) {
  const KernelWidth width = kernel_widths()[9];
  for (const double period : {0.61, 1.3, 5.0, 40.0}) {
    const LatticeAxis axis(0.6, width, period);
    for (std::int64_t first = -90; first < 90; first += 7)
      for (const std::size_t size : {1, 2, 5, 12, 31, 40}) {
        const AxisRow a = make_row(first, some_values(size, 3.7));
        const AxisRow b = make_row(3, some_values(11, 1.3));
        const std::vector<double> x = spread_out(axis, a), y = spread_out(axis, b);
        double sum = 0;
        for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k];
        EXPECT_NEAR(row_product(axis, a, b), sum, 1e-12) << period << ' ' << first << ' ' << size;
        EXPECT_NEAR(row_product(axis, b, a), sum, 1e-12) << period << ' ' << first << ' ' << size;
      }
  }
}

TEST(RowProduct, IsZeroForRowsThatShareNoPoint) {
  const LatticeAxis axis(1, kernel_widths()[9]);
  const AxisRow a = make_row(-4, {1, 2, 3});
  EXPECT_EQ(row_product(axis, a, make_row(-1, {5, 7})), 0);
  EXPECT_EQ(row_product(axis, a, make_row(-6, {5, 7})), 0);
  EXPECT_EQ(row_product(axis, a, make_row(-5, {5, 7})), 7);
  EXPECT_EQ(row_product(axis, a, make_row(-2, {5, 7})), 15);
  EXPECT_EQ(row_product(axis, a, make_row(-3, {5, 7})), 31);
  EXPECT_EQ(row_product(axis, a, make_row(std::int64_t{1} << 60, {5, 7})), 0);
}

}  // namespace
}  // namespace roughmesh::detail
