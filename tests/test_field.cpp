// SPDX-License-Identifier: BSD-3-Clause
// The promises of FieldSampler: covariance, seeds, threads, scaling, errors.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/field.hpp"
#include "roughmesh/white_noise.hpp"

#include "parallel.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh {
namespace {

/// The method of Loth et al. (2020), which this file is about.
const FieldOptions by_cholesky{.method = Method::cholesky};

using test::largest_difference;

const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.4});
const Autocorrelation exponential({.family = Family::exponential, .length = 0.4});

std::vector<Vec3> sphere_points(int subdivisions) {
  return test::sorted(test::icosphere(subdivisions).nodes);
}

/// n points of a unit sphere, spread by the golden angle.
std::vector<Vec3> spiral_points(int n) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, angle = 2 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return test::sorted(std::move(points));
}

std::string message_of(const auto& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

// Isserlis: Var[d_i d_j] = 1 + rho_ij^2, so the sample covariance of n realizations has the
// standard error sqrt((1 + rho^2) / n). Six of them: p < 2e-9 for each of 20,100 pairs.
void expect_sample_covariance(const Autocorrelation& autocorrelation, const Distance& distance,
                              const std::vector<Vec3>& points, Factorization factorization) {
  constexpr std::uint64_t n_realizations = 4000;
  const FieldSampler sampler(Correlation(points, autocorrelation, distance), by_cholesky);
  ASSERT_EQ(sampler.summary().cholesky->factorization, factorization);
  const auto n = static_cast<int>(points.size());
  Eigen::MatrixXd heights(n, static_cast<int>(n_realizations));
  for (std::uint64_t realization = 0; realization < n_realizations; ++realization) {
    const std::vector<double> d = sampler.heights(2020, realization);
    heights.col(static_cast<int>(realization)) = Eigen::Map<const Eigen::VectorXd>(d.data(), n);
  }
  const Eigen::MatrixXd covariance =
      heights * heights.transpose() / static_cast<double>(n_realizations);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      const double rho = autocorrelation.rho(distance(points[i], points[j]));
      const double error = std::sqrt((1 + rho * rho) / static_cast<double>(n_realizations));
      ASSERT_NEAR(covariance(i, j), rho, 6 * error) << i << ", " << j;
    }
}

TEST(FieldSampler, SampleCovarianceIsTheAutocorrelation) {
  const std::vector<Vec3> points = spiral_points(200);
  expect_sample_covariance(exponential, Distance::euclidean(), points, Factorization::cholesky);
  expect_sample_covariance(exponential, Distance::great_circle(points), points,
                           Factorization::cholesky);
  const Autocorrelation smooth({.family = Family::gaussian, .length = 0.8});
  expect_sample_covariance(smooth, Distance::euclidean(), points, Factorization::pivoted_cholesky);
}

// Displaced along the exact radial normals, triangle t of a sphere of radius r about the origin
// makes a cone of volume V_t prod_k (1 + Rq d_k / r); with E[d_i d_j] = rho_ij and no third moment
// the mean is V_t (1 + (Rq / r)^2 (rho_ij + rho_jk + rho_ki)). The linear part, whose mean is known
// to be 0, is taken off each sample, which makes the sampling error ten times smaller.
TEST(FieldSampler, MeanVolumeOfARoughSphereIsTheExactOne) {
  const double radius = 2, rq = 0.1;
  Mesh mesh = test::icosphere(2, radius);
  const Autocorrelation autocorrelation({.family = Family::gaussian, .length = 0.8});
  const FieldSampler sampler(Correlation(mesh.nodes, autocorrelation, Distance::euclidean()),
                             by_cholesky);
  const ElementBlock& triangles = mesh.blocks.front();
  const auto cone = [&](Index t) {
    const auto node = triangles.element(t);
    return mesh.nodes[node[0]].dot(mesh.nodes[node[1]].cross(mesh.nodes[node[2]])) / 6;
  };

  double expected = 0;
  for (Index t = 0; t < triangles.size(); ++t) {
    const auto node = triangles.element(t);
    for (int k = 0; k < 3; ++k)
      expected += cone(t) * (rq * rq / (radius * radius)) *
                  autocorrelation.rho((mesh.nodes[node[k]] - mesh.nodes[node[(k + 1) % 3]]).norm());
  }

  constexpr int n_realizations = 4000;
  double sum = 0, sum_of_squares = 0;
  for (int realization = 0; realization < n_realizations; ++realization) {
    const std::vector<double> d = sampler.heights(5, static_cast<std::uint64_t>(realization));
    double growth = 0;
    for (Index t = 0; t < triangles.size(); ++t) {
      double product = 1, linear = 1;
      for (const Index node : triangles.element(t)) {
        product *= 1 + rq * d[node] / radius;
        linear += rq * d[node] / radius;
      }
      growth += cone(t) * (product - linear);
    }
    sum += growth;
    sum_of_squares += growth * growth;
  }
  const double mean = sum / n_realizations;
  const double variance = sum_of_squares / n_realizations - mean * mean;
  const double standard_error = std::sqrt(variance / n_realizations);
  EXPECT_NEAR(mean, expected, 5 * standard_error);  // p < 6e-7
  EXPECT_LT(standard_error, 0.02 * expected);       // so that 10 % would be seen
}

