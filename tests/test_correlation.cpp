// SPDX-License-Identifier: BSD-3-Clause
// Correlations of every kind of distance against closed forms, brute force and their definitions.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/correlation.hpp"

#include "support/errors.hpp"

namespace roughmesh {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_points(int n, const Vec3& size, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(size.x() * uniform(engine), size.y() * uniform(engine),
                        size.z() * uniform(engine));
  return points;
}

/// Sum of rho over the images in a box, by definition (docs/math.md, eq. 25).
double brute_force_sum(const Autocorrelation& acf, const Vec3& x, const Vec3& period,
                       const Vec3& lengths, double reach) {
  std::array<int, 3> n{};
  for (int axis = 0; axis < 3; ++axis)
    if (period[axis] > 0)
      n[axis] =
          static_cast<int>(std::ceil((reach * lengths[axis] + std::abs(x[axis])) / period[axis]));
  double sum = 0;
  for (int i = -n[0]; i <= n[0]; ++i)
    for (int j = -n[1]; j <= n[1]; ++j)
      for (int k = -n[2]; k <= n[2]; ++k) {
        const Vec3 image(x[0] + i * period[0], x[1] + j * period[1], x[2] + k * period[2]);
        sum += acf.rho(lengths[0] * image.cwiseQuotient(lengths).norm());
      }
  return sum;
}

struct Case {
  std::string name;
  AutocorrelationOptions acf;
  Vec3 period;
  double reach;                 ///< lengths beyond which rho < 1e-14
  Vec3 lengths = Vec3::Zero();  ///< along the axes; of the autocorrelation where zero
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class EveryFamily : public testing::TestWithParam<Case> {};

// The promise of 1e-12, against sums of up to 4e5 terms, of which round-off leaves less than 1e-13
// of the sum.
TEST_P(EveryFamily, PeriodicCorrelationIsTheSumOverImages) {
  const auto& [name, options, period, reach, given] = GetParam();
  const Autocorrelation acf(options);
  const Vec3 lengths = given.isZero() ? Vec3::Constant(acf.length()) : given;
  const Distance distance =
      Distance::periodic(period, {.lengths = {lengths[0], lengths[1], lengths[2]}});
  const std::vector<Vec3> points = random_points(12, Vec3(2.3, 1.1, 0.6), 5);
  const Correlation correlation(points, acf, distance);
  const double total = brute_force_sum(acf, Vec3::Zero(), period, lengths, reach);
  for (Index i = 0; i < correlation.n_points(); ++i)
    for (Index j = 0; j < i; ++j)
      ASSERT_NEAR(correlation(i, j),
                  brute_force_sum(acf, points[i] - points[j], period, lengths, reach) / total,
                  1e-12)
          << i << ", " << j;
}

std::vector<Case> every_family() {
  const Vec3 x(1, 0, 0), xy(1, 0.8, 0), xyz(1, 0.8, 1.2);
  const auto of = [](Family family, double length) {
    return AutocorrelationOptions{.family = family, .length = length};
  };
  const auto matern = [](double nu, double length) {
    return AutocorrelationOptions{.family = Family::matern, .length = length, .nu = nu};
  };
  const auto stretched = [](double power, double length) {
    return AutocorrelationOptions{.family = Family::stretched, .length = length, .power = power};
  };
  return {{"gaussian_short", of(Family::gaussian, 0.1), xyz, 9},
          {"gaussian_0_3", of(Family::gaussian, 0.3), xyz, 9},
          {"gaussian_x", of(Family::gaussian, 0.3), x, 9},
          {"gaussian_long", of(Family::gaussian, 3.0), xy, 9},
          {"gaussian_oblong", of(Family::gaussian, 0.25), Vec3(1, 0.05, 0), 9},
          {"gaussian_anisotropic", of(Family::gaussian, 0.3), xyz, 9, Vec3(0.3, 0.05, 0.8)},
          {"exponential_x", of(Family::exponential, 0.2), x, 38},
          {"exponential_long", of(Family::exponential, 100.0), x, 40},
          {"exponential_xy", of(Family::exponential, 0.5), xy, 38},
          {"exponential_xyz", of(Family::exponential, 0.5), xyz, 38},
          {"exponential_anisotropic", of(Family::exponential, 0.3), xy, 38, Vec3(0.3, 0.1, 0.5)},
          {"matern_0_2", matern(0.2, 0.3), xy, 60},
          {"matern_1_5", matern(1.5, 0.4), xyz, 24},
          {"matern_40", matern(40, 0.4), xyz, 11},
          {"matern_1e6", matern(1e6, 0.4), xyz, 9},
          {"matern_1e12", matern(1e12, 0.4), xyz, 9},
          {"stretched_0_3", stretched(0.3, 1e-4), Vec3(1, 0, 0), 2e5},
          {"stretched_0_7", stretched(0.7, 0.05), xy, 170},
          {"stretched_1_2", stretched(1.2, 0.4), xy, 20},
          {"stretched_1_7", stretched(1.7, 0.4), xyz, 9},
          {"stretched_1_98", stretched(1.98, 0.5), xyz, 7},
          {"stretched_2", stretched(2, 0.5), xyz, 7},
          {"self_affine", {.family = Family::self_affine, .hurst = 0.8, .rolloff = 3.0}, xy, 38},
          {"rational_quadratic_12",
           {.family = Family::rational_quadratic, .length = 0.2, .alpha = 12},
           xy,
           60},
          {"rational_quadratic_1e12",
           {.family = Family::rational_quadratic, .length = 0.4, .alpha = 1e12},
           xyz,
           9}};
}

INSTANTIATE_TEST_SUITE_P(Box, EveryFamily, testing::ValuesIn(every_family()),
                         [](const auto& each) { return each.param.name; });

// Geometric series of the images on both sides, for l from a hundredth of the period to a thousand.
TEST(PeriodicCorrelation, ExponentialOnOneAxisIsARatioOfHyperbolicCosines) {
  const double period = 2.5;
  for (const double length : {0.025, 0.3, 2.5, 40.0, 2500.0}) {
    const std::vector<Vec3> points = random_points(40, Vec3(7, 0, 0), 3);
    const Correlation correlation(
        points, Autocorrelation({.family = Family::exponential, .length = length}),
        Distance::periodic(Vec3(period, 0, 0)));
    for (Index i = 0; i < correlation.n_points(); ++i) {
      const double x = std::abs(points[i].x() - points[0].x());
      const double u = std::fmod(x, period) - period / 2, half = period / 2;
      const double expected = std::exp((std::abs(u) - half) / length) *
                              (1 + std::exp(-2 * std::abs(u) / length)) /
                              (1 + std::exp(-2 * half / length));
      ASSERT_NEAR(correlation(i, 0), expected, 1e-12) << length << " at " << x;
    }
  }
}

// sum_n c^2 / (c^2 + (x + n)^2) = pi c sinh(2 pi c) / (cosh(2 pi c) - cos(2 pi x)): a sum whose
// terms fall off like 1 / n^2 only.
TEST(PeriodicCorrelation, RationalQuadraticHasItsWholeTail) {
  for (const double c : {0.02, 0.3, 1.0, 5.0}) {
    const std::vector<Vec3> points = random_points(40, Vec3(1, 0, 0), 4);
    const Correlation correlation(points,
                                  Autocorrelation({.family = Family::rational_quadratic,
                                                   .length = c / std::numbers::sqrt2,
                                                   .alpha = 1.0}),
                                  Distance::periodic(Vec3(1, 0, 0)));
    for (Index i = 0; i < correlation.n_points(); ++i) {
      const double x = points[i].x() - points[0].x();
      const double a = std::pow(std::sinh(pi * c), 2), b = std::pow(std::sin(pi * x), 2);
      ASSERT_NEAR(correlation(i, 0), a / (a + b), 1e-12) << c;
    }
  }
}

// By Poisson's formula; with a = 3/2 in the plane the transform of rho is c^2 exp(-c q), so that
// the ratio of two rapidly converging sums over whole wavenumbers is left.
TEST(PeriodicCorrelation, RationalQuadraticHasItsWholeTailInThePlane) {
  const double c = 0.6;  // c^2 = 2 a l^2
  const auto sum = [&](const Vec3& x) {
    double total = 0;
    for (int i = -15; i <= 15; ++i)
      for (int j = -15; j <= 15; ++j)
        total +=
            std::exp(-c * 2 * pi * std::hypot(i, j)) * std::cos(2 * pi * (i * x.x() + j * x.y()));
    return total;
  };
  const std::vector<Vec3> points = random_points(30, Vec3(1, 1, 0), 4);
  const Correlation correlation(
      points,
      Autocorrelation(
          {.family = Family::rational_quadratic, .length = c / std::sqrt(3.0), .alpha = 1.5}),
      Distance::periodic(Vec3(1, 1, 0)));
  for (Index i = 0; i < correlation.n_points(); ++i)
    ASSERT_NEAR(correlation(i, 0), sum(points[i] - points[0]) / sum(Vec3::Zero()), 1e-12);
}

// They differ from the Gaussian by about 1 / shape. With quadratures that got longer with the shape
// this would never end.
TEST(PeriodicCorrelation, OfShapesWithoutBoundsIsThatOfTheGaussian) {
  const std::vector<Vec3> points = random_points(20, Vec3(1, 1, 1), 3);
  const Distance distance = Distance::periodic(Vec3(1, 0.8, 1.2));
  const Correlation gaussian(points, Autocorrelation({.length = 0.4}), distance);
  for (const double shape : {1e14, 1e18, 1e100, 1e300})
    for (const Autocorrelation& acf :
         {Autocorrelation({.family = Family::matern, .length = 0.4, .nu = shape}),
          Autocorrelation({.family = Family::rational_quadratic, .length = 0.4, .alpha = shape})}) {
      const Correlation correlation(points, acf, distance);
      for (Index i = 1; i < correlation.n_points(); ++i)
        EXPECT_NEAR(correlation(0, i), gaussian(0, i), 1e-12) << shape;
    }
}

// Of exp(-(r / l)^p) in the plane the images add up to 2 pi Gamma(2 / p) (l / L)^2 / p; beyond 1e16
// nothing is left of what differs from place to place.
TEST(PeriodicCorrelation, OfTooSlowADecayIsRefused) {
  const std::vector<Vec3> points = random_points(5, Vec3(1, 1, 1), 1);
  const auto message = [&](double power, double length, double period) {
    return test::message_of([&] {
      Correlation(points,
                  Autocorrelation({.family = Family::stretched, .length = length, .power = power}),
                  Distance::periodic(Vec3(period, period, 0)));
    });
  };
  for (const double power : {1e-300, 1e-6, 1e-3, 0.02, 0.1})
    EXPECT_NE(message(power, 0.4, 1).find(fmt::format("--power: {:g};", power)), std::string::npos);
  EXPECT_NE(message(0.2, 1e6, 1).find("--power: 0.2;"), std::string::npos);
  for (const double power : {0.15, 0.2, 1.0, 2.0}) EXPECT_EQ(message(power, 0.4, 1), "no error");
  EXPECT_NE(message(0.2, 1, 1e-6).find("--power: 0.2;"), std::string::npos);
  EXPECT_EQ(message(0.1, 1e-6, 1), "no error");
  EXPECT_EQ(message(0.1, 1, 1e6), "no error");
}

TEST(PeriodicCorrelation, IsOneAtImagesAndSymmetric) {
  const Vec3 period(1, 0.8, 0);
  std::vector<Vec3> points = random_points(10, Vec3(1, 0.8, 0.4), 6);
  for (int i = 0; i < 10; ++i) points.push_back(points[i] + Vec3(period.x(), -2 * period.y(), 0));
  for (const Family family : {Family::gaussian, Family::exponential}) {
    const Correlation correlation(points, Autocorrelation({.family = family, .length = 0.3}),
                                  Distance::periodic(period));
    for (Index i = 0; i < 10; ++i) {
      EXPECT_EQ(correlation(i, i), 1);
      EXPECT_NEAR(correlation(i, i + 10), 1, 1e-14);  // rounding of the positions: 1e-16 / l
      for (Index j = 0; j < 10; ++j) {
        EXPECT_EQ(correlation(i, j), correlation(j, i));
        EXPECT_NEAR(correlation(i, j), correlation(i + 10, j), 1e-14);
      }
    }
  }
}

double smallest_eigenvalue(const Correlation& correlation) {
  const Index n = correlation.n_points();
  Eigen::MatrixXd matrix(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) matrix(i, j) = correlation(i, j);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

// The paper's closed line of 100 points, l / c = 0.1: its spectrum of the minimum image has a floor
// of either sign at rho(c / 2) = 4e-6 and below, the sum over images has none. An error of 1e-12 in
// every entry moves eigenvalues by n times it.
TEST(PeriodicCorrelation, HasNoNegativeEigenvaluesWhereTheMinimumImageHas) {
  std::vector<Vec3> line;
  for (int i = 0; i < 100; ++i) line.emplace_back(i, 0, 0);
  const Vec3 period(100, 0, 0);
  const Autocorrelation gaussian({.length = 10});
  EXPECT_GT(smallest_eigenvalue({line, gaussian, Distance::periodic(period)}), -1e-10);
  EXPECT_LT(smallest_eigenvalue({line, gaussian, Distance::minimum_image(period)}), -1e-7);

  const std::vector<Vec3> points = random_points(200, Vec3(1, 1, 0.5), 8);
  for (const auto& [family, shape] :
       {std::pair{Family::gaussian, 0.0}, std::pair{Family::stretched, 1.5}}) {
    const Autocorrelation acf({.family = family,
                               .length = 0.5,
                               .power = shape > 0 ? std::optional(shape) : std::nullopt});
    EXPECT_GT(smallest_eigenvalue({points, acf, Distance::periodic(Vec3(1, 1, 1))}), -2e-10);
  }
}

TEST(PeriodicCorrelation, StreaksNeedNoPeriodAlongThem) {
  const std::vector<Vec3> points = random_points(20, Vec3(1, 1, 0), 2);
  const Autocorrelation acf({.family = Family::exponential, .length = 0.2});
  const Anisotropy streaks{.lengths = {0.2, infinite, 0.2}};
  const Correlation both(points, acf, Distance::periodic(Vec3(1, 1, 0), streaks));
  const Correlation across(points, acf, Distance::periodic(Vec3(1, 0, 0), streaks));
  const Correlation along(points, acf, Distance::periodic(Vec3(0, 1, 0), streaks));
  for (Index i = 1; i < 20; ++i) {
    EXPECT_EQ(both(i, 0), across(i, 0));
    EXPECT_NEAR(along(i, 0), acf.rho(std::abs(points[i].x() - points[0].x())), 1e-15);
  }
}

TEST(PeriodicCorrelation, RefusesSumsThatDivergeAndTurnedAxes) {
  const std::vector<Vec3> points = random_points(5, Vec3(1, 1, 1), 1);
  const auto make = [&](double alpha, const Vec3& period) {
    const Correlation correlation(
        points,
        Autocorrelation({.family = Family::rational_quadratic, .length = 0.2, .alpha = alpha}),
        Distance::periodic(period));
  };
  EXPECT_NO_THROW(make(0.6, Vec3(1, 0, 0)));
  EXPECT_NO_THROW(make(1.01, Vec3(1, 1, 0)));
  const std::string message = test::message_of([&] { make(1.0, Vec3(1, 1, 0)); });
  EXPECT_NE(message.find("--alpha 1 "), std::string::npos) << message;
  EXPECT_NE(message.find("diverges"), std::string::npos) << message;
  EXPECT_THROW(make(1.5, Vec3(1, 1, 1)), InputError);

  Anisotropy turned{.lengths = {0.1, 0.2, 0.3}};
  turned.axes = Eigen::AngleAxisd(0.3, Vec3::UnitZ()).toRotationMatrix();
  for (const auto& make_distance : {Distance::periodic, Distance::minimum_image}) {
    EXPECT_NE(test::message_of([&] { make_distance(Vec3(1, 0, 0), turned); }).find("--angle"),
              std::string::npos);
    for (const Vec3& period :
         {Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(infinite, 0, 0), Vec3(std::nan(""), 1, 0)})
      EXPECT_THROW(make_distance(period, {.lengths = {1, 1, 1}}), InputError);
  }
  EXPECT_THROW(Correlation(points, Autocorrelation({.length = 0.1}),
                           Distance::periodic(Vec3(1e12, 1, 1e-6))),
               InputError);
}

TEST(MinimumImage, IsTheDistanceOfTheNearestImage) {
  const Vec3 period(1, 0.8, 0), lengths(0.5, 0.25, 1);
  const std::vector<Vec3> points = random_points(30, Vec3(2.5, 3, 1), 9);
  const Distance distance =
      Distance::minimum_image(period, {.lengths = {lengths[0], lengths[1], lengths[2]}});
  for (const Vec3& y : points) {
    double nearest = infinite;
    for (int i = -4; i <= 4; ++i)
      for (int j = -5; j <= 5; ++j) {
        const Vec3 image = points[0] - y + Vec3(i * period[0], j * period[1], 0);
        nearest = std::min(nearest, lengths[0] * image.cwiseQuotient(lengths).norm());
      }
    EXPECT_NEAR(distance(points[0], y), nearest, 1e-14);
    EXPECT_EQ(distance(points[0], y), distance(y, points[0]));
  }
  EXPECT_EQ(name(distance.kind()), "minimum-image");
}

// On one axis the largest difference is that half a period away, where two images are equally near:
// for an exponential 1 / cosh(L / (2 l)) against exp(-L / (2 l)).
TEST(Correlation, ReportsTheLargestDifferenceToTheMinimumImage) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0.1, 0, 0}, {0.5, 0, 0}};
  const Autocorrelation acf({.family = Family::exponential, .length = 0.25});
  const Correlation periodic(points, acf, Distance::periodic(Vec3(1, 0, 0)));
  ASSERT_TRUE(periodic.minimum_image_difference());
  EXPECT_NEAR(*periodic.minimum_image_difference(), 1 / std::cosh(2.0) - std::exp(-2.0), 1e-12);
  EXPECT_FALSE(Correlation(points, acf, Distance::euclidean()).minimum_image_difference());
}

