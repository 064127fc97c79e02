// SPDX-License-Identifier: BSD-3-Clause
// What a cutoff leaves of a field of the method `lattice`, and what the method refuses.
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "support/errors.hpp"
#include "support/lattice_cases.hpp"

namespace roughmesh {
namespace {

using test::lattice_sampler;
using test::message_of;

const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.4});
const Autocorrelation exponential({.family = Family::exponential, .length = 0.4});

/// Of the Gaussians of a summary.
double sum_of_terms(const LatticeSummary& lattice, double r) {
  double sum = 0;
  for (const GaussianTerm& term : lattice.terms)
    sum += term.weight * std::exp(-r * r / (2 * term.scale * term.scale));
  return sum;
}

TEST(LatticeCutoff, LeavesTheGaussiansAboveIt) {
  const std::vector<Vec3> places = test::icosphere(2).nodes;
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4)) {
    SCOPED_TRACE(name);
    const Autocorrelation rho(autocorrelation);
    const FieldSampler sampler =
        lattice_sampler(places, rho, Distance::euclidean(), {.cutoff = 0.13});
    const LatticeSummary& lattice = *sampler.summary().lattice;
    for (const GaussianTerm& term : lattice.terms)
      EXPECT_GE(term.scale, 0.13 / std::numbers::sqrt2);
    EXPECT_NEAR(sum_of_terms(lattice, 0), 1 - lattice.lost_variance, 1e-12);
    EXPECT_EQ(lattice.nugget, 0);
    EXPECT_LE(sampler.audit().covariance_error, 1e-4);
    for (Index j = 0; j < 162; j += 5) {
      const double r = (places[7] - places[static_cast<std::size_t>(j)]).norm();
      EXPECT_NEAR(sampler.target(7, j), sum_of_terms(lattice, r), 1e-12);
      EXPECT_NEAR(sampler.covariance(7, j), sum_of_terms(lattice, r), 1e-4);
    }
    EXPECT_NEAR(sampler.covariance(7, 7), 1 - lattice.lost_variance, 1e-4);
  }
}

// Scales of an exponential are l |w|, w a normal number: P(l |w| < c) is lost. The terms know where
// the variance is to the gap between two of them, at most 4 at the largest tolerance here, and half
// of it on either side.
TEST(LatticeCutoff, LosesWhatIsBelowIt) {
  const std::vector<Vec3> places = test::icosphere(2).nodes;
  const auto below = [&](double scale) { return std::erf(scale / 0.4 / std::numbers::sqrt2); };
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    double before = 0;
    for (double cutoff = 0.01; cutoff < 0.8; cutoff *= 1.13) {
      const double lost = lattice_sampler(places, exponential, Distance::euclidean(),
                                          {.tolerance = tolerance, .cutoff = cutoff})
                              .summary()
                              .lattice->lost_variance;
      EXPECT_GE(lost, below(cutoff / 2)) << cutoff;
      EXPECT_LE(lost, below(cutoff * 2)) << cutoff;
      EXPECT_GT(lost, before) << cutoff;
      before = lost;
    }
  }
  const FieldSampler whole =
      lattice_sampler(places, gaussian, Distance::euclidean(), {.cutoff = 0.39});
  EXPECT_EQ(whole.summary().lattice->lost_variance, 0);
}