TEST(FieldSampler, RealizationIsTheSameAloneAndAmongOthers) {
  const std::vector<Vec3> points = sphere_points(3);
  for (const Autocorrelation& autocorrelation : {gaussian, exponential}) {
    const FieldSampler among(Correlation(points, autocorrelation, Distance::euclidean()),
                             by_cholesky);
    std::vector<std::vector<double>> ten;
    for (std::uint64_t realization = 0; realization < 10; ++realization)
      ten.push_back(among.heights(1, realization));
    const FieldSampler alone(Correlation(points, autocorrelation, Distance::euclidean()),
                             by_cholesky);
    EXPECT_LT(largest_difference(alone.heights(1, 7), ten[7]), 1e-8);
    EXPECT_EQ(among.heights(1, 7), ten[7]);
    EXPECT_GT(largest_difference(ten[6], ten[7]), 0.1);
    EXPECT_GT(largest_difference(among.heights(2, 7), ten[7]), 0.1);
  }
}

// The factor may differ in its last bits between numbers of threads, which the method keeps below
// 1e-8; the same factor gives the same bits on any number of them.
TEST(FieldSampler, HeightsDoNotDependOnTheNumberOfThreads) {
  const std::vector<Vec3> points = sphere_points(3);
  const Distance great_circle = Distance::great_circle(points);
  const Autocorrelation wide({.family = Family::gaussian, .length = 1.0});  // eigenvalues
  const auto heights = [&](int n_threads, const Autocorrelation& autocorrelation) {
    const detail::ThreadLimit limit(n_threads);
    return FieldSampler(Correlation(points, autocorrelation, great_circle)).heights(3, 1);
  };
  for (const Autocorrelation& autocorrelation : {gaussian, exponential, wide})
    EXPECT_LT(largest_difference(heights(1, autocorrelation), heights(2, autocorrelation)), 1e-8);

  const FieldSampler sampler(Correlation(points, gaussian, great_circle));
  const std::vector<double> on_all = sampler.heights(3, 1);
  const detail::ThreadLimit limit(1);
  EXPECT_EQ(sampler.heights(3, 1), on_all);
}

// 1024 is a power of two, so that not even a bit of R changes.
TEST(FieldSampler, HeightsScaleWithTheLengthUnit) {
  std::vector<Vec3> points = sphere_points(3);
  const FieldSampler small(Correlation(points, gaussian, Distance::euclidean()), by_cholesky);
  for (Vec3& x : points) x *= 1024;
  const Autocorrelation longer({.family = Family::gaussian, .length = 0.4 * 1024});
  const FieldSampler large(Correlation(points, longer, Distance::euclidean()), by_cholesky);
  EXPECT_LT(largest_difference(small.heights(0, 0), large.heights(0, 0)), 1e-8);
}

TEST(FieldSampler, CovarianceIsTheOneThatWasAskedFor) {
  const std::vector<Vec3> points = sphere_points(2);
  const FieldSampler sampler(Correlation(points, gaussian, Distance::euclidean()), by_cholesky);
  EXPECT_NEAR(sampler.covariance(3, 90), gaussian.rho((points[3] - points[90]).norm()), 2e-8);
  EXPECT_EQ(sampler.covariance(3, 90), sampler.covariance(90, 3));
  EXPECT_NEAR(sampler.covariance(5, 5), 1, 2e-8);
  EXPECT_THROW(sampler.covariance(0, 162), InputError);
  EXPECT_THROW(sampler.covariance(-1, 0), InputError);
}

// 1e-8 where pivoting stops; the clipping of eigenvalues is an error against the rho asked for.
TEST(FieldSampler, AuditAndSummaryTellWhatTheFactorizationDid) {
  const std::vector<Vec3> points = sphere_points(3);
  const FieldSampler plain(Correlation(points, exponential, Distance::euclidean()), by_cholesky);
  EXPECT_EQ(plain.summary().cholesky->factorization, Factorization::cholesky);
  EXPECT_EQ(plain.summary().cholesky->rank, 642);
  EXPECT_LT(plain.audit().covariance_error, 1e-12);
  EXPECT_NEAR(plain.summary().cholesky->smallest_correlation, exponential.rho(2), 1e-12);

  const FieldSampler pivoted(Correlation(points, gaussian, Distance::euclidean()), by_cholesky);
  EXPECT_EQ(pivoted.summary().cholesky->factorization, Factorization::pivoted_cholesky);
  EXPECT_LT(pivoted.summary().cholesky->rank, 642);
  EXPECT_LT(pivoted.audit().covariance_error, 2e-8);
  EXPECT_GT(pivoted.citations().size(), plain.citations().size());

  const Autocorrelation wide({.family = Family::gaussian, .length = 1.0});
  const FieldSampler clipped(Correlation(points, wide, Distance::great_circle(points)));
  EXPECT_EQ(clipped.summary().cholesky->factorization, Factorization::eigenvalue);
  EXPECT_GE(clipped.audit().covariance_error, clipped.summary().cholesky->variance_change - 1e-12);
  EXPECT_LE(clipped.audit().covariance_error,
            -*clipped.summary().cholesky->smallest_eigenvalue + 1e-9);
}

