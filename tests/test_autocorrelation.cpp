// SPDX-License-Identifier: BSD-3-Clause
// Families, their limits and conversions against their definitions.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/mesh.hpp"

using namespace roughmesh;

namespace {

constexpr double pi = std::numbers::pi;

Autocorrelation gaussian(double length = 1) { return Autocorrelation({.length = length}); }
Autocorrelation exponential(double length = 1) {
  return Autocorrelation({.family = Family::exponential, .length = length});
}
Autocorrelation matern(double nu, double length = 1) {
  return Autocorrelation({.family = Family::matern, .length = length, .nu = nu});
}
Autocorrelation self_affine(double hurst, double length = 1) {
  return Autocorrelation({.family = Family::self_affine, .length = length, .hurst = hurst});
}
Autocorrelation stretched(double power, double length = 1) {
  return Autocorrelation({.family = Family::stretched, .length = length, .power = power});
}
Autocorrelation rational_quadratic(double alpha, double length = 1) {
  return Autocorrelation({.family = Family::rational_quadratic, .length = length, .alpha = alpha});
}

struct Named {
  std::string name;
  Autocorrelation acf;
};

std::vector<Named> all_families() {
  std::vector<Named> list = {{"gaussian", gaussian()}, {"exponential", exponential()}};
  for (const double nu : {0.05, 0.5, 1.0, 1.5, 2.2, 2.5, 40.0, 1e6})
    list.push_back({"matern " + std::to_string(nu), matern(nu)});
  for (const double hurst : {0.1, 0.5, 0.8})
    list.push_back({"self-affine " + std::to_string(hurst), self_affine(hurst)});
  for (const double power : {0.1, 0.7, 1.0, 1.6, 2.0})
    list.push_back({"stretched " + std::to_string(power), stretched(power)});
  for (const double alpha : {0.1, 1.0, 20.0})
    list.push_back({"rational-quadratic " + std::to_string(alpha), rational_quadratic(alpha)});
  return list;
}

// Composite Gauss-Legendre rule of 5 points on panels between the given bounds.
double integrate(const std::vector<double>& bounds, const std::function<double(double)>& f) {
  const std::vector<std::pair<double, double>> rule = {
      {0, 128.0 / 225},
      {0.538469310105683091, 0.478628670499366468},
      {0.906179845938663993, 0.236926885056189088}};
  double sum = 0;
  for (std::size_t k = 1; k < bounds.size(); ++k) {
    const double middle = (bounds[k] + bounds[k - 1]) / 2, half = (bounds[k] - bounds[k - 1]) / 2;
    for (const auto& [x, weight] : rule)
      sum += weight * half * (x == 0 ? f(middle) : f(middle - half * x) + f(middle + half * x));
  }
  return sum;
}

// Panels that shrink towards 0, where rho may have a cusp, and are at most `widest` wide.
std::vector<double> graded_panels(double end, double widest) {
  std::vector<double> bounds = {0, end * 1e-30};
  while (bounds.back() < end)
    bounds.push_back(std::min({1.5 * bounds.back(), bounds.back() + widest, end}));
  return bounds;
}

// K_nu(z) e^z from the integral of exp(-z (cosh t - 1)) cosh(nu t), https://dlmf.nist.gov/10.32.E9,
// by the trapezoidal rule, which converges exponentially; logarithms keep cosh from overflowing.
double log_scaled_bessel_k(double nu, double z) {
  constexpr double step = 0.01;
  const auto exponent = [&](double t) {
    const double s = std::sinh(t / 2);
    return -2 * z * s * s + nu * t + std::log1p(std::exp(-2 * nu * t)) - std::log(2);
  };
  const double peak = exponent(std::asinh(nu / z));
  double sum = std::exp(exponent(0) - peak) / 2;
  for (int k = 1; k < 4000; ++k) sum += std::exp(exponent(k * step) - peak);
  return std::log(sum * step) + peak;
}

double definition_matern(double nu, double r) {
  const double z = std::sqrt(2 * nu) * r;
  return std::exp((1 - nu) * std::log(2) - std::lgamma(nu) + nu * std::log(z) - z +
                  log_scaled_bessel_k(nu, z));
}

std::string message_of(const AutocorrelationOptions& options) {
  try {
    const Autocorrelation acf(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

}  // namespace

TEST(Autocorrelation, IsOneAtZeroAndDecreasesTowardsZero) {
  for (const auto& [name, acf] : all_families()) {
    EXPECT_EQ(acf.rho(0), 1) << name;
    double previous = 1;
    for (double e = -60; e < 12; e += 0.013) {
      const double rho = acf.rho(std::exp2(e));
      EXPECT_GE(rho, 0) << name;
      EXPECT_LE(rho, previous + 4e-15) << name << " at " << std::exp2(e);  // rounding of exp
      previous = rho;
    }
    EXPECT_LT(previous, 0.2) << name;
    EXPECT_LE(acf.rho(1e300), previous) << name;
  }
}

// Points in a ball of a few correlation lengths; -1e-10 covers the rounding of R (N eps = 3e-14)
// and its errors of 1e-12 (times N at most).
TEST(Autocorrelation, IsPositiveDefiniteInSpace) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::vector<Vec3> points(150);
  for (Vec3& x : points) x = Vec3(uniform(engine), uniform(engine), uniform(engine));
  const auto n = static_cast<Eigen::Index>(points.size());
  for (const auto& [name, acf] : all_families()) {
    Eigen::MatrixXd matrix(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) matrix(i, j) = acf.rho((points[i] - points[j]).norm());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
    EXPECT_GE(solver.eigenvalues().minCoeff(), -1e-10) << name;
  }
}

// The reference adds terms of 1e3 to 1e4 in the exponent for nu = 300: 1e4 eps = 2e-12.
TEST(Autocorrelation, MaternEqualsItsBesselFunction) {
  for (const double nu : {0.05, 0.3, 0.74, 0.76, 1.0, 1.3, 3.0, 7.7, 15.9, 16.1, 60.0, 300.0})
    for (const double r : {1e-4, 0.01, 0.3, 1.0, 2.0, 5.0, 12.0, 25.0})
      EXPECT_NEAR(matern(nu).rho(r), definition_matern(nu, r), nu < 20 ? 1e-13 : 2e-12)
          << nu << " at " << r;
}

// The function for any nu meets the closed forms of its neighbours: |d rho / d nu| < 0.3.
TEST(Autocorrelation, MaternIsContinuousAtItsClosedForms) {
  for (const double nu : {0.5, 1.5, 2.5})
    for (const double r : {1e-6, 0.01, 0.3, 1.0, 3.0, 10.0, 30.0}) {
      const double next = std::nextafter(nu, 10);
      EXPECT_NEAR(matern(nu).rho(r), matern(next).rho(r), 1e-14) << nu << " at " << r;
    }
}

// rho is the mean of exp(-x^2 g / 2) with g of variance 1/nu: the first correction to the Gaussian
// is exp(-x^2/2) (x^4/8 - x^2/2) / nu, below 0.2 / nu.
TEST(Autocorrelation, MaternTendsToGaussian) {
  for (const double nu : {1e2, 1e4, 1e6, 1e9, 1e12})
    for (const double r : {1e-3, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0})
      EXPECT_NEAR(matern(nu).rho(r), gaussian().rho(r), 0.25 / nu + 5e-15) << nu << " at " << r;
}

TEST(Autocorrelation, RationalQuadraticTendsToGaussian) {
  for (const double alpha : {1e2, 1e4, 1e6, 1e12})
    for (const double r : {1e-3, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0})
      EXPECT_NEAR(rational_quadratic(alpha).rho(r), gaussian().rho(r), 0.5 / alpha + 5e-15);
}

TEST(Autocorrelation, FamiliesAgreeAtTheirCommonMembers) {
  const double rolloff = 3;
  const Autocorrelation by_rolloff(
      {.family = Family::self_affine, .hurst = 0.5, .rolloff = rolloff});
  for (const double r : {0.0, 1e-3, 0.2, 1.0, 3.0, 9.0}) {
    EXPECT_DOUBLE_EQ(matern(0.5).rho(r), exponential().rho(r));
    EXPECT_DOUBLE_EQ(stretched(1).rho(r), exponential().rho(r));
    EXPECT_NEAR(stretched(2).rho(r), gaussian(1 / std::sqrt(2.0)).rho(r), 1e-15);
    EXPECT_DOUBLE_EQ(self_affine(0.7).rho(r), matern(0.7).rho(r));
    EXPECT_DOUBLE_EQ(by_rolloff.rho(r), exponential(rolloff / (2 * pi)).rho(r));
    EXPECT_DOUBLE_EQ(rational_quadratic(1).rho(r), 1 / (1 + r * r / 2));
  }
}

// Spectrum (1 + q^2/q_r^2)^(-1-H): half of it, to the power -H, lies above q_r sqrt(2^(1/H) - 1).
TEST(Autocorrelation, RolloffIsTheWavelengthOfTheCornerOfTheSpectrum) {
  for (const double hurst : {0.2, 0.5, 0.9}) {
    const Autocorrelation acf({.family = Family::self_affine, .hurst = hurst, .rolloff = 5.0});
    const double corner = 2 * pi / 5;
    EXPECT_NEAR(acf.spectrum_share_above(corner * std::sqrt(std::pow(2, 1 / hurst) - 1), 2), 0.5,
                1e-12);
  }
}

TEST(Autocorrelation, ScalesWithTheLengthUnit) {
  for (const double unit : {1e-18, 1e-9, 1024.0, 1e18}) {
    EXPECT_NEAR(gaussian(unit).rho(1.7 * unit), gaussian().rho(1.7), 1e-15);
    EXPECT_NEAR(matern(0.8, unit).rho(1.7 * unit), matern(0.8).rho(1.7), 1e-15);
    EXPECT_NEAR(stretched(1.4, unit).rho(1.7 * unit), stretched(1.4).rho(1.7), 1e-15);
    EXPECT_NEAR(rational_quadratic(2, unit).spectrum_share_above(1.7 / unit, 2),
                rational_quadratic(2).spectrum_share_above(1.7, 2), 1e-14);
    EXPECT_NEAR(matern(3, unit).slope_variance().value() * unit * unit, 1.5, 1e-14);
  }
}

TEST(Autocorrelation, EquivalentLengthsMeetTheirDefinitions) {
  for (const auto& [name, acf] : all_families()) {
    const EquivalentLengths lengths = acf.equivalent_lengths();
    EXPECT_EQ(lengths.formula, acf.length());
    // |d log rho / d log r| is at most 2 |log rho| and the distance is right to a few eps.
    EXPECT_NEAR(acf.rho(lengths.one_over_e), std::exp(-1), 1e-13) << name;
    EXPECT_NEAR(acf.rho(lengths.sal), 0.2, 1e-13) << name;
  }
  EXPECT_NEAR(stretched(0.01, 7.0).equivalent_lengths().sal / (7 * std::pow(std::log(5.0), 100)), 1,
              1e-12);
}

// Families that decay fast enough for a plain integral up to 200 l.
TEST(Autocorrelation, IntegralScaleIsTheIntegral) {
  const std::vector<double> panels = graded_panels(200, 0.25);
  for (const Autocorrelation& acf :
       {gaussian(), exponential(), matern(0.3), matern(2.2), matern(200), self_affine(0.7),
        stretched(0.7), stretched(1.6), stretched(2), rational_quadratic(8)})
    EXPECT_NEAR(acf.equivalent_lengths().integral.value(),
                integrate(panels, [&](double r) { return acf.rho(r); }), 2e-9)
        << name(acf.family());
  EXPECT_FALSE(rational_quadratic(0.5).equivalent_lengths().integral);
  EXPECT_NEAR(rational_quadratic(1).equivalent_lengths().integral.value(), pi / std::sqrt(2.0),
              1e-14);
  EXPECT_NEAR(matern(1e6).equivalent_lengths().integral.value(), std::sqrt(pi / 2), 1e-6);
}

TEST(Autocorrelation, EveryLengthDefinitionGivesBackTheLengthItWasGiven) {
  for (const auto& [name, unit] : all_families()) {
    if (name == "rational-quadratic " + std::to_string(0.1)) continue;  // no integral scale
    AutocorrelationOptions options{.family = unit.family(), .length = 3.0};
    const double shape =
        name.find(' ') == std::string::npos ? 0 : std::stod(name.substr(name.find(' ')));
    if (unit.family() == Family::matern) options.nu = shape;
    if (unit.family() == Family::self_affine) options.hurst = shape;
    if (unit.family() == Family::stretched) options.power = shape;
    if (unit.family() == Family::rational_quadratic) options.alpha = shape;
    options.length_definition = LengthDefinition::one_over_e;
    EXPECT_NEAR(Autocorrelation(options).equivalent_lengths().one_over_e, 3, 1e-14) << name;
    options.length_definition = LengthDefinition::integral;
    EXPECT_NEAR(Autocorrelation(options).equivalent_lengths().integral.value(), 3, 1e-14) << name;
    options.length_definition = LengthDefinition::sal;
    EXPECT_NEAR(Autocorrelation(options).equivalent_lengths().sal, 3, 1e-14) << name;
  }
}

// 1 - q int rho(r) J_1(q r) dr in the plane, 1 - (2/pi) int rho(r) sin(q r)/r dr on a line: by
// parts from the transforms of rho. Panels of a quarter wavelength: error of the rule below 1e-8
// each.
TEST(Autocorrelation, SpectrumShareEqualsTheTransform) {
  const auto plane = [](const Autocorrelation& acf, double q, double end) {
    return 1 - q * integrate(graded_panels(end, std::min(0.3, 0.5 * pi / q)),
                             [&](double r) { return acf.rho(r) * ::j1(q * r); });
  };
  const auto line = [](const Autocorrelation& acf, double q, double end) {
    return 1 - 2 / pi * integrate(graded_panels(end, std::min(0.3, 0.5 * pi / q)), [&](double r) {
                 return acf.rho(r) * std::sin(q * r) / r;
               });
  };
  const std::vector<std::pair<Autocorrelation, double>> cases = {
      {gaussian(), 10},   {exponential(), 40},         {matern(0.3), 60},     {matern(1.8), 40},
      {matern(50), 15},   {self_affine(0.7), 50},      {stretched(0.5), 700}, {stretched(0.8), 90},
      {stretched(1), 40}, {stretched(1.2), 25},        {stretched(1.7), 12},  {stretched(1.95), 10},
      {stretched(2), 8},  {rational_quadratic(9), 200}};
  for (const auto& [acf, end] : cases)
    for (const double q : {0.1, 1.0, 2.7, 9.0}) {
      EXPECT_NEAR(acf.spectrum_share_above(q, 2), plane(acf, q, end), 1e-7)
          << name(acf.family()) << " " << end << " at " << q;
      EXPECT_NEAR(acf.spectrum_share_above(q, 1), line(acf, q, end), 1e-7)
          << name(acf.family()) << " " << end << " at " << q;
    }
}

// Where brute force is hopeless: the share of a mean of Gaussians falls with q, from 1 to 0, and
// continues across the closed form at p = 1.
TEST(Autocorrelation, SpectrumShareFallsFromOneToZeroForExtremeParameters) {
  for (const Autocorrelation& acf :
       {matern(1e-6), matern(0.01), matern(1e6), stretched(1e-3), stretched(0.01), stretched(0.999),
        stretched(1.001), stretched(1.999), rational_quadratic(1e-3), rational_quadratic(1e6)})
    for (const int dimension : {1, 2}) {
      EXPECT_EQ(acf.spectrum_share_above(0, dimension), 1);
      double previous = 1;
      for (double q = 1e-12; q < 1e13; q *= 10) {
        const double share = acf.spectrum_share_above(q, dimension);
        EXPECT_GE(share, 0);
        EXPECT_LE(share, previous + 1e-11) << name(acf.family()) << " at " << q;
        previous = share;
      }
      EXPECT_EQ(acf.spectrum_share_above(std::numeric_limits<double>::infinity(), dimension), 0);
    }
  for (const int dimension : {1, 2})
    EXPECT_NEAR(stretched(0.9999999).spectrum_share_above(2, dimension),
                exponential().spectrum_share_above(2, dimension), 1e-6);
}

// -rho''(0) by a difference of rho at r = 1e-3 l; its own error is of order r^2 (or r^(2 nu - 2)).
TEST(Autocorrelation, SlopeVarianceIsTheCurvatureAtZero) {
  constexpr double r = 1e-3;
  for (const Autocorrelation& acf :
       {gaussian(), matern(2.5), matern(3.3), matern(80), stretched(2), rational_quadratic(0.4)})
    EXPECT_NEAR(2 * (1 - acf.rho(r)) / (r * r), acf.slope_variance().value(), 1e-5)
        << name(acf.family());
  for (const Autocorrelation& acf :
       {exponential(), matern(1), matern(0.7), self_affine(0.9), stretched(1.99)})
    EXPECT_FALSE(acf.slope_variance()) << name(acf.family());
}

TEST(Autocorrelation, RefusesParametersOutOfRangeByTheirOptionName) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinite, -infinite}) {
    expect_words(message_of({.length = bad}), {"--length"});
    expect_words(message_of({.family = Family::matern, .length = 1, .nu = bad}), {"--nu"});
    expect_words(message_of({.family = Family::self_affine, .length = 1, .hurst = bad}),
                 {"--hurst", "between 0 and 1"});
    expect_words(message_of({.family = Family::self_affine, .hurst = 0.5, .rolloff = bad}),
                 {"--rolloff"});
    expect_words(message_of({.family = Family::stretched, .length = 1, .power = bad}),
                 {"--power", "at most 2"});
    expect_words(message_of({.family = Family::rational_quadratic, .length = 1, .alpha = bad}),
                 {"--alpha"});
  }
  expect_words(message_of({.length = -3.5}), {"--length", "-3.5", "greater than 0"});
  expect_words(message_of({.family = Family::self_affine, .length = 1, .hurst = 1.0}), {"--hurst"});
  expect_words(message_of({.family = Family::stretched, .length = 1, .power = 2.1}), {"2.1"});
  EXPECT_EQ(message_of({.length = 1e18}), "");
  EXPECT_EQ(message_of({.length = 1e-18}), "");
}