// With more points than are compared, pairs spread over all come within one spacing, 1 / 3000, of
// half a period, where the slope of the difference is exp(-L / (2 l)) / l.
TEST(Correlation, OfManyPointsSomePairsTellTheDifferenceToTheMinimumImage) {
  constexpr int n = 3000;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.emplace_back(static_cast<double>(i) / n, 0, 0);
  const Correlation periodic(points,
                             Autocorrelation({.family = Family::exponential, .length = 0.25}),
                             Distance::periodic(Vec3(1, 0, 0)));
  const double largest = 1 / std::cosh(2.0) - std::exp(-2.0), slope = std::exp(-2.0) / 0.25;
  EXPECT_LE(*periodic.minimum_image_difference(), largest + 1e-12);
  EXPECT_GE(*periodic.minimum_image_difference(), largest - slope / n);
}

TEST(Correlation, CopiesOutliveWhatTheyWereCopiedFrom) {
  const std::vector<Vec3> points = random_points(20, Vec3(1, 1, 1), 3);
  const std::vector<Index> all = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                  10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
  std::vector<Correlation> copies;
  {
    const Correlation original(points, Autocorrelation({.length = 0.3}), Distance::euclidean());
    copies = {original, original.among(all)};
  }
  for (const Correlation& copy : copies) {
    ASSERT_EQ(copy.n_points(), 20);
    for (Index i = 0; i < 20; ++i) EXPECT_EQ(copy.places()[i], points[i]);
  }
}

