// SPDX-License-Identifier: BSD-3-Clause
// What a mesh can carry, against closed forms and brute force.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "roughmesh/resolution.hpp"

#include "parallel.hpp"
#include "support/meshes.hpp"
#include "support/surfaces.hpp"

using namespace roughmesh;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Autocorrelation exponential(double length) {
  return Autocorrelation({.family = Family::exponential, .length = length});
}

Resolution resolution_of(const Surface& surface, const Autocorrelation& acf,
                         const Distance& distance) {
  return assess_resolution(surface, Correlation(surface.points, acf, distance));
}

// The plate's median edge is the side of its squares.
Resolution on_plate(const Autocorrelation& acf, int divisions = 20) {
  return resolution_of(test::surface_of(test::plate(divisions)), acf, Distance::euclidean());
}

Surface squares_instead_of_triangles(Surface surface, int divisions) {
  surface.face_offsets = {0};
  surface.face_points.clear();
  surface.face_tags.clear();
  const Index row = divisions + 1;  // points are sorted by x, then y
  for (Index i = 0; i < divisions; ++i)
    for (Index j = 0; j < divisions; ++j) {
      const Index a = i * row + j;
      surface.face_points.insert(surface.face_points.end(), {a, a + row, a + row + 1, a + 1});
      surface.face_offsets.push_back(static_cast<Index>(surface.face_points.size()));
      surface.face_tags.push_back(1);
    }
  return surface;
}

// Mean of the largest |height| over realizations of a dense sampler.
double mean_max_height(const Surface& surface, const Autocorrelation& acf, int n_realizations) {
  const Index n = surface.n_points();
  Eigen::MatrixXd matrix(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      matrix(i, j) = acf.rho((surface.points[i] - surface.points[j]).norm());
  matrix.diagonal().array() += 1e-10;
  const Eigen::MatrixXd factor = matrix.llt().matrixL();
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  double sum = 0;
  Eigen::VectorXd noise(n);
  for (int k = 0; k < n_realizations; ++k) {
    for (double& w : noise) w = normal(engine);
    sum += (factor * noise).cwiseAbs().maxCoeff();
  }
  return sum / n_realizations;
}

bool mentions(const std::string& line, const std::string& words) {
  return line.find(words) != std::string::npos;
}

}  // namespace

TEST(Resolution, InterpolationErrorOfThePapersRule) {
  const double l = 2.5 / 20;
  EXPECT_NEAR(on_plate(Autocorrelation({.length = l})).interpolation_error, 0.034, 0.0005);
  EXPECT_NEAR(on_plate(exponential(l)).interpolation_error, 0.44, 0.005);
}

// Variance of d(h/2) - (d(0) + d(h)) / 2, from the three by three covariance itself.
TEST(Resolution, InterpolationErrorIsTheErrorAtMidEdge) {
  const Autocorrelation acf({.family = Family::matern, .length = 0.08, .nu = 1.2});
  const double h = 1.0 / 20;
  const Eigen::Vector3d weights(-0.5, 1, -0.5);
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) covariance(i, j) = acf.rho(std::abs(i - j) * h / 2);
  EXPECT_NEAR(on_plate(acf).interpolation_error, std::sqrt(weights.dot(covariance * weights)),
              1e-12);
}

TEST(Resolution, SizesAndSpectrumAtTheNyquistWavenumber) {
  const Resolution resolution = on_plate(exponential(0.2));
  EXPECT_NEAR(resolution.mesh_size, 0.05, 1e-15);
  EXPECT_NEAR(resolution.largest_edge, 0.05 * std::sqrt(2), 1e-15);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_DOUBLE_EQ(resolution.lengths[axis], 0.2);
    EXPECT_NEAR(resolution.h_over_l[axis], 0.25, 1e-14);
  }
  // Exponential in the plane: (1 + q^2 l^2)^(-1/2).
  EXPECT_NEAR(resolution.spectrum_share_above_nyquist, 1 / std::hypot(1, pi / 0.05 * 0.2), 1e-13);
}

TEST(Resolution, WorstAxisOfAnAnisotropicField) {
  const Surface surface = test::surface_of(test::plate(20));
  const Autocorrelation acf({.length = 0.5});
  const Distance distance = Distance::stretched({.lengths = {0.5, 0.1, infinite}});
  const Resolution resolution = resolution_of(surface, acf, distance);
  EXPECT_NEAR(resolution.lengths[0], 0.5, 1e-15);
  EXPECT_NEAR(resolution.lengths[1], 0.1, 1e-15);
  EXPECT_EQ(resolution.lengths[2], infinite);
  EXPECT_EQ(resolution.h_over_l[2], 0);
  const Resolution short_axis = on_plate(Autocorrelation({.length = 0.1}));
  EXPECT_NEAR(resolution.interpolation_error, short_axis.interpolation_error, 1e-13);
  EXPECT_NEAR(resolution.spectrum_share_above_nyquist, short_axis.spectrum_share_above_nyquist,
              1e-13);
  // Slopes 1 / 0.5 along x and 1 / 0.1 along y; z is normal to the plate.
  EXPECT_NEAR(resolution.field_slope.value(), std::hypot(2, 10), 1e-12);
}

