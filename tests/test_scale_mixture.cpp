// SPDX-License-Identifier: BSD-3-Clause
// Gaussian mixtures of every family against rho, sums over images and the laws they come from.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/correlation.hpp"

#include "scale_mixture.hpp"
#include "support/errors.hpp"

namespace roughmesh::detail {
namespace {

constexpr double l = 3;  // correlation length

AutocorrelationOptions of(Family family) { return {.family = family, .length = l}; }
AutocorrelationOptions matern(double nu) {
  return {.family = Family::matern, .length = l, .nu = nu};
}
AutocorrelationOptions self_affine(double hurst) {
  return {.family = Family::self_affine, .length = l, .hurst = hurst};
}
AutocorrelationOptions stretched(double power) {
  return {.family = Family::stretched, .length = l, .power = power};
}
AutocorrelationOptions rational_quadratic(double alpha) {
  return {.family = Family::rational_quadratic, .length = l, .alpha = alpha};
}
// Two Gaussians, at scales that the fit of a table finds to some per cent.
AutocorrelationOptions table() {
  AutocorrelationOptions options{.family = Family::table};
  for (int i = 0; i <= 120; ++i) {
    const double r = 0.1 * i;
    options.table.push_back(
        {r, 0.6 * std::exp(-r * r / 2 / 4) + 0.4 * std::exp(-r * r / 2 / 0.16)});
  }
  return options;
}

std::vector<AutocorrelationOptions> every_family() {
  return {of(Family::gaussian),
          of(Family::exponential),
          stretched(0.5),
          stretched(1.4),
          stretched(1.9),
          stretched(1.98),
          stretched(1.995),
          stretched(2),
          matern(0.3),
          matern(0.8),
          matern(2.5),
          matern(20),
          matern(1000),
          matern(1e6),
          self_affine(0.2),
          self_affine(0.8),
          rational_quadratic(0.05),
          rational_quadratic(0.4),
          rational_quadratic(5),
          rational_quadratic(1000),
          rational_quadratic(1e6),
          table()};
}

double value(const ScaleMixture& mixture, double r) {
  return mixture_value(mixture, MixtureSpace(Distance::euclidean()), Vec3(0, r, 0));
}

void expect_shares(const ScaleMixture& mixture, const ScaleMixtureOptions& options) {
  double up = mixture.nugget, down = 0;
  for (std::size_t k = 0; k < mixture.terms.size(); ++k) {
    EXPECT_GT(mixture.terms[k].weight, 0) << k;
    EXPECT_GE(mixture.terms[k].scale, options.smallest_scale * (1 - 1e-14)) << k;
    if (k > 0) {
      EXPECT_GT(mixture.terms[k].scale, mixture.terms[k - 1].scale) << k;
      EXPECT_GT(mixture.terms[k].level, mixture.terms[k - 1].level) << k;
    }
    up += mixture.terms[k].weight;
    down += mixture.terms[mixture.terms.size() - 1 - k].weight;
  }
  EXPECT_EQ(up, 1);  // exactly, in whatever order
  EXPECT_EQ(down + mixture.nugget, 1);
  EXPECT_GE(mixture.nugget, 0);
  EXPECT_LE(mixture.residual, options.tolerance);
}

// The difference of two mixtures of Gaussians, as a function of log r, has half waves no shorter
// than a quarter of an octave, and so at least 9 samples of the grid of 36 an octave behind
// `residual`: it exceeds the largest of them by at most 1 - cos(pi / 18) = 1.5 %. Near the shortest
// distance, x = sqrt(2 ln(1 / tolerance)) times the smallest scale, a Gaussian falls off like
// exp(-x^2 log r); there the grid has 144 an octave, and x^2 <= 33 makes 7 samples to a factor of
// e.
void expect_residual(const ScaleMixture& mixture, const Autocorrelation& acf,
                     const ScaleMixtureOptions& options) {
  double largest = 0, place = 0;
  for (double r = shortest_distance(options); r < 1e12 * l; r *= std::exp2(1 / 97.3)) {
    const double difference = std::abs(value(mixture, r) - acf.rho(r));
    if (difference > largest) place = r;
    largest = std::max(largest, difference);
  }
  EXPECT_LE(largest, 1.02 * mixture.residual + 1e-13) << "at " << place;
  EXPECT_LE(largest, options.tolerance) << "at " << place;
  EXPECT_EQ(value(mixture, 0), 1);
}

void expect_ladder(const ScaleMixture& mixture) {
  if (mixture.ratio == 1) return;  // exact
  for (const MixtureTerm& term : mixture.terms)
    EXPECT_NEAR(term.scale / (l * std::pow(mixture.ratio, term.level)), 1, 1e-13);
}

class EveryFamily : public testing::TestWithParam<AutocorrelationOptions> {};

TEST_P(EveryFamily, IsMetAtEveryDistanceThatCounts) {
  const Autocorrelation acf(GetParam());
  for (const double smallest : {1e-5, 0.01, 1.0 / 12, 0.5, 4.0})
    for (const double tolerance : {2.5e-3, 2.5e-5, 1e-7}) {
      SCOPED_TRACE(std::to_string(tolerance) + " from " + std::to_string(smallest));
      const ScaleMixtureOptions options{.tolerance = tolerance, .smallest_scale = smallest * l};
      const ScaleMixture mixture = fit_scale_mixture(acf, Distance::euclidean(), options);
      expect_shares(mixture, options);
      expect_residual(mixture, acf, options);
      expect_ladder(mixture);
    }
}

INSTANTIATE_TEST_SUITE_P(ScaleMixture, EveryFamily, testing::ValuesIn(every_family()),
                         [](const auto& each) {
                           std::string family(name(each.param.family));
                           std::erase(family, '-');
                           return family + std::to_string(each.index);
                         });

// L^2 / l^2 of an exponential is chi-square with one degree of freedom. Sums of weights up to a
// term lie between the law at this term and at the next, as those of a Gauss quadrature do, up to a
// step of the ladder.
TEST(ScaleMixture, OfAnExponentialFollowsTheLawOfItsScales) {
  for (const double tolerance : {1e-4, 1e-6}) {
    const ScaleMixtureOptions options{.tolerance = tolerance, .smallest_scale = 0.05 * l};
    const ScaleMixture mixture =
        fit_scale_mixture(Autocorrelation(of(Family::exponential)), Distance::euclidean(), options);
    const auto law = [](double scale) { return std::erf(scale / l / std::numbers::sqrt2); };
    double sum = mixture.nugget;
    for (std::size_t k = 0; k < mixture.terms.size(); ++k) {
      EXPECT_LE(sum, law(mixture.terms[k].scale * mixture.ratio)) << k;
      sum += mixture.terms[k].weight;
      EXPECT_GE(sum, law(mixture.terms[k].scale / mixture.ratio)) << k;
    }
    EXPECT_LE(mixture.terms.size(), 15u);  // a full ladder of ratio sqrt 2 takes 15 to meet 1e-6
  }
}

TEST(ScaleMixture, CountsDistancesThatNoSmallerScaleReaches) {
  const ScaleMixtureOptions options{.tolerance = 1e-5, .smallest_scale = 0.3};
  const double x = shortest_distance(options) / options.smallest_scale;
  EXPECT_NEAR(std::exp(-x * x / 2), options.tolerance, 1e-18);
}

TEST(ScaleMixture, OfAGaussianIsItself) {
  const ScaleMixtureOptions options{.tolerance = 1e-4, .smallest_scale = 0.1};
  const auto expect_one = [&](const AutocorrelationOptions& acf, double scale) {
    const ScaleMixture mixture =
        fit_scale_mixture(Autocorrelation(acf), Distance::euclidean(), options);
    ASSERT_EQ(mixture.terms.size(), 1u);
    EXPECT_EQ(mixture.terms[0].level, 0);
    EXPECT_DOUBLE_EQ(mixture.terms[0].scale, scale);
    EXPECT_EQ(mixture.terms[0].weight, 1);
    EXPECT_EQ(mixture.nugget, 0);
    EXPECT_EQ(mixture.residual, 0);
  };
  expect_one(of(Family::gaussian), l);
  expect_one(stretched(2), l / std::numbers::sqrt2);
}

TEST(ScaleMixture, OfATableKeepsItsTerms) {
  const Autocorrelation acf(table());
  const auto terms = acf.gaussian_terms();
  ASSERT_GE(terms.size(), 2u);
  for (const double smallest : {0.001, 0.9}) {
    const ScaleMixtureOptions options{.tolerance = 1e-3, .smallest_scale = smallest};
    const ScaleMixture mixture = fit_scale_mixture(acf, Distance::euclidean(), options);
    double lost = 0;
    std::size_t next = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      if (terms[k].scale < smallest) {
        lost += terms[k].weight;
        continue;
      }
      EXPECT_EQ(mixture.terms[next].level, static_cast<int>(k));
      EXPECT_EQ(mixture.terms[next].scale, terms[k].scale);
      EXPECT_NEAR(mixture.terms[next++].weight, terms[k].weight, 1e-13);
    }
    EXPECT_EQ(next, mixture.terms.size());
    EXPECT_NEAR(mixture.nugget, lost, 1e-13);
    EXPECT_EQ(lost > 0.1, smallest > 0.1);  // the second case does lose some
  }
}

// Sums over images, by definition to 1e-12, at places that the fit does not sample.
class ImageComparison {
 public:
  ImageComparison(const AutocorrelationOptions& acf, const Distance& distance, const Vec3& size)
      : distance_(distance), correlation_(places(size), Autocorrelation(acf), distance) {}

