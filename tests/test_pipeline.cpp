// SPDX-License-Identifier: BSD-3-Clause
// The stages together: a mesh goes in, rough meshes and a report that can be believed come out.
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/pipeline.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

RoughenOptions sphere_options() {
  RoughenOptions options;
  options.surfaces[0].rms = 0.02;
  options.surfaces[0].length = {0.3};
  return options;
}

struct Result {
  std::vector<RoughMesh> meshes;
  Report report;
};

Result run(const Mesh& mesh, const RoughenOptions& options) {
  Result result;
  result.report = roughen(mesh, options,
                          [&](const RoughMesh& rough, Report&) { result.meshes.push_back(rough); });
  return result;
}

/// The same mesh with its nodes in another order; `place[i]` is where node i went.
Mesh renumbered(const Mesh& mesh, std::vector<Index>& place) {
  place.resize(mesh.nodes.size());
  std::iota(place.begin(), place.end(), 0);
  std::mt19937 generator(1);
  for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[generator() % i]);
  Mesh result = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) result.nodes[place[i]] = mesh.nodes[i];
  for (ElementBlock& block : result.blocks)
    for (Index& node : block.nodes) node = place[node];
  return result;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST(Pipeline, RealizationsAreTheSameAloneAndAmongOthers) {
  const Mesh sphere = test::icosphere(2);
  RoughenOptions options = sphere_options();
  options.realizations = 4;
  const Result all = run(sphere, options);
  options.realizations = 1;
  options.first = 3;
  const Result alone = run(sphere, options);
  EXPECT_EQ(all.meshes[3].heights, alone.meshes[0].heights);
  EXPECT_EQ(alone.meshes[0].realization, 3U);
  EXPECT_GT(largest_difference(all.meshes[0].heights, all.meshes[1].heights),
            options.surfaces[0].rms);
}

TEST(Pipeline, SeedsGiveOtherSurfaces) {
  const Mesh sphere = test::icosphere(2);
  RoughenOptions options = sphere_options();
  const Result zero = run(sphere, options);
  options.surfaces[0].seed = 1;
  EXPECT_GT(largest_difference(zero.meshes[0].heights, run(sphere, options).meshes[0].heights),
            options.surfaces[0].rms);
}

// The promise of docs/math.md, "Seeds": equal bits for `lattice`; 1e-8 Rq for `cholesky`, by its
// plain and its pivoted factorization.
TEST(Pipeline, HeightsDoNotDependOnThreadsOrNumbering) {
  const Mesh sphere = test::icosphere(3);
  for (const auto& [method, length] :
       {std::pair{Method::lattice, 0.1}, {Method::cholesky, 0.1}, {Method::cholesky, 0.5}}) {
    RoughenOptions options = sphere_options();
    options.method = method;
    options.surfaces[0].length = {length};
    const double allowed = method == Method::lattice ? 0 : 1e-8 * options.surfaces[0].rms;
    options.threads = 1;
    const Result one = run(sphere, options);
    options.threads = 2;
    const Result two = run(sphere, options);
    EXPECT_LE(largest_difference(one.meshes[0].heights, two.meshes[0].heights), allowed);

    std::vector<Index> place;
    const Result shuffled = run(renumbered(sphere, place), options);
    for (std::size_t i = 0; i < place.size(); ++i)
      ASSERT_NEAR(shuffled.meshes[0].heights[place[i]], two.meshes[0].heights[i], allowed);
  }
}

TEST(Pipeline, HeightsScaleWithTheUnit) {
  const Mesh sphere = test::icosphere(2);
  Mesh scaled = sphere;
  for (Vec3& x : scaled.nodes) x *= 1024;
  RoughenOptions options = sphere_options();
  const Result small = run(sphere, options);
  options.surfaces[0].rms *= 1024;
  options.surfaces[0].length[0] *= 1024;
  const Result large = run(scaled, options);
  for (std::size_t i = 0; i < sphere.nodes.size(); ++i)
    ASSERT_NEAR(large.meshes[0].heights[i], 1024 * small.meshes[0].heights[i],
                1e-8 * options.surfaces[0].rms);
}

// A rigid motion renames the places, so heights change; what must hold does not: the covariance,
// and with it the expected Sq and its spread. Bound: round-off of the turned coordinates, and for
// the spread of the sums over all pairs.
TEST(Pipeline, RigidMotionChangesNoStatistic) {
  const Mesh sphere = test::icosphere(3);
  Mesh moved = sphere;
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  for (Vec3& x : moved.nodes) x = turn * x + Vec3(10, -20, 30);
  const RoughenOptions options = sphere_options();
  const Result at_rest = run(sphere, options);
  const Result in_motion = run(moved, options);
  EXPECT_NEAR(in_motion.report.surfaces[0].area, at_rest.report.surfaces[0].area, 1e-11);
  const RealizationReport& a = at_rest.report.realizations[0];
  const RealizationReport& b = in_motion.report.realizations[0];
  EXPECT_NEAR(b.surfaces[0].sq_expected, a.surfaces[0].sq_expected,
              1e-9 * a.surfaces[0].sq_expected);
  EXPECT_NEAR(b.surfaces[0].sq_expected_std, a.surfaces[0].sq_expected_std,
              1e-9 * a.surfaces[0].sq_expected);
  // Both are draws from that law: five standard deviations.
  EXPECT_NEAR(a.surfaces[0].heights.sq, a.surfaces[0].sq_expected,
              5 * a.surfaces[0].sq_expected_std);
  EXPECT_NEAR(b.surfaces[0].heights.sq, b.surfaces[0].sq_expected,
              5 * b.surfaces[0].sq_expected_std);
  EXPECT_LE(in_motion.report.surfaces[0].audit.covariance_error, options.tolerance);
}