// In a square of side h with its diagonal, every triangle has the slope (d_x^2 + d_y^2) / h^2 along
// its two legs: E = 4 (1 - rho(h)) / h^2.
TEST(Resolution, SlopeOfTheInterpolantOnSquares) {
  const double h = 1.0 / 20;
  for (const Autocorrelation& acf : {Autocorrelation({.length = 0.15}), exponential(0.15)}) {
    const double expected = 2 * std::sqrt(1 - acf.rho(h)) / h;
    EXPECT_NEAR(on_plate(acf).rms_slope, expected, 1e-12 * expected);
    const Surface squares = squares_instead_of_triangles(test::surface_of(test::plate(20)), 20);
    EXPECT_NEAR(resolution_of(squares, acf, Distance::euclidean()).rms_slope, expected,
                1e-12 * expected);
  }
}

// On any mesh the interpolant's slope tends to the field's, sqrt(2) / l for a Gaussian, from below:
// 1 - rho(h) = h^2/(2 l^2) (1 - h^2/(4 l^2)).
TEST(Resolution, SlopeTendsToThatOfTheField) {
  const Surface surface = test::surface_of(test::icosphere(4));
  const double h = surface.mesh_size.max;
  const Resolution resolution =
      resolution_of(surface, Autocorrelation({.length = 1}), Distance::euclidean());
  EXPECT_NEAR(resolution.field_slope.value(), std::sqrt(2.0), 1e-14);
  EXPECT_LT(resolution.rms_slope, std::sqrt(2.0));
  EXPECT_GT(resolution.rms_slope, std::sqrt(2.0) * (1 - h * h / 4));
  EXPECT_FALSE(resolution_of(surface, exponential(1), Distance::euclidean()).field_slope);
}

// 800 realizations give the mean of the largest height to 0.35 / sqrt(800) = 0.012, times 4; the
// approximation is granted 0.1.
TEST(Resolution, LargestHeightAgreesWithMonteCarlo) {
  const Surface plate = test::surface_of(test::plate(20));
  const Surface sphere = test::surface_of(test::icosphere(2));
  for (const Autocorrelation& acf :
       {Autocorrelation({.length = 0.12}), Autocorrelation({.length = 0.4}), exponential(0.12),
        exponential(0.01)})
    for (const Surface* surface : {&plate, &sphere}) {
      const double expected =
          resolution_of(*surface, acf, Distance::euclidean()).expected_max_height;
      EXPECT_NEAR(expected, mean_max_height(*surface, acf, 800), 0.1 + 0.048)
          << name(acf.family()) << " " << acf.length() << " " << surface->n_points();
    }
}

// One rigid height: E|d| = sqrt(2 / pi).
TEST(Resolution, LargestHeightOfARigidShift) {
  EXPECT_NEAR(on_plate(Autocorrelation({.length = 1e4})).expected_max_height, std::sqrt(2 / pi),
              1e-3);
}

TEST(Resolution, CurvatureOfASphereIsItsRadius) {
  for (const double radius : {1e-9, 1.0, 50.0})
    for (int subdivisions = 0; subdivisions <= 4; ++subdivisions) {
      const Resolution resolution =
          resolution_of(test::surface_of(test::icosphere(subdivisions, radius)),
                        Autocorrelation({.length = radius}), Distance::euclidean());
      EXPECT_NEAR(resolution.min_curvature_radius, radius, 0.02 * radius) << subdivisions;
      EXPECT_NEAR(resolution.largest_safe_rq,
                  resolution.min_curvature_radius / resolution.expected_max_height, 1e-12 * radius);
    }
}

TEST(Resolution, FlatSurfacesHaveNoLimit) {
  Mesh mesh = test::plate(10);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& x : mesh.nodes) x = rotation * x;
  const Resolution resolution = resolution_of(
      test::surface_of(mesh), Autocorrelation({.length = 0.3}), Distance::euclidean());
  EXPECT_EQ(resolution.min_curvature_radius, infinite);
  EXPECT_EQ(resolution.largest_safe_rq, infinite);
  EXPECT_TRUE(resolution_warnings(resolution, 0.99 / resolution.rms_slope).empty());
}