  void expect_met(const ScaleMixtureOptions& options) const {
    const ScaleMixture mixture =
        fit_scale_mixture(correlation_.autocorrelation(), distance_, options);
    expect_shares(mixture, options);
    const MixtureSpace space(distance_);
    double largest = 0;
    for (Index i = 0; i < correlation_.n_points(); ++i)
      for (Index j = 0; j < i; ++j) {
        const Vec3 &x = correlation_.places()[i], &y = correlation_.places()[j];
        if (distance_(x, y) < shortest_distance(options)) continue;
        const double difference = mixture_value(mixture, space, x - y) - correlation_(i, j);
        largest = std::max(largest, std::abs(difference));
      }
    EXPECT_LE(largest, 1.06 * mixture.residual + 2e-12);
    EXPECT_LE(largest, options.tolerance);
  }

 private:
  static std::vector<Vec3> places(const Vec3& size) {
    std::vector<Vec3> result;
    std::mt19937_64 engine(7);
    std::uniform_real_distribution<double> uniform;
    result.resize(40);
    for (Vec3& place : result)
      for (int axis = 0; axis < 3; ++axis) place[axis] = size[axis] * uniform(engine);
    return result;
  }

  Distance distance_;
  Correlation correlation_;
};

TEST(ScaleMixture, MeetsSumsOverImages) {
  const std::vector<AutocorrelationOptions> families = {
      of(Family::gaussian), of(Family::exponential), stretched(0.5),
      stretched(1.4),       stretched(1.98),         matern(0.3),
      matern(1000),         rational_quadratic(5),   table()};
  for (const Vec3& period :
       {Vec3(7, 0, 0), Vec3(5, 4, 0), Vec3(5, 4, 6), Vec3(40, 0, 9), Vec3(0.5, 0.6, 0)})
    for (const AutocorrelationOptions& acf : families) {
      SCOPED_TRACE(std::string(name(acf.family)) + " of period " + std::to_string(period.x()));
      const ImageComparison comparison(acf, Distance::periodic(period), Vec3(8, 6, 5));
      for (const double tolerance : {2.5e-3, 2.5e-5, 1e-7})
        comparison.expect_met({.tolerance = tolerance, .smallest_scale = 0.05});
    }
}

TEST(ScaleMixture, MeetsAnisotropicSumsOverImages) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const Anisotropy& anisotropy :
       {Anisotropy{.lengths = {l, 0.5, 2}}, Anisotropy{.lengths = {infinite, l, 1}}})
    for (const AutocorrelationOptions& acf :
         {of(Family::gaussian), of(Family::exponential), rational_quadratic(1.2)})
      ImageComparison(acf, Distance::periodic(Vec3(5, 4, 0), anisotropy), Vec3(8, 6, 5))
          .expect_met({.tolerance = 1e-5, .smallest_scale = 0.1});
}