TEST(Correlation, AmongSomePointsIsTheCorrelationOfThose) {
  const std::vector<Vec3> points = random_points(20, Vec3(1, 1, 1), 12);
  const Correlation all(points, Autocorrelation({.length = 0.3}),
                        Distance::periodic(Vec3(1, 1, 0)));
  const std::vector<Index> some = {17, 3, 4};
  const Correlation part = all.among(some);
  ASSERT_EQ(part.n_points(), 3);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_EQ(part.places()[i], points[some[i]]);
    for (Index j = 0; j < 3; ++j) EXPECT_EQ(part(i, j), all(some[i], some[j]));
  }
  for (const Index wrong : {-1, 20}) {
    const std::vector<Index> outside = {wrong};
    EXPECT_THROW(all.among(outside), InputError);
  }
}

TEST(Correlation, RefusesPlacesThatAreNone) {
  const Autocorrelation acf({.length = 1});
  EXPECT_THROW(Correlation({Vec3(0, infinite, 0)}, acf, Distance::euclidean()), InputError);
  const Distance curve = Distance::curve({infinite, 5});
  EXPECT_NO_THROW(Correlation({Vec3(0, 1, 0)}, acf, curve));
  for (const double piece : {-1.0, 0.5, 2.0})
    EXPECT_THROW(Correlation({Vec3(0, piece, 0)}, acf, curve), InputError) << piece;
}

}  // namespace
}  // namespace roughmesh
