// SPDX-License-Identifier: BSD-3-Clause
// Distances: metric properties, sphere fits, anisotropy.
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

class Random {
 public:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3 point() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  Vec3 direction() { return point().normalized(); }
  Eigen::Matrix3d rotation() {
    return Eigen::AngleAxisd(uniform(0, 2 * pi), direction()).toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_{11};
};

std::string message_of(const std::vector<Vec3>& points) {
  try {
    static_cast<void>(Distance::great_circle(points));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(Distance, EuclideanIsTheNorm) {
  Random random;
  const Distance distance = Distance::euclidean();
  EXPECT_EQ(distance.kind(), DistanceKind::euclidean);
  EXPECT_TRUE(distance.stretch().isIdentity(0));
  for (int k = 0; k < 100; ++k) {
    const Vec3 x = random.point(), y = random.point();
    EXPECT_DOUBLE_EQ(distance(x, y), (x - y).norm());
    EXPECT_EQ(distance(x, x), 0);
    EXPECT_EQ(distance(x, y), distance(y, x));
  }
}

TEST(Distance, EqualLengthsAreIsotropicWhateverTheAxes) {
  Random random;
  const Distance distance =
      Distance::stretched({.lengths = {0.3, 0.3, 0.3}, .axes = random.rotation()});
  EXPECT_TRUE(distance.stretch().isIdentity(0));
}

// The anisotropic field of the definition: rho(|diag(1/l) Q^T (x - y)|) with a unit length.
TEST(Distance, StretchedGivesEachAxisItsLength) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const Anisotropy anisotropy{
        .lengths = {random.uniform(0.1, 5), random.uniform(0.1, 5), random.uniform(0.1, 5)},
        .axes = random.rotation()};
    const Distance distance = Distance::stretched(anisotropy);
    const Autocorrelation acf({.length = anisotropy.lengths[0]});
    const Autocorrelation unit({.length = 1});
    const Vec3 x = random.point(), y = random.point();
    Vec3 scaled = anisotropy.axes.transpose() * (x - y);
    for (int axis = 0; axis < 3; ++axis) scaled[axis] /= anisotropy.lengths[axis];
    EXPECT_NEAR(acf.rho(distance(x, y)), unit.rho(scaled.norm()), 1e-14);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = anisotropy.lengths[axis] * anisotropy.axes.col(axis);
      EXPECT_NEAR(acf.rho(distance(x, x + step)), std::exp(-0.5), 1e-13);
    }
  }
}

TEST(Distance, InfiniteLengthMakesStreaks) {
  const Distance distance = Distance::stretched({.lengths = {infinite, 2, 1}});
  EXPECT_EQ(distance({0, 0, 0}, {1e9, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(distance({0, 0, 0}, {5, 2, 0}), 2);  // the reference is the first finite length
  EXPECT_DOUBLE_EQ(distance({0, 0, 0}, {5, 0, 2}), 4);
}

TEST(Distance, RefusesLengthsAndAxesOutOfRange) {
  const double nan = std::nan("");
  for (const double bad : {0.0, -1.0, nan, -infinite})
    EXPECT_THROW(Distance::stretched({.lengths = {1, bad, 1}}), InputError);
  EXPECT_THROW(Distance::stretched({.lengths = {infinite, infinite, infinite}}), InputError);
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes(0, 1) = 1e-11;
  EXPECT_THROW(Distance::stretched({.lengths = {1, 2, 3}, .axes = axes}), InputError);
  axes(0, 1) = nan;
  EXPECT_THROW(Distance::stretched({.lengths = {1, 2, 3}, .axes = axes}), InputError);
}

TEST(Distance, GreatCircleIsAnArc) {
  const Distance distance = Distance::great_circle(Sphere{.centre = {1, 2, 3}, .radius = 5});
  Random random;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3d axes = random.rotation();
    const double angle = random.uniform(0, pi);
    const Vec3 x = Vec3(1, 2, 3) + 5 * axes.col(0);
    const Vec3 y =
        Vec3(1, 2, 3) + 5 * (std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1));
    EXPECT_NEAR(distance(x, y), 5 * angle, 1e-14 * 5 * pi);
  }
}

// The arc cosine of a rounded product above 1 is no number; at small angles it loses half of the
// digits. Points at distance 1e-9 on the unit sphere keep nine digits of ten: 1e-16 / 1e-9.
TEST(Distance, GreatCircleHasNoDomainToLeave) {
  Random random;
  const Distance distance = Distance::great_circle(Sphere{.centre = Vec3::Zero(), .radius = 1});
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = random.direction();
    EXPECT_EQ(distance(x, x), 0);
    EXPECT_NEAR(distance(x, 1.001 * x), 0, 1e-15) << "off the sphere only the angle counts";
    EXPECT_NEAR(distance(x, -x), pi, 1e-15);
    const Vec3 tangent = x.cross(random.direction()).normalized();
    EXPECT_NEAR(distance(x, x + 1e-9 * tangent), 1e-9, 1e-15);
  }
}