// A heavy tail on the axis that is left without period falls off like r^(1 - 2a).
TEST(ScaleMixture, MeetsHeavyTailsBesideAPeriod) {
  for (const double alpha : {0.6, 1.0})
    ImageComparison(rational_quadratic(alpha), Distance::periodic(Vec3(5, 0, 0)), Vec3(5, 20, 20))
        .expect_met({.tolerance = 1e-4, .smallest_scale = 0.2});
}

TEST(ScaleMixture, IsAFunctionOfTheStretchedDistance) {
  const Anisotropy anisotropy{
      .lengths = {l, 1, 0.2},
      .axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix()};
  const Distance distance = Distance::stretched(anisotropy);
  const Autocorrelation acf(of(Family::exponential));
  const ScaleMixtureOptions options{.tolerance = 1e-5, .smallest_scale = 0.05};
  const ScaleMixture mixture = fit_scale_mixture(acf, distance, options);
  const MixtureSpace space(distance);
  for (const Vec3& x : {Vec3(1, 0, 0), Vec3(0, 0.2, 0.1), Vec3(-0.4, 2, 0.3)})
    EXPECT_NEAR(mixture_value(mixture, space, x), acf.rho(distance(x, Vec3::Zero())), 1e-5);
}

bool is_same(const ScaleMixture& a, const ScaleMixture& b, double length_ratio) {
  bool result = a.terms.size() == b.terms.size() && a.nugget == b.nugget && a.ratio == b.ratio &&
                a.residual == b.residual;
  for (std::size_t k = 0; result && k < a.terms.size(); ++k)
    result = a.terms[k].level == b.terms[k].level && a.terms[k].weight == b.terms[k].weight &&
             a.terms[k].scale * length_ratio == b.terms[k].scale;
  return result;
}