TEST(Pipeline, NodesMoveByTheirHeightAlongTheNormal) {
  const Mesh sphere = test::icosphere(2);
  const Result result = run(sphere, sphere_options());
  const RoughMesh& rough = result.meshes[0];
  for (std::size_t i = 0; i < sphere.nodes.size(); ++i) {
    const Vec3 radial = sphere.nodes[i].normalized();
    EXPECT_LE((rough.mesh.nodes[i] - sphere.nodes[i] - rough.heights[i] * radial).norm(), 1e-14);
  }
  EXPECT_EQ(rough.mesh.blocks[0].nodes, sphere.blocks[0].nodes);
}

TEST(Pipeline, TheInteriorFollowsAndTheBoxStays) {
  const Mesh mesh = test::ball_in_box(12);
  RoughenOptions options = sphere_options();
  options.surfaces[0].rms = 0.01;
  options.surfaces[0].group = {"surface"};
  const Result result = run(mesh, options);
  const Mesh& rough = result.meshes[0].mesh;
  for (const Index node : mesh.blocks[1].nodes) EXPECT_EQ(rough.nodes[node], mesh.nodes[node]);
  EXPECT_EQ(result.report.realizations[0].inverted_elements, 0);
  EXPECT_EQ(result.report.realizations[0].volume_method, VolumeMethod::harmonic);
  EXPECT_GT(result.report.realizations[0].min_quality, 0);
}

TEST(Pipeline, InvertedElementsAreRefusedUnlessAllowed) {
  const Mesh mesh = test::ball_in_box(8);
  RoughenOptions options = sphere_options();
  options.surfaces[0].group = {"surface"};
  options.surfaces[0].rms = 0.4;
  int delivered = 0;
  const auto count = [&](const RoughMesh&, Report&) { ++delivered; };
  EXPECT_THROW(roughen(mesh, options, count), CheckError);
  EXPECT_EQ(delivered, 0);
  options.allow_invalid = true;
  const Report report = roughen(mesh, options, count);
  EXPECT_EQ(delivered, 1);
  EXPECT_GT(report.realizations[0].inverted_elements, 0);
  EXPECT_FALSE(report.warnings.empty());
}

TEST(Pipeline, ReportStatesWhatWasMeasured) {
  const Mesh sphere = test::icosphere(3);
  RoughenOptions options = sphere_options();
  options.realizations = 2;
  const Result result = run(sphere, options);
  const auto json = nlohmann::json::parse(to_json(result.report));
  EXPECT_EQ(json["roughmesh"], version());
  EXPECT_EQ(json["request"]["rms"], options.surfaces[0].rms);
  EXPECT_EQ(json["surface"]["nodes"], 642);
  EXPECT_EQ(json["surface"]["elements"], 1280);
  EXPECT_LE(json["field"]["covariance_error"].get<double>(), options.tolerance);
  EXPECT_DOUBLE_EQ(json["field"]["equivalent_lengths"]["one_over_e"].get<double>(),
                   0.3 * std::sqrt(2.0));
  ASSERT_EQ(json["realizations"].size(), 2U);
  // Sq of the report is that of the heights: plain sums over nodes of equal area would be close to
  // it.
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double>& z = result.meshes[k].heights;
    double sum = 0, squares = 0;
    for (const double height : z) sum += height, squares += height * height;
    const double n = static_cast<double>(z.size());
    const double rms = std::sqrt(squares / n - sum * sum / (n * n));
    EXPECT_NEAR(json["realizations"][k]["sq"].get<double>(), rms, 0.05 * rms);
  }
  for (const char* key :
       {"read", "surface", "field", "audit", "displace", "volume", "check", "write", "total"})
    EXPECT_TRUE(json["timings"].contains(key)) << key;
  EXPECT_FALSE(json["citations"].empty());
}

TEST(Pipeline, WarnsOfWhatTheMeshCannotCarry) {
  const Mesh sphere = test::icosphere(2);
  const auto n_warnings = [&](double rms, double length) {
    RoughenOptions options = sphere_options();
    options.surfaces[0].rms = rms;
    options.surfaces[0].length = {length};
    options.allow_invalid = true;
    return run(sphere, options).report.warnings.size();
  };
  EXPECT_EQ(n_warnings(0.01, 1.0), 0U);
  EXPECT_GT(n_warnings(0.01, 0.1), 0U);   // h = 0.3 is coarse for l = 0.1
  EXPECT_GT(n_warnings(0.7, 1.0), 0U);    // heights beyond the radius
  EXPECT_GT(n_warnings(0.01, 1e3), 0U);   // unit slip: the correlation length dwarfs the body
  EXPECT_GT(n_warnings(1e-15, 1.0), 0U);  // below the digits of the coordinates
}

TEST(Pipeline, PeriodicLinksThatWouldBreakAreRefused) {
  Mesh sphere = test::icosphere(1);
  sphere.periodic_links = {{2, 1, 2, {}, {{0, 4}}}};  // no translation along an axis
  EXPECT_THROW(run(sphere, sphere_options()), InputError);
}