TEST(Autocorrelation, RefusesMissingAndForeignParameters) {
  expect_words(message_of({}), {"--length"});
  expect_words(message_of({.family = Family::matern, .length = 1}), {"matern", "--nu"});
  expect_words(message_of({.family = Family::stretched, .length = 1}), {"stretched", "--power"});
  expect_words(message_of({.family = Family::rational_quadratic, .length = 1}), {"--alpha"});
  expect_words(message_of({.family = Family::self_affine, .hurst = 0.5}),
               {"--length", "--rolloff"});
  expect_words(message_of({.family = Family::self_affine, .length = 1, .hurst = 0.5, .rolloff = 1}),
               {"--length", "--rolloff"});
  expect_words(message_of({.length = 1, .nu = 1}), {"--nu", "matern", "gaussian"});
  expect_words(message_of({.family = Family::matern, .length = 1, .nu = 1, .alpha = 1}),
               {"--alpha"});
  expect_words(message_of({.length = 1, .rolloff = 1}), {"--rolloff", "self-affine"});
}

TEST(Autocorrelation, RefusesLengthDefinitionsThatDoNotExist) {
  expect_words(message_of({.family = Family::self_affine,
                           .length_definition = LengthDefinition::sal,
                           .hurst = 0.5,
                           .rolloff = 1}),
               {"--length-definition", "sal", "--rolloff"});
  expect_words(message_of({.family = Family::rational_quadratic,
                           .length = 1,
                           .length_definition = LengthDefinition::integral,
                           .alpha = 0.5}),
               {"--length-definition", "integral", "0.5"});
  expect_words(message_of({.family = Family::stretched,
                           .length = 1,
                           .length_definition = LengthDefinition::integral,
                           .power = 1e-3}),
               {"--length-definition", "integral", "stretched"});
}

TEST(Autocorrelation, RefusesSpectraItDoesNotHave) {
  EXPECT_THROW(gaussian().spectrum_share_above(-1, 2), InputError);
  EXPECT_THROW(gaussian().spectrum_share_above(std::nan(""), 2), InputError);
  EXPECT_THROW(gaussian().spectrum_share_above(1, 3), InputError);
}