// A plate folded to an L: its faces are flat, and the fold is a sharp edge, not a curvature.
TEST(Resolution, SharpEdgesAreNoCurvature) {
  Mesh mesh = test::plate(10);
  for (Vec3& x : mesh.nodes)
    if (x.x() > 0.5) x = Vec3(0.5, x.y(), 0.5 - x.x());
  const Resolution resolution = resolution_of(
      test::surface_of(mesh), Autocorrelation({.length = 0.3}), Distance::euclidean());
  EXPECT_EQ(resolution.min_curvature_radius, infinite);
}

TEST(Resolution, ScalesWithTheLengthUnit) {
  const auto at = [](double unit) {
    return resolution_of(test::surface_of(test::icosphere(2, unit)), exponential(0.3 * unit),
                         Distance::euclidean());
  };
  const Resolution one = at(1);
  for (const double unit : {1e-12, 1024.0, 1e12}) {
    const Resolution other = at(unit);
    EXPECT_NEAR(other.mesh_size / unit, one.mesh_size, 1e-13);
    EXPECT_NEAR(other.h_over_l[0], one.h_over_l[0], 1e-13);
    EXPECT_NEAR(other.spectrum_share_above_nyquist, one.spectrum_share_above_nyquist, 1e-13);
    EXPECT_NEAR(other.rms_slope * unit, one.rms_slope, 1e-12);
    EXPECT_NEAR(other.expected_max_height, one.expected_max_height, 1e-12);
    EXPECT_NEAR(other.largest_safe_rq / unit, one.largest_safe_rq, 1e-12);
  }
}

TEST(Resolution, IsTheSameOnAnyNumberOfThreads) {
  const Surface surface = test::surface_of(test::icosphere(5));
  const auto slope = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return resolution_of(surface, exponential(0.1), Distance::euclidean()).rms_slope;
  };
  EXPECT_EQ(slope(1), slope(2));
}

TEST(Resolution, GaussianAtThePapersRuleDoesNotWarn) {
  EXPECT_TRUE(resolution_warnings(on_plate(Autocorrelation({.length = 2.5 / 20})), 0.01).empty());
}

TEST(Resolution, WarnsOfACoarseMeshWithTheRemedy) {
  const auto warnings = resolution_warnings(on_plate(Autocorrelation({.length = 0.1})), 0.01);
  ASSERT_EQ(warnings.size(), 1U);
  for (const char* words : {"0.05", "l/2.5 = 0.04", "correlation length of 0.125", "refine"})
    EXPECT_TRUE(mentions(warnings[0], words)) << words << " in: " << warnings[0];
}

TEST(Resolution, WarnsOfALargeEdgeInAMeshThatIsFineElsewhere) {
  Mesh mesh = test::plate(20);
  for (Vec3& x : mesh.nodes)
    if (x.x() > 0.99) x.x() += 0.2;
  const Resolution resolution = resolution_of(
      test::surface_of(mesh), Autocorrelation({.length = 0.2}), Distance::euclidean());
  const auto warnings = resolution_warnings(resolution, 0.1);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(mentions(warnings[0], "largest edge 0.255")) << warnings[0];
}

TEST(Resolution, ExponentialWarnsOnceOfItsNature) {
  const auto warnings = resolution_warnings(on_plate(exponential(0.2)), 0.01);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(mentions(warnings[0], "7.93 %") && mentions(warnings[0], "nature")) << warnings[0];
}

TEST(Resolution, SmoothFamiliesAreToldToRefine) {
  const auto warnings = resolution_warnings(on_plate(Autocorrelation({.length = 0.02})), 0.01);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_TRUE(mentions(warnings[1], "Nyquist") && mentions(warnings[1], "refine")) << warnings[1];
}

TEST(Resolution, WarnsOfFacesThatStandOnEnd) {
  const Resolution resolution = on_plate(Autocorrelation({.length = 0.2}));
  EXPECT_TRUE(resolution_warnings(resolution, 0.99 / resolution.rms_slope).empty());
  const auto warnings = resolution_warnings(resolution, 1.01 / resolution.rms_slope);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(mentions(warnings[0], "slope") && mentions(warnings[0], "1.01")) << warnings[0];
  EXPECT_EQ(height_warnings(resolution, 1.01 / resolution.rms_slope), warnings);
}

TEST(Resolution, WarnsOfHeightsBeyondTheRadiusOfCurvature) {
  const Resolution resolution = resolution_of(
      test::surface_of(test::icosphere(3)), Autocorrelation({.length = 2}), Distance::euclidean());
  EXPECT_TRUE(resolution_warnings(resolution, 0.99 * resolution.largest_safe_rq).empty());
  const auto warnings = resolution_warnings(resolution, 1.01 * resolution.largest_safe_rq);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(mentions(warnings[0], "fold") && mentions(warnings[0], "--rms")) << warnings[0];
}
