// SPDX-License-Identifier: BSD-3-Clause
// Measured autocorrelation: file, fit by Gaussians, interpolant, and what follows from them.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/mesh.hpp"

#include "gaussian_mixture.hpp"
#include "monotone_cubic.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

namespace roughmesh {
namespace {

template <class Function>
std::vector<CorrelationPair> pairs_of(const Function& rho, double step, int n) {
  std::vector<CorrelationPair> pairs;
  for (int i = 0; i < n; ++i) pairs.push_back({i * step, rho(i * step)});
  return pairs;
}

Autocorrelation table(std::vector<CorrelationPair> pairs) {
  return Autocorrelation({.family = Family::table, .table = std::move(pairs)});
}

/// Decaying oscillation: no positive mixture of Gaussians comes near.
double oscillation(double r) { return std::exp(-r) * std::cos(4 * r); }

TEST(GaussianMixture, MeetsEveryFamilyToTheAccuracyOfItsLadder) {
  const std::vector<std::pair<AutocorrelationOptions, double>> cases = {
      {{.family = Family::exponential, .length = 1.0}, 2e-5},
      {{.family = Family::matern, .length = 1.0, .nu = 1.5}, 2e-5},
      {{.family = Family::stretched, .length = 1.0, .power = 1.4}, 1e-3},
      {{.family = Family::rational_quadratic, .length = 1.0, .alpha = 1.0}, 2e-5}};
  for (const auto& [options, tolerance] : cases) {
    const Autocorrelation acf(options);
    const auto samples = pairs_of([&](double r) { return acf.rho(r); }, 0.1, 120);
    const auto mixture =
        detail::fit_gaussian_mixture(samples, {.smallest_scale = 0.02, .largest_scale = 40});
    EXPECT_LT(mixture.residual, tolerance) << name(acf.family());
    double sum = 0;
    for (const GaussianTerm& term : mixture.terms) {
      EXPECT_GT(term.weight, 0);
      sum += term.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-15 * 100);
    const auto finer = detail::fit_gaussian_mixture(
        samples, {.smallest_scale = 0.02, .largest_scale = 40, .ratio = std::pow(2.0, 0.25)});
    EXPECT_LT(finer.residual, 0.1 * tolerance) << name(acf.family());
  }
}

TEST(GaussianMixture, RefusesALadderOutOfRange) {
  const std::vector<CorrelationPair> samples = {{0, 1}, {1, 0.5}};
  for (const auto& [low, high, ratio] :
       {std::tuple{0.0, 1.0, 1.4}, {2.0, 1.0, 1.4}, {1e-300, 1e300, 1.00001}, {1.0, 2.0, 1.0}})
    EXPECT_THROW(detail::fit_gaussian_mixture(
                     samples, {.smallest_scale = low, .largest_scale = high, .ratio = ratio}),
                 InputError);
}

TEST(MonotoneCubic, MeetsThePairsAndDoesNotOvershoot) {
  const std::vector<double> x = {0, 1, 1.5, 4, 4.1, 7}, y = {1, 0.9, 0.2, 0.2, -0.3, 0};
  const detail::MonotoneCubic cubic(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_DOUBLE_EQ(cubic(x[i]), y[i]);
  double integral = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const int n = 1000;
    double before = y[i];
    for (int k = 1; k <= n; ++k) {
      const double value = cubic(x[i] + (x[i + 1] - x[i]) * k / n);
      EXPECT_GE((value - before) * (y[i + 1] - y[i]), -1e-15) << x[i];
      EXPECT_TRUE(y[i] != y[i + 1] || std::abs(value - y[i]) < 1e-15);
      integral += (before + value) / 2 * (x[i + 1] - x[i]) / n;
      before = value;
    }
  }
  EXPECT_NEAR(cubic.integral(), integral, 1e-6);  // trapezoids: h^2 / 12 of the slopes' change
}

// A cubic Hermite interpolant with slopes of second order is of third order at smooth data.
TEST(MonotoneCubic, ConvergesForSmoothData) {
  const auto error = [](int n) {
    std::vector<double> x, y;
    for (int i = 0; i <= n; ++i) {
      x.push_back(2.0 * i / n);
      y.push_back(std::exp(-x.back()));
    }
    const detail::MonotoneCubic cubic(x, y);
    double largest = 0;
    for (double t = 0.5; t < 1.5; t += 0.01)
      largest = std::max(largest, std::abs(cubic(t) - std::exp(-t)));
    return largest;
  };
  EXPECT_LT(error(40), error(20) / 6);
}

// Pairs of a mixture whose scales stand on no rung of the ladder. Neighbours on it are at most h =
// ln 2 / 8 apart in the logarithm of the scale; linear interpolation between them leaves h^2 / 8
// times the second derivative of a Gaussian by that logarithm, which is 1.24 at most: 1.2e-3.
TEST(Table, ThatAMixtureMeetsIsThatMixture) {
  const auto rho = [](double r) {
    return 0.7 * std::exp(-r * r / 2) + 0.3 * std::exp(-r * r / 18);
  };
  const Autocorrelation acf = table(pairs_of(rho, 0.25, 60));
  ASSERT_TRUE(acf.fit_residual());
  EXPECT_LT(*acf.fit_residual(), 1.2e-3);
  ASSERT_FALSE(acf.gaussian_terms().empty());
  EXPECT_DOUBLE_EQ(acf.rho(0), 1);
  for (double r = 0; r < 20; r += 0.1) {
    double sum = 0;
    for (const GaussianTerm& term : acf.gaussian_terms())
      sum += term.weight * std::exp(-r * r / (2 * term.scale * term.scale));
    EXPECT_NEAR(acf.rho(r), sum, 1e-15);
    EXPECT_NEAR(acf.rho(r), rho(r), 1.2e-3) << r;
  }
  EXPECT_NEAR(*acf.slope_variance(), 0.7 + 0.3 / 9, 0.005);
  EXPECT_EQ(acf.citations().size(), 2u);
}

// Weights that add up to 1 but for rounding leave no trace: of these tables some sums miss 1.
TEST(Table, IsOneAtZeroAndNeverMore) {
  for (int k = 1; k < 100; ++k) {
    const double a = k / 100.0;
    const Autocorrelation acf = table(pairs_of(
        [a](double r) { return a * std::exp(-r) + (1 - a) * std::exp(-r * r); }, 0.25, 30));
    EXPECT_EQ(acf.rho(0), 1) << a;
    EXPECT_LE(acf.rho(1e-12), 1) << a;
  }
}

TEST(Table, ThatNoMixtureMeetsIsInterpolated) {
  const auto pairs = pairs_of(oscillation, 0.05, 100);
  const Autocorrelation acf = table(pairs);
  ASSERT_TRUE(acf.fit_residual());
  EXPECT_GT(*acf.fit_residual(), 0.02);
  EXPECT_TRUE(acf.gaussian_terms().empty());
  EXPECT_FALSE(acf.slope_variance());
  for (const auto& [r, rho] : pairs) EXPECT_DOUBLE_EQ(acf.rho(r), rho);
  EXPECT_NEAR(acf.rho(0.525), oscillation(0.525), 1e-3);
  EXPECT_EQ(acf.rho(pairs.back().r * 1.0001), 0);
  EXPECT_EQ(acf.citations().size(), 1u);
}

// rho = 0.2 and 1/e by definition; the integral by quadrature of rho itself.
TEST(Table, HasTheEquivalentLengthsOfItsFunction) {
  const Autocorrelation exponential({.family = Family::exponential, .length = 2.0});
  const std::vector<Autocorrelation> tables = {
      table(pairs_of([&](double r) { return exponential.rho(r); }, 0.25, 80)),
      table(pairs_of(oscillation, 0.05, 100))};
  for (const Autocorrelation& acf : tables) {
    const EquivalentLengths lengths = acf.equivalent_lengths();
    EXPECT_FALSE(lengths.formula);
    EXPECT_NEAR(acf.rho(lengths.one_over_e), std::exp(-1.0), 1e-12);
    EXPECT_NEAR(acf.rho(lengths.sal), 0.2, 1e-12);
    EXPECT_NEAR(acf.length(), lengths.one_over_e / std::numbers::sqrt2, 1e-15);
    double integral = 0;
    for (double r = 0.0005; r < 400; r += 0.001) integral += acf.rho(r) * 0.001;
    EXPECT_NEAR(*lengths.integral, integral, 1e-5);
  }
  EXPECT_NEAR(tables[0].equivalent_lengths().one_over_e, 2, 0.02);
  EXPECT_NEAR(*tables[0].equivalent_lengths().integral, 2, 0.05);
}

// An exponential's share in the plane is (1 + q^2 l^2)^(-1/2), on a line 1 - (2/pi) atan(q l). The
// fit lies within 1e-3 of rho; the interpolant is that of a table with a bump no mixture follows,
// whose share is known only to its size.
TEST(Table, HasTheSpectrumOfItsFunction) {
  const Autocorrelation exponential({.family = Family::exponential, .length = 1.0});
  const Autocorrelation fit =
      table(pairs_of([&](double r) { return exponential.rho(r); }, 0.1, 100));
  for (const double q : {0.1, 0.5, 1.0, 3.0})
    for (const int dimension : {1, 2})
      EXPECT_NEAR(fit.spectrum_share_above(q, dimension),
                  exponential.spectrum_share_above(q, dimension), 0.02)
          << q;
  // exp(-r) cos(4 r) is the mean of exponentials of length 1 / (1 + 4i) and 1 / (1 - 4i), and so
  // is its share on a line: 1 - (atan(q + 4) + atan(q - 4)) / pi.
  const Autocorrelation interpolant = table(pairs_of(oscillation, 0.02, 700));
  ASSERT_TRUE(interpolant.gaussian_terms().empty());
  for (const double q : {0.5, 3.0, 4.0, 6.0, 40.0})
    EXPECT_NEAR(interpolant.spectrum_share_above(q, 1),
                1 - (std::atan(q + 4) + std::atan(q - 4)) / std::numbers::pi, 2e-3)
        << q;
  EXPECT_NEAR(interpolant.spectrum_share_above(1e6, 2), 1e-6, 2e-7);
  for (const int dimension : {1, 2}) EXPECT_EQ(interpolant.spectrum_share_above(0, dimension), 1);
}

TEST(Table, ScalesWithTheLengthUnit) {
  auto pairs = pairs_of([](double r) { return std::exp(-r); }, 0.2, 50);
  const Autocorrelation small = table(pairs);
  for (CorrelationPair& pair : pairs) pair.r *= 1e9;
  const Autocorrelation large = table(pairs);
  for (double r = 0; r < 10; r += 0.37) EXPECT_NEAR(small.rho(r), large.rho(1e9 * r), 1e-9);
}

TEST(Table, RefusesWhatIsNoAutocorrelation) {
  const auto message = [](std::vector<CorrelationPair> pairs) {
    return test::message_of([&] { table(pairs); });
  };
  EXPECT_NE(message({}).find("needs --table"), std::string::npos);
  EXPECT_NE(message({{0, 1}, {1, 0}}).find("2 pairs"), std::string::npos);
  EXPECT_NE(message({{0, 1}, {1, 0.5}, {1, 0}}).find("pair 3: r = 1 after 1"), std::string::npos);
  EXPECT_NE(message({{-1, 1}, {1, 0.5}, {2, 0}}).find("r = -1"), std::string::npos);
  EXPECT_NE(message({{0, 0.9}, {1, 0.5}, {2, 0}}).find("rho(0) = 0.9"), std::string::npos);
  EXPECT_NE(message({{0, 1}, {1, -1.5}, {2, 0}}).find("rho = -1.5"), std::string::npos);
  EXPECT_NE(message({{0, 1}, {1, std::nan("")}, {2, 0}}).find("finite"), std::string::npos);
  EXPECT_NE(message({{0, 1}, {1, 0.5}, {2, 0.3}}).find("not decayed"), std::string::npos);
  EXPECT_EQ(message({{1, 0.5}, {2, 0.2}, {3, 0.05}}), "no error");
  EXPECT_NE(test::message_of([] {
              Autocorrelation(
                  {.family = Family::table, .length = 1.0, .table = {{0, 1}, {1, 0.5}, {2, 0}}});
            }).find("--length"),
            std::string::npos);
  EXPECT_NE(test::message_of([] {
              Autocorrelation({.length = 1.0, .table = {{0, 1}, {1, 0.5}, {2, 0}}});
            }).find("--table is given"),
            std::string::npos);
}

class TableFile : public testing::Test {
 protected:
  std::vector<CorrelationPair> read(const std::string& text) {
    test::write_bytes(folder_ / "rho.txt", text);
    return read_correlation_table(folder_ / "rho.txt");
  }
  std::string message(const std::string& text) {
    try {
      read(text);
    } catch (const FormatError& error) {
      return error.what();
    }
    return "no FormatError";
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(TableFile, IsReadWhateverSeparatesItsNumbers) {
  const std::string text =
      "# r, rho\r\n\r\n0 1\r\n 0.5,\t0.25 # a remark\r\n+1e0;0.125\r\n  #2 7\n3 , -1e-3";
  const auto pairs = read(text);
  ASSERT_EQ(pairs.size(), 4u);
  EXPECT_EQ(pairs[1].r, 0.5);
  EXPECT_EQ(pairs[1].rho, 0.25);
  EXPECT_EQ(pairs[2].r, 1);
  EXPECT_EQ(pairs[3].rho, -1e-3);
}

TEST_F(TableFile, IsRefusedWithTheLineAndTheValue) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"0 1\n1 0.5\n1 0.4\n", "rho.txt:3: table of r and rho: r = 1 after 1"},
      {"# x\n-1 1\n1 0.5\n2 0.4\n", "rho.txt:2: table of r and rho: r = -1"},
      {"0 0.5\n1 0.5\n2 0.4\n", "rho.txt:1: table of r and rho: rho(0) = 0.5"},
      {"0 1\n1 1.5\n2 0.4\n", "rho.txt:2: table of r and rho: rho = 1.5"},
      {"0 1\n1 nan\n2 0.4\n", "rho.txt:2"},
      {"0 1\n1\n2 0.4\n", "rho.txt:2: table of r and rho: two numbers are needed"},
      {"0 1\n1 0.5 3\n2 0.4\n", "\"3\" after two numbers"},
      {"0 1\n1 abc\n2 0.4\n", "\"abc\" is not a number"},
      {"0 1\n1 0.5x\n2 0.4\n", "\"0.5x\" is not a number"},
      {"0 1\n1 0.5\n", "2 pairs of r and rho; at least 3"},
      {"", "0 pairs"},
      {std::string("0 1\n1 \0 0.5\n2 0", 15), "is not a number"}};
  for (const auto& [text, expected] : cases)
    EXPECT_NE(message(text).find(expected), std::string::npos) << message(text);
  EXPECT_THROW(read_correlation_table("/nonexistent/rho.txt"), InputError);
}

// A fit takes at most 2,000 of the pairs, so that a file of a million costs no more than to read
// it.
TEST(Table, BearsManyPairs) {
  const Autocorrelation acf = table(pairs_of([](double r) { return std::exp(-r); }, 1e-4, 200'000));
  EXPECT_LT(*acf.fit_residual(), 0.02);
}

}  // namespace
}  // namespace roughmesh