TEST(Distance, GreatCircleObeysTheTriangleInequality) {
  Random random;
  const Distance distance = Distance::great_circle(Sphere{.centre = Vec3::Zero(), .radius = 1});
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = random.direction(), y = random.direction(), z = random.direction();
    EXPECT_LE(distance(x, z), distance(x, y) + distance(y, z) + 1e-15);
    EXPECT_EQ(distance(x, y), distance(y, x));
    EXPECT_GE(distance(x, y), (x - y).norm() - 1e-15);
  }
}

// Rounded coordinates leave the sphere by eps |centre|; the fit of a whole sphere is as good.
TEST(Distance, FitFindsTheSphereInAnyPlaceAndUnit) {
  for (const double unit : {1e-9, 1.0, 1e9})
    for (const double offset : {0.0, 10.0, 1e6}) {
      const Vec3 centre = unit * offset * Vec3(1, -2, 0.5);
      std::vector<Vec3> points = test::icosphere(2, 3 * unit).nodes;
      for (Vec3& x : points) x += centre;
      const Sphere sphere = fit_sphere(points);
      const double rounding = 4e-16 * (3 * unit + centre.norm());
      EXPECT_NEAR(sphere.radius, 3 * unit, 4 * rounding);
      EXPECT_LT((sphere.centre - centre).norm(), 4 * rounding);
      EXPECT_LT(sphere.deviation, 8 * rounding);
    }
}

TEST(Distance, FourPointsDetermineASphere) {
  Random random;
  for (int k = 0; k < 50; ++k) {
    const Vec3 centre = random.point();
    std::vector<Vec3> points(4);
    for (Vec3& x : points) x = centre + 2 * random.direction();
    const Vec3 sides[] = {points[1] - points[0], points[2] - points[0], points[3] - points[0]};
    if (std::abs(sides[0].dot(sides[1].cross(sides[2]))) < 0.5) continue;  // nearly a plane
    const Sphere sphere = fit_sphere(points);
    EXPECT_NEAR(sphere.radius, 2, 1e-12);
    EXPECT_LT((sphere.centre - centre).norm(), 1e-12);
  }
}

// A least-squares fit does not move along its parameters: radius = mean distance, and the mean of
// (|x - c| - R) (x - c) / |x - c| vanishes.
TEST(Distance, FitMinimizesRadialDistances) {
  Random random;
  std::vector<Vec3> points = test::icosphere(2).nodes;
  for (Vec3& x : points) x *= 1 + random.uniform(-0.05, 0.05);
  const Sphere sphere = fit_sphere(points);
  const auto n = static_cast<double>(points.size());
  double mean = 0, largest = 0;
  Vec3 gradient = Vec3::Zero();
  for (const Vec3& x : points) {
    const Vec3 arm = x - sphere.centre;
    mean += (arm.norm() - sphere.radius) / n;
    gradient += (arm.norm() - sphere.radius) * arm.normalized() / n;
    largest = std::max(largest, std::abs(arm.norm() - sphere.radius));
  }
  EXPECT_NEAR(mean, 0, 1e-14);
  EXPECT_LT(gradient.norm(), 1e-13);
  EXPECT_NEAR(sphere.deviation, largest, 1e-15);
}

TEST(Distance, FitWorksOnACap) {
  std::vector<Vec3> cap;
  for (const Vec3& x : test::icosphere(4).nodes)
    if (x.z() > std::cos(0.2)) cap.push_back(x);
  const Sphere sphere = fit_sphere(cap);
  EXPECT_NEAR(sphere.radius, 1, 1e-11);  // eps over the cap's relative thickness squared
}

TEST(Distance, RefusesPointsWithoutAUniqueSphere) {
  EXPECT_THROW(fit_sphere(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(fit_sphere(std::vector<Vec3>(9, Vec3(1, 2, 3))), InputError);
  EXPECT_THROW(fit_sphere(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}),
               InputError);
  Random random;
  for (const double offset : {0.0, 1e6}) {
    const Eigen::Matrix3d rotation = random.rotation();
    std::vector<Vec3> points = test::plate(6).nodes;
    for (Vec3& x : points) x = rotation * x + Vec3::Constant(offset);
    EXPECT_THROW(fit_sphere(points), InputError);
  }
  EXPECT_THROW(fit_sphere(std::vector<Vec3>(5, Vec3::Constant(std::nan("")))), InputError);
}

TEST(Distance, GreatCircleRefusesWhatIsNoSphere) {
  std::vector<Vec3> points = test::icosphere(2, 10).nodes;
  points[5] *= 1 + 0.9e-3;
  EXPECT_EQ(message_of(points), "");
  points[5] *= 1 + 0.9e-3;
  const std::string message = message_of(points);
  std::ostringstream deviation;
  deviation << std::setprecision(3) << fit_sphere(points).deviation;
  EXPECT_NE(message.find(deviation.str()), std::string::npos) << message;
  EXPECT_NE(message.find("--distance euclidean"), std::string::npos) << message;
  EXPECT_THROW(Distance::great_circle(Sphere{}), InputError);
}