// What two cutoffs both leave is one field. The longer one keeps b_k <= a_k of each term, so that
// heights have the correlation sum sqrt(a_k b_k) / sqrt(sum a_k sum b_k) >= sqrt(sum b_k / sum
// a_k). Over a sphere of some 40 independent patches its estimate spreads by 0.02.
TEST(LatticeCutoff, OfTwoTheLongerIsPartOfTheShorter) {
  const std::vector<Vec3> places = test::icosphere(4).nodes;
  struct Cut {
    Eigen::ArrayXd heights;
    double left;
  };
  const auto cut = [&](double cutoff) {
    const FieldSampler sampler =
        lattice_sampler(places, exponential, Distance::euclidean(), {.cutoff = cutoff});
    const std::vector<double> z = sampler.heights(3, 1);
    return Cut{Eigen::Map<const Eigen::ArrayXd>(z.data(), static_cast<Eigen::Index>(z.size())),
               1 - sampler.summary().lattice->lost_variance};
  };
  const Cut finest = cut(0.02);
  for (const double cutoff : {0.021, 0.025, 0.03, 0.04, 0.06, 0.1}) {
    const Cut longer = cut(cutoff);
    const double correlation =
        (longer.heights * finest.heights).sum() /
        std::sqrt(longer.heights.square().sum() * finest.heights.square().sum());
    EXPECT_GT(correlation, std::sqrt(longer.left / finest.left) - 0.1) << cutoff;
  }
}

TEST(LatticeCutoff, HoldsForPeriodsPlanesAndStreaks) {
  const std::vector<Vec3> places = test::plate(8).nodes;
  const double inf = std::numeric_limits<double>::infinity();
  for (const Distance& distance :
       {Distance::euclidean(), Distance::periodic({1.3, 0, 0}), Distance::periodic({1.2, 1.1, 0.9}),
        Distance::stretched({.lengths = {0.4, inf, 1.0}})}) {
    const FieldSampler sampler =
        lattice_sampler(places, exponential, distance, {.cutoff = 0.2, .dimension = 2});
    EXPECT_LE(sampler.audit().covariance_error, 1e-4);
    EXPECT_NEAR(sampler.covariance(5, 5), 1 - sampler.summary().lattice->lost_variance, 1e-4);
  }
}

std::string refusal(const Autocorrelation& rho, const Distance& distance,
                    const FieldOptions& options) {
  const std::vector<Vec3> places = test::icosphere(1).nodes;
  return message_of([&] { FieldSampler(Correlation(places, rho, distance), options); });
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  EXPECT_EQ(message.find_first_of("\r\n"), std::string::npos) << message;
  EXPECT_LT(message.size(), 250U) << message;
}

TEST(LatticeCutoff, ThatLeavesNothingIsRefused) {
  const Distance euclidean = Distance::euclidean();
  expect_parts(refusal(gaussian, euclidean, {.cutoff = 0.41}), {"cutoff: 0.41", "smaller"});
  expect_parts(refusal(exponential, euclidean, {.cutoff = 40}), {"cutoff: 40", "smaller"});
}

TEST(LatticeCutoff, IsRefusedByCholesky) {
  const FieldOptions asked{.method = Method::cholesky, .cutoff = 0.1};
  expect_parts(refusal(exponential, Distance::euclidean(), asked), {"cutoff 0.1", "lattice"});
  const Distance sphere = Distance::great_circle({Vec3::Zero(), 1.0, 0.0});
  expect_parts(refusal(exponential, sphere, {.cutoff = 0.1}), {"cutoff 0.1", "lattice"});
}

