// SPDX-License-Identifier: BSD-3-Clause
// The audit looks at pairs of every distance, and sees an error that is there.
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "audit.hpp"
#include "field_cholesky.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"

namespace roughmesh::detail {
namespace {

const Autocorrelation exponential({.family = Family::exponential, .length = 0.3});

std::vector<Vec3> sphere_points(int subdivisions) {
  return test::sorted(test::icosphere(subdivisions).nodes);
}

std::vector<double> distances(const std::vector<PointPair>& pairs, const std::vector<Vec3>& points,
                              const Distance& distance) {
  std::vector<double> result;
  for (const auto& [i, j] : pairs) result.push_back(distance(points[i], points[j]));
  return result;
}

/// Lower triangle of the identity of n points, as the factor of uncorrelated heights.
DenseMatrix identity(std::size_t n) {
  DenseMatrix a(n, n);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = j; i < n; ++i) a(i, j) = i == j ? 1.0 : 0.0;
  return a;
}

std::vector<Index> identity_order(std::size_t n) {
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  return order;
}

TEST(AuditedPairs, AreAllPairsOfAFewPoints) {
  std::vector<Vec3> points;
  for (int i = 0; i < 141; ++i) points.emplace_back(i, 0, 0);  // 141 * 140 / 2 = 9,870
  const auto pairs = audited_pairs(Correlation(points, exponential, Distance::euclidean()));
  EXPECT_EQ(pairs.size(), 9870u);
  EXPECT_EQ(std::set(pairs.begin(), pairs.end()).size(), 9870u);
  for (const auto& [i, j] : pairs) EXPECT_LT(i, j);
  points.resize(1);
  EXPECT_TRUE(audited_pairs(Correlation(points, exponential, Distance::euclidean())).empty());
}

// Half of the 50 strata, in which a pair is sought for each of 196 points, lie between a mesh size
// and the diameter: so thousands of pairs, and some of each octave.
TEST(AuditedPairs, CoverEveryDistanceFromTheShortestUp) {
  const std::vector<Vec3> points = sphere_points(3);
  for (const Distance& distance :
       {Distance::euclidean(), Distance::great_circle(Sphere{Vec3::Zero(), 1.0, 0.0})}) {
    const auto pairs = audited_pairs(Correlation(points, exponential, distance));
    EXPECT_GT(pairs.size(), 3000u);
    EXPECT_LE(pairs.size(), 10'000u);
    double shortest = 10, largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        shortest = std::min(shortest, distance(points[i], points[j]));
        largest = std::max(largest, distance(points[i], points[j]));
      }
    const std::vector<double> r = distances(pairs, points, distance);
    EXPECT_NEAR(*std::min_element(r.begin(), r.end()), shortest, 1e-12);
    EXPECT_GT(*std::max_element(r.begin(), r.end()), 0.95 * largest);
    for (double low = shortest; low < largest; low *= 2)
      EXPECT_GT(std::count_if(r.begin(), r.end(),
                              [&](double x) { return x >= low && x < 2 * low * (1 + 1e-12); }),
                100)
          << low;
    for (const auto& [i, j] : pairs) EXPECT_NE(i, j);
  }
}

// One pair of points a thousandth of the mesh size apart, anywhere in the mesh, is among the pairs.
TEST(AuditedPairs, HoldTheClosestPairOfAGradedMesh) {
  for (const std::size_t near : {0, 1000, 2561}) {
    std::vector<Vec3> points = sphere_points(4);
    points.push_back(points[near] + Vec3(3e-5, 1e-5, 2e-5));
    const auto pairs = audited_pairs(Correlation(points, exponential, Distance::euclidean()));
    const std::vector<double> r = distances(pairs, points, Distance::euclidean());
    EXPECT_LT(*std::min_element(r.begin(), r.end()), 1e-4) << near;
  }
}

TEST(AuditedPairs, AreFewForManyPointsToo) {
  const std::vector<Vec3> points = test::plate(150).nodes;
  EXPECT_LE(audited_pairs(Correlation(points, exponential, Distance::euclidean())).size(), 10'000u);
}

std::vector<Vec3> sphere_of_many_points() {
  constexpr std::size_t n = 100'000;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / n, r = std::sqrt(1 - z * z);
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return test::sorted(points);
}

TEST(AuditedPoints, AreAllOfFewAndSomeOfMany) {
  const Distance distance = Distance::euclidean();
  const std::vector<Vec3> points = sphere_of_many_points();
  EXPECT_EQ(audited_points(std::span(points).first(20'000), distance).size(), 20'000u);
  const std::vector<Index> some = audited_points(points, distance);
  EXPECT_LE(some.size(), 20'000u);
  EXPECT_GT(some.size(), 10'000u);
  EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
  EXPECT_EQ(std::adjacent_find(some.begin(), some.end()), some.end());
}

// As above, although pairs are sought among a fifth of the points: some of each octave from 1.1 of
// the mesh size, about the shortest distance, to the diameter, and from all parts of the sphere.
TEST(AuditedPairs, OfManyPointsCoverEveryDistanceAndPlace) {
  const std::vector<Vec3> points = sphere_of_many_points();
  const auto pairs = audited_pairs(Correlation(points, exponential, Distance::euclidean()));
  EXPECT_GT(pairs.size(), 3000u);
  EXPECT_LE(pairs.size(), 10'000u);
  const std::vector<double> r = distances(pairs, points, Distance::euclidean());
  const double mesh_size = test::mesh_size_of_sphere(points.size(), 1);
  EXPECT_LT(*std::min_element(r.begin(), r.end()), 1.1 * mesh_size);
  EXPECT_GT(*std::max_element(r.begin(), r.end()), 1.95);
  for (double low = mesh_size; low < 2; low *= 2)
    EXPECT_GT(std::count_if(r.begin(), r.end(), [&](double x) { return x >= low && x < 2 * low; }),
              100)
        << low;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 sign(octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1);
    EXPECT_GT(std::count_if(pairs.begin(), pairs.end(),
                            [&](const PointPair& pair) {
                              return (points[pair.first].array() * sign.array() > 0).all();
                            }),
              100)
        << octant;
  }
}

TEST(AuditedPairs, OfManyPointsHoldTheClosest) {
  for (const std::size_t near : {0, 40'000, 99'999}) {
    std::vector<Vec3> points = sphere_of_many_points();
    points.push_back(points[near] + Vec3(3e-6, 1e-6, 2e-6));
    const auto pairs = audited_pairs(Correlation(points, exponential, Distance::euclidean()));
    const std::vector<double> r = distances(pairs, points, Distance::euclidean());
    EXPECT_LT(*std::min_element(r.begin(), r.end()), 1e-5) << near;
  }
}

// Streaks: two of three lengths infinite, so that most points are at distance 0 of some other.
TEST(AuditedPairs, BearPointsAtDistanceZero) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> points = test::plate(30).nodes;
  const Distance streaks = Distance::stretched({.lengths = {0.1, inf, inf}});
  EXPECT_GT(audited_pairs(Correlation(points, exponential, streaks)).size(), 1000u);
  std::vector<Vec3> column = points;
  for (Vec3& x : column) x[0] = 0;
  EXPECT_FALSE(audited_pairs(Correlation(column, exponential, streaks)).empty());
}

/// A factor as a sampling method for the exponential.
class FactorMethod final : public FieldMethod {
 public:
  FactorMethod(Factor factor, std::vector<Vec3> points,
               const Autocorrelation& autocorrelation = exponential)
      : FieldMethod(Correlation(std::move(points), autocorrelation, Distance::euclidean())),
        factor_(std::move(factor)) {}

  std::vector<double> heights(const NoiseStream& stream) const override {
    return factor_.heights(stream);
  }
  std::vector<double> covariances(std::span<const PointPair> pairs) const override {
    return factor_.covariances(pairs);
  }
  Audit audit() const { return audit_covariance(*this); }

 private:
  Factor factor_;
};

// Uncorrelated heights, where an exponential was asked for: the error is rho at the shortest
// distance.
TEST(Audit, SeesAMissingCorrelation) {
  const std::vector<Vec3> points = sphere_points(3);
  const FactorMethod method(
      {identity(points.size()), identity_order(points.size()), FactorShape::trapezoid}, points);
  const auto pairs = audited_pairs(Correlation(points, exponential, Distance::euclidean()));
  const std::vector<double> r = distances(pairs, points, Distance::euclidean());
  const Audit audit = method.audit();
  EXPECT_DOUBLE_EQ(audit.covariance_error, exponential.rho(*std::min_element(r.begin(), r.end())));
  EXPECT_EQ(audit.n_pairs, static_cast<Index>(pairs.size()));
  EXPECT_EQ(audit.n_diagonal, static_cast<Index>(points.size()));
}

// A row of the factor a thousandth too large: its variance is 1.001^2, too large by 0.002001.
TEST(Audit, SeesOneRowThatIsTooLarge) {
  const std::size_t n = 642, row = 123;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(1000.0 * static_cast<double>(i), 0, 0);
  DenseMatrix columns = identity(n);
  const FactorMethod right({identity(n), identity_order(n), FactorShape::trapezoid}, points);
  EXPECT_EQ(right.audit().covariance_error, 0);
  columns(row, row) *= 1.001;
  const FactorMethod wrong({std::move(columns), identity_order(n), FactorShape::trapezoid}, points);
  EXPECT_NEAR(wrong.audit().covariance_error, 0.002001, 1e-12);
}

TEST(Audit, DoesNotTakeANumberThatIsNoneForAgreement) {
  const std::vector<Vec3> points = sphere_points(2);
  DenseMatrix columns = identity(points.size());
  columns(7, 3) = std::numeric_limits<double>::quiet_NaN();
  const FactorMethod method(
      {std::move(columns), identity_order(points.size()), FactorShape::trapezoid}, points);
  EXPECT_EQ(method.audit().covariance_error, std::numeric_limits<double>::infinity());
}

// What is compared is what was asked for, so a factor of another length does not pass.
TEST(Audit, SeesALengthThatWasNotAskedFor) {
  const std::vector<Vec3> points = sphere_points(2);
  const Distance distance = Distance::euclidean();
  const Autocorrelation longer(
      {.family = Family::exponential, .length = 0.3 * std::numbers::sqrt2});
  const auto factor = [&] {
    return factorize_correlation(autocorrelation_matrix(Correlation(points, longer, distance)))
        .factor;
  };
  EXPECT_LT(FactorMethod(factor(), points, longer).audit().covariance_error, 1e-12);
  EXPECT_GT(FactorMethod(factor(), points, exponential).audit().covariance_error, 0.05);
}

}  // namespace
}  // namespace roughmesh::detail