// Powers of 2 are exact: in a unit 8 times smaller every number is 8 times larger, or the same.
TEST(ScaleMixture, HasTheSameBitsOnEveryCallAndInEveryUnit) {
  for (AutocorrelationOptions acf :
       {of(Family::exponential), stretched(1.4), matern(0.3), rational_quadratic(1.3)})
    for (const Vec3& period : {Vec3(0, 0, 0), Vec3(4, 5, 0)}) {
      const auto fit = [&](double unit) {
        acf.length = l * unit;
        const Distance distance =
            period.isZero() ? Distance::euclidean() : Distance::periodic(period * unit);
        return fit_scale_mixture(Autocorrelation(acf), distance,
                                 {.tolerance = 1e-5, .smallest_scale = 0.1 * unit});
      };
      const ScaleMixture first = fit(1);
      EXPECT_TRUE(is_same(first, fit(1), 1)) << name(acf.family);
      ScaleMixture of_thread;
      std::thread([&] { of_thread = fit(1); }).join();
      EXPECT_TRUE(is_same(first, of_thread, 1)) << name(acf.family);
      EXPECT_TRUE(is_same(first, fit(8), 8)) << name(acf.family);
    }
}

TEST(ScaleMixture, WithoutItsFinestTermsLosesTheirVariance) {
  const ScaleMixtureOptions options{.tolerance = 1e-4, .smallest_scale = 0.1};
  ScaleMixture mixture =
      fit_scale_mixture(Autocorrelation(of(Family::exponential)), Distance::euclidean(), options);
  const double lost = mixture.terms.front().weight + mixture.nugget;
  mixture.terms.erase(mixture.terms.begin());
  mixture.nugget = 0;
  EXPECT_NEAR(value(mixture, 0), 1 - lost, 1e-15);
}