TEST(LatticeCutoff, OutOfRangeIsRefused) {
  for (const double cutoff : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    expect_parts(refusal(exponential, Distance::euclidean(), {.cutoff = cutoff}),
                 {"cutoff", "out of range", "above 0"});
}

TEST(LatticeRefusal, OfDistancesThatAreNoneOfSpace) {
  const Distance great_circle = Distance::great_circle({Vec3::Zero(), 1.0, 0.0});
  const Distance minimum_image = Distance::minimum_image({3, 3, 3});
  for (const auto& [distance, name] :
       {std::pair{great_circle, "great-circle"}, std::pair{minimum_image, "minimum-image"}}) {
    expect_parts(refusal(exponential, distance, {.method = Method::lattice}),
                 {name, "cholesky", "euclidean"});
    const Correlation correlation(test::icosphere(1).nodes, exponential, distance);
    EXPECT_EQ(FieldSampler(correlation).summary().method, Method::cholesky) << name;
  }
  const Correlation curve({{0, 0, 0}, {0.1, 0, 0}}, exponential, Distance::curve({5}));
  expect_parts(message_of([&] { FieldSampler(curve, {.method = Method::lattice}); }),
               {"curve", "cholesky"});
  EXPECT_EQ(FieldSampler(curve).summary().method, Method::cholesky);
}

// The autocorrelation of a wave is no mixture of Gaussians, which are all positive.
TEST(LatticeRefusal, OfATableThatNoMixtureMeets) {
  std::vector<CorrelationPair> wave;
  for (int k = 0; k <= 60; ++k)
    wave.push_back({0.1 * k, std::cos(2.0 * k / 10) * std::exp(-0.1 * k)});
  const Autocorrelation table({.family = Family::table, .table = wave});
  expect_parts(refusal(table, Distance::euclidean(), {.method = Method::lattice}),
               {"table", "mixture of Gaussians", "cholesky"});
}

// Also where the method was not asked for: another one would give other heights.
TEST(LatticeRefusal, OfATooSmallTolerance) {
  for (const Method method : {Method::lattice, Method::automatic})
    for (const double tolerance : {1e-12, 9.9e-9, 1e-300})
      expect_parts(
          refusal(gaussian, Distance::euclidean(), {.method = method, .tolerance = tolerance}),
          {"tolerance", "1e-08", "cholesky"});
  EXPECT_EQ(
      refusal(gaussian, Distance::euclidean(), {.method = Method::lattice, .tolerance = 1e-8}),
      "no error");
}

TEST(LatticeRefusal, OfDimensionsThatAreNone) {
  const std::vector<Vec3> sphere = test::icosphere(1).nodes;
  for (const int dimension : {-1, 0, 1, 4})
    expect_parts(message_of([&] {
                   lattice_sampler(sphere, gaussian, Distance::euclidean(),
                                   {.dimension = dimension});
                 }),
                 {"dimension", "2 or 3"});
  expect_parts(message_of([&] {
                 lattice_sampler(sphere, gaussian, Distance::euclidean(), {.dimension = 2});
               }),
               {"dimension 2", "z = ", "plane"});
}

// Doubles at 1e18 lengths are 128 lengths apart.
TEST(LatticeRefusal, OfPlacesTooFarFromTheOrigin) {
  for (const Autocorrelation& rho : {gaussian, exponential})
    for (const double far : {1e18, 1e14, 1e300}) {
      const std::vector<Vec3> places = test::moved(test::icosphere(1).nodes, {0, -far * 0.4, 0});
      expect_parts(message_of([&] { lattice_sampler(places, rho, Distance::euclidean()); }),
                   {"from the origin", "--length", "move the mesh"});
    }
}

// What is not refused keeps its tolerance, as far from the origin as that is.
TEST(LatticeRefusal, ComesBeforeTheToleranceIsLost) {
  for (const Autocorrelation& rho : {gaussian, exponential})
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      for (double far = 1e3; far < 1e20; far *= 10) {
        const std::vector<Vec3> places =
            test::moved(test::icosphere(1).nodes, 0.4 * far * Vec3(1, -1, 1));
        const auto sample = [&] {
          const FieldSampler sampler =
              lattice_sampler(places, rho, Distance::euclidean(), {.tolerance = tolerance});
          EXPECT_LE(sampler.audit().covariance_error, tolerance) << far;
          for (const double height : sampler.heights(0, 0)) EXPECT_LT(std::abs(height), 7);
        };
        const std::string message = message_of(sample);
        if (message != "no error") expect_parts(message, {"from the origin"});
        if (far * 1e-14 > tolerance) {
          EXPECT_NE(message, "no error") << far;
        } else if (far * 1e-12 < tolerance) {
          EXPECT_EQ(message, "no error") << far;
        }
      }
}

}  // namespace
}  // namespace roughmesh