TEST(FieldSampler, OneAndTwoPoints) {
  const std::vector<Vec3> one = {{1, 2, 3}};
  const FieldSampler single(Correlation(one, gaussian, Distance::euclidean()), by_cholesky);
  EXPECT_EQ(single.heights(4, 5), white_noise_sequence({4, 5}, 1));
  EXPECT_EQ(single.audit().n_pairs, 0);
  EXPECT_EQ(single.audit().covariance_error, 0);
  EXPECT_EQ(single.summary().cholesky->smallest_correlation, 1);

  // d_0 = w_0, d_1 = rho w_0 + sqrt(1 - rho^2) w_1
  const std::vector<Vec3> two = {{0, 0, 0}, {0.4, 0, 0}};
  const FieldSampler pair(Correlation(two, exponential, Distance::euclidean()), by_cholesky);
  const double rho = std::exp(-1.0), w0 = white_noise({4, 5}, 0), w1 = white_noise({4, 5}, 1);
  EXPECT_NEAR(pair.heights(4, 5)[0], w0, 1e-14);
  EXPECT_NEAR(pair.heights(4, 5)[1], rho * w0 + std::sqrt(1 - rho * rho) * w1, 1e-14);
  EXPECT_EQ(pair.audit().n_pairs, 1);
}

// Infinite length along y: heights along y are equal, to the 1e-10 that separates ties, whose
// square root is 1e-5, of which nothing remains above the 1e-8 where pivoting stops.
TEST(FieldSampler, InfiniteLengthMakesStreaks) {
  const int divisions = 15;
  const std::vector<Vec3> points = test::sorted(test::plate(divisions).nodes);
  const double inf = std::numeric_limits<double>::infinity();
  const Distance streaks = Distance::stretched({.lengths = {0.1, inf, 1.0}});
  const Autocorrelation autocorrelation({.family = Family::exponential, .length = 0.1});
  const FieldSampler sampler(Correlation(points, autocorrelation, streaks), by_cholesky);
  EXPECT_EQ(sampler.summary().cholesky->rank, divisions + 1);
  const std::vector<double> d = sampler.heights(0, 0);
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i][0] == points[i - 1][0]) {
      EXPECT_NEAR(d[i], d[i - 1], 1e-8);
    }
  EXPECT_LT(sampler.audit().covariance_error, 2e-8);
}

TEST(FieldSampler, RefusesMemoryThatIsNotThereBeforeItTakesAny) {
  const Correlation correlation(std::vector<Vec3>(3'000'000, Vec3::Zero()), gaussian,
                                Distance::euclidean());
  const std::string message = message_of([&] { FieldSampler(correlation, by_cholesky); });
  EXPECT_NE(message.find("3000000 points"), std::string::npos) << message;
  EXPECT_NE(message.find("67055.23 GiB"), std::string::npos) << message;  // 9e12 * 8 / 2^30
  EXPECT_NE(message.find("coarser mesh"), std::string::npos) << message;
}

TEST(FieldSampler, RefusesInputOutOfRange) {
  const std::vector<Vec3> points = sphere_points(0);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double tolerance : {0.0, -1e-4, inf, std::nan("")})
    EXPECT_THROW(FieldSampler(Correlation(points, gaussian, Distance::euclidean()),
                              {.tolerance = tolerance}),
                 InputError)
        << tolerance;
  EXPECT_NO_THROW(FieldSampler(Correlation(points, gaussian, Distance::euclidean()),
                               {.method = Method::cholesky, .tolerance = 1e-300}));
  EXPECT_THROW(FieldSampler(Correlation({}, gaussian, Distance::euclidean())), InputError);
  const std::vector<Vec3> not_finite = {{0, 0, 0}, {1, inf, 0}};
  EXPECT_THROW(FieldSampler(Correlation(not_finite, gaussian, Distance::euclidean())), InputError);
}

TEST(FieldNames, AreThoseOfTheCommandLineAndReport) {
  for (const Method method : {Method::automatic, Method::cholesky, Method::lattice})
    EXPECT_EQ(method_from_name(name(method)), method);
  for (const char* unknown : {"", "lattices", "Cholesky", "auto "})
    EXPECT_NE(message_of([&] { method_from_name(unknown); }).find("auto, cholesky or lattice"),
              std::string::npos);
  EXPECT_EQ(name(Factorization::cholesky), "cholesky");
  EXPECT_EQ(name(Factorization::pivoted_cholesky), "pivoted-cholesky");
  EXPECT_EQ(name(Factorization::eigenvalue), "eigenvalue");
}

}  // namespace
}  // namespace roughmesh
