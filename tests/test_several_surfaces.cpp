// SPDX-License-Identifier: BSD-3-Clause
// Several surfaces of one mesh, masks and periodic links in a run.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/pipeline.hpp"

#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/planar.hpp"

using namespace roughmesh;
using test::message_of;

namespace {

constexpr double rq = 0.02;
constexpr double inf = std::numeric_limits<double>::infinity();

Roughness edge(const std::string& group, std::uint64_t seed) {
  Roughness roughness;
  roughness.group = {group};
  roughness.rms = rq;
  roughness.length = {0.5};
  roughness.acf = Family::exponential;
  roughness.seed = seed;
  roughness.fixed = {"ends"};
  return roughness;
}

RoughenOptions two_edges(std::uint64_t seed_of_upper) {
  RoughenOptions options;
  options.surfaces = {edge("lower", 1), edge("upper", seed_of_upper)};
  options.volume = VolumeChoice::none;
  return options;
}

std::vector<RoughMesh> run(const Mesh& mesh, const RoughenOptions& options) {
  std::vector<RoughMesh> meshes;
  roughen(mesh, options, [&](const RoughMesh& rough, Report&) { meshes.push_back(rough); });
  return meshes;
}

// Along y, at the two edges of a strip of n_x columns.
struct Edges {
  std::vector<double> lower, upper;
};

Edges displacements(const RoughMesh& rough, int n_x, int n_y) {
  Edges edges;
  for (int i = 1; i < n_x; ++i) {
    edges.lower.push_back(rough.displacements[i].y());
    edges.upper.push_back(rough.displacements[n_y * (n_x + 1) + i].y());
  }
  return edges;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

}  // namespace

// The mean over x of the product of independent edges of length L has the variance
// Rq^4 (1/L^2) times the double integral of rho^2, below Rq^4 l / L for rho = exp(-r / l).
TEST(SeveralSurfaces, EdgesOfDifferentSeedsAreIndependent) {
  const Mesh mesh = test::strip(80, 2, 16);
  RoughenOptions options = two_edges(2);
  options.realizations = 400;
  double sum = 0;
  for (const RoughMesh& rough : run(mesh, options)) {
    const Edges d = displacements(rough, 80, 2);
    sum += mean_product(d.lower, d.upper);
  }
  const double standard_error = rq * rq * std::sqrt(0.5 / 16.0 / 400.0);
  EXPECT_NEAR(sum / 400, 0, 5 * standard_error);
}

// One field that does not change across the line: outward normals are opposite, so the line
// breathes; with one edge flipped it wanders.
TEST(SeveralSurfaces, EdgesOfOneStreakFieldMoveTogether) {
  const Mesh mesh = test::strip(60, 2, 16, 0.3);
  RoughenOptions options = two_edges(1);
  for (Roughness& surface : options.surfaces) surface.length = {0.5, inf};
  const Edges breathing = displacements(run(mesh, options).front(), 60, 2);
  options.surfaces[1].flip = true;
  const Edges wandering = displacements(run(mesh, options).front(), 60, 2);
  for (std::size_t i = 0; i < breathing.lower.size(); ++i) {
    EXPECT_NEAR(breathing.upper[i], -breathing.lower[i], 1e-7 * rq);
    EXPECT_NEAR(wandering.upper[i], wandering.lower[i], 1e-7 * rq);
  }
  EXPECT_GT(mean_product(wandering.lower, wandering.lower), 0.3 * rq * rq);
}

TEST(SeveralSurfaces, ASurfaceIsTheSameAloneAndBesideAnother) {
  const Mesh mesh = test::strip(60, 2, 16);
  const RoughenOptions both = two_edges(2);
  RoughenOptions alone = both;
  alone.surfaces.pop_back();
  const Edges together = displacements(run(mesh, both).front(), 60, 2);
  EXPECT_EQ(displacements(run(mesh, alone).front(), 60, 2).lower, together.lower);
}

TEST(SeveralSurfaces, EachHasItsOwnRoughness) {
  const Mesh mesh = test::strip(400, 2, 100);
  RoughenOptions options = two_edges(2);
  options.surfaces[1].rms = 3 * rq;
  Report report = roughen(mesh, options, [](const RoughMesh&, Report&) {});
  ASSERT_EQ(report.realizations[0].surfaces.size(), 2U);
  for (const SurfaceStatistics& s : report.realizations[0].surfaces)
    EXPECT_NEAR(s.heights.sq, s.sq_expected, 5 * s.sq_expected_std);
  EXPECT_NEAR(report.realizations[0].surfaces[1].sq_expected,
              3 * report.realizations[0].surfaces[0].sq_expected, 1e-12);
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["surfaces"].size(), 2U);
  EXPECT_EQ(json["request"]["surface"][1]["rms"], 3 * rq);
  EXPECT_EQ(json["surface"], json["surfaces"][0]["surface"]);
  EXPECT_EQ(json["realizations"][0]["surfaces"][1]["sq"],
            report.realizations[0].surfaces[1].heights.sq);
}