TEST(ScaleMixture, CountsTheNuggetAtWholePeriods) {
  const Distance distance = Distance::periodic(Vec3(2, 0.5, 0));
  const ScaleMixture mixture = fit_scale_mixture(Autocorrelation(of(Family::exponential)), distance,
                                                 {.tolerance = 1e-3, .smallest_scale = 0.1});
  const MixtureSpace space(distance);
  EXPECT_GT(mixture.nugget, 0);
  EXPECT_EQ(mixture_value(mixture, space, Vec3(-4, 1.5, 0)), 1);
  EXPECT_LT(mixture_value(mixture, space, Vec3(-4, 1.5, 1e-9)), 1 - mixture.nugget / 2);
}

void expect_refused(const AutocorrelationOptions& acf, const Distance& distance,
                    const ScaleMixtureOptions& options, const std::vector<std::string>& parts) {
  const std::string message =
      test::message_of([&] { fit_scale_mixture(Autocorrelation(acf), distance, options); });
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << message << " without " << part;
}

TEST(ScaleMixture, RefusesWhatHasNone) {
  const ScaleMixtureOptions options{.tolerance = 1e-4, .smallest_scale = 0.1};
  AutocorrelationOptions oscillation{.family = Family::table};
  for (int i = 0; i <= 60; ++i)
    oscillation.table.push_back({0.1 * i, std::cos(0.2 * i) * std::exp(-0.08 * i)});
  expect_refused(oscillation, Distance::euclidean(), options, {"--table", "--method cholesky"});
  expect_refused(of(Family::gaussian), Distance::great_circle({Vec3::Zero(), 1}), options,
                 {"--distance great-circle", "--method cholesky"});
  expect_refused(of(Family::gaussian), Distance::minimum_image(Vec3(1, 0, 0)), options,
                 {"--distance minimum-image"});
  expect_refused(of(Family::gaussian), Distance::curve({4.0}), options, {"--distance curve"});
  expect_refused(rational_quadratic(0.9), Distance::periodic(Vec3(1, 1, 0)), options,
                 {"--alpha 0.9"});
}

TEST(ScaleMixture, RefusesOptionsOutOfRange) {
  const Distance euclidean = Distance::euclidean();
  for (const double tolerance : {0.0, -1.0, 1.0, std::nan("")})
    expect_refused(of(Family::gaussian), euclidean, {tolerance, 0.1}, {"--tolerance"});
  for (const double smallest : {0.0, -1.0, 1.0 / 0.0, std::nan("")})
    expect_refused(of(Family::gaussian), euclidean, {1e-4, smallest}, {"smallest scale"});
  expect_refused(of(Family::exponential), euclidean, {1e-4, 1e-30}, {"smallest scale", "1e-30"});
}

TEST(ScaleMixture, SaysWhatItReachedWhereThatIsTooLittle) {
  try {
    fit_scale_mixture(Autocorrelation(stretched(1.98)), Distance::euclidean(),
                      {.tolerance = 1e-12, .smallest_scale = 0.1});
    FAIL() << "no error";
  } catch (const NumericalError& error) {
    const std::string message = error.what();
    for (const char* part : {"stretched", "--power 1.98", "1e-12", "--tolerance", "cholesky"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace roughmesh::detail