TEST(SeveralSurfaces, AFaceBelongsToOneOfThem) {
  RoughenOptions options = two_edges(2);
  options.surfaces[1].group = {"lower"};
  EXPECT_NE(message_of([&] { run(test::strip(8, 2, 4), options); }), "no error");
}

TEST(Masks, FixedNodesStayAndSqIsTakenWithAndWithoutTheFadedBand) {
  const Mesh mesh = test::strip(400, 2, 100);
  RoughenOptions options = two_edges(2);
  options.surfaces.pop_back();
  options.surfaces[0].fade = {"20:ends"};
  const Report report = roughen(mesh, options, [](const RoughMesh& rough, Report&) {
    EXPECT_TRUE(rough.displacements[0].isZero(0));
    EXPECT_TRUE(rough.displacements[400].isZero(0));
  });
  const SurfaceStatistics& s = report.realizations[0].surfaces[0];
  ASSERT_TRUE(s.unfaded);
  EXPECT_LT(s.sq_expected, s.unfaded->expected);
  EXPECT_NEAR(s.heights.sq, s.sq_expected, 5 * s.sq_expected_std);
  EXPECT_NEAR(s.unfaded->sq, s.unfaded->expected, 5 * s.unfaded->expected_std);
  EXPECT_EQ(report.surfaces[0].masked_nodes, 2 * 80);
}

TEST(PeriodicRun, LinkedNodesMoveTogetherAndThePeriodComesFromTheLinks) {
  const Mesh mesh = test::strip(64, 2, 16);
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) surface.fixed.clear();
  const Report report = roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
    for (const auto& [slave, master] : mesh.periodic_links[0].nodes) {
      EXPECT_EQ(rough.mesh.nodes[slave].y(), rough.mesh.nodes[master].y());
      EXPECT_EQ(rough.displacements[slave], rough.displacements[master]);
    }
  });
  EXPECT_EQ(report.request.surfaces[0].distance, DistanceKind::periodic);
  EXPECT_EQ(report.request.surfaces[0].period, (std::vector<double>{16, 0, 0}));
  EXPECT_TRUE(report.surfaces[0].field.minimum_image_difference);
}

TEST(PeriodicRun, ADistanceThatBreaksTheLinksIsRefused) {
  const Mesh mesh = test::strip(64, 2, 16);
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) {
    surface.fixed.clear();
    surface.distance = DistanceKind::euclidean;
  }
  EXPECT_NE(message_of([&] { run(mesh, options); }).find("--distance periodic"), std::string::npos);
  for (Roughness& surface : options.surfaces) surface.fixed = {"ends"};
  EXPECT_EQ(message_of([&] { run(mesh, options); }), "no error");
}

TEST(PeriodicRun, NeedsAPeriod) {
  Mesh mesh = test::strip(64, 2, 16);
  mesh.periodic_links.clear();
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) {
    surface.fixed.clear();
    surface.distance = DistanceKind::periodic;
  }
  EXPECT_NE(message_of([&] { run(mesh, options); }).find("--period"), std::string::npos);
  for (Roughness& surface : options.surfaces) surface.period = {16, 0, 0};
  for (const RoughMesh& rough : run(mesh, options))
    EXPECT_EQ(rough.displacements[0], rough.displacements[64]);
}
