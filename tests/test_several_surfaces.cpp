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

// Each its own cutoff, seed and warning: the upper edge is the one that a run of it alone makes.
TEST(SeveralSurfaces, EachHasItsOwnCutoff) {
  const Mesh mesh = test::strip(40, 2, 8);
  RoughenOptions options = two_edges(2), alone = options;
  options.surfaces[1].cutoff = 0.2;
  const Report report = roughen(mesh, options, [](const RoughMesh&, Report&) {});
  EXPECT_EQ(report.surfaces[0].field.lattice->lost_variance, 0);
  EXPECT_GT(report.surfaces[1].field.lattice->lost_variance, 0.1);
  EXPECT_EQ(std::count_if(report.warnings.begin(), report.warnings.end(),
                          [](const std::string& text) {
                            return text.starts_with("surface upper: --cutoff 0.2 leaves out");
                          }),
            1);
  const Edges both = displacements(run(mesh, options)[0], 40, 2);
  alone.surfaces = {options.surfaces[1]};
  EXPECT_EQ(displacements(run(mesh, alone)[0], 40, 2).upper, both.upper);
}

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

// It makes no point an image of another.
TEST(PeriodicRun, ALinkIntoTheInteriorIsRefusedWhereItsNodeMoves) {
  Mesh mesh = test::strip(64, 2, 16);
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) surface.fixed.clear();
  const Index on_edge = 5, inside = 65 + 5;
  mesh.periodic_links = {{0, 1, 2, {}, {{inside, on_edge}}}};
  EXPECT_NE(message_of([&] { run(mesh, options); }).find("not on this surface"), std::string::npos);
  mesh.periodic_links.clear();
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

// Along a closed curve a Gaussian of this length is indefinite: its negative eigenvalues are set to
// zero, and Sq must be expected of what is left. The mean over 300 realizations has a standard
// error of sq_expected_std / sqrt(300).
TEST(Report, ExpectsTheSqOfTheFieldThatIsSampled) {
  const Mesh mesh = test::polyline(test::circle_points(test::uneven_angles(60), 1), true);
  RoughenOptions options;
  options.surfaces[0].rms = rq;
  options.surfaces[0].length = {3};
  options.surfaces[0].distance = DistanceKind::curve;
  options.realizations = 300;
  const Report report = roughen(mesh, options, [](const RoughMesh&, Report&) {});
  EXPECT_EQ(report.surfaces[0].field.cholesky->factorization, Factorization::eigenvalue);
  double mean = 0;
  for (const RealizationReport& r : report.realizations) mean += r.surfaces[0].heights.sq / 300;
  const SurfaceStatistics& s = report.realizations[0].surfaces[0];
  EXPECT_NEAR(mean, s.sq_expected, 4 * s.sq_expected_std / std::sqrt(300.0));
}

// A box mask on one side of a period only would tear the images apart.
TEST(PeriodicRun, MasksThatDifferBetweenImagesAreRefused) {
  const Mesh mesh = test::strip(64, 2, 16);
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) {
    surface.fixed.clear();
    surface.mask = {BoxMask{.min = {-1, -2, -1}, .max = {8, 2, 1}, .fade = 1, .outside = false}};
  }
  EXPECT_NE(message_of([&] { run(mesh, options); }).find("its periodic image"), std::string::npos);
  for (Roughness& surface : options.surfaces)
    surface.mask = {BoxMask{.min = {4, -2, -1}, .max = {8, 2, 1}, .fade = 1, .outside = false}};
  EXPECT_EQ(message_of([&] { run(mesh, options); }), "no error");
}

TEST(PeriodicRun, AFixedSideDoesNotExcuseItsImage) {
  Mesh mesh = test::strip(64, 2, 16);
  const Index left_lower = 0, left_upper = 2 * 65;
  mesh.blocks.push_back(test::make_block(test::point_type, 9, {9}, {left_lower, left_upper}, 9001));
  mesh.groups.insert(mesh.groups.begin(), {0, 9, "left"});
  RoughenOptions options = two_edges(2);
  for (Roughness& surface : options.surfaces) {
    surface.fixed = {"left"};
    surface.distance = DistanceKind::euclidean;
  }
  EXPECT_NE(message_of([&] { run(mesh, options); }).find("periodic link"), std::string::npos);
}

// The halves of an edge face each other across the period; in one job they are one field.
TEST(PeriodicRun, ImagesMayBelongToDifferentSurfaces) {
  Mesh mesh = test::strip(64, 2, 16);
  ElementBlock right = mesh.blocks[0];
  right.entity = 8;
  right.physical_groups = {8};
  right.nodes.erase(right.nodes.begin(), right.nodes.begin() + 64);
  right.tags.erase(right.tags.begin(), right.tags.begin() + 32);
  mesh.blocks[0].nodes.resize(64);
  mesh.blocks[0].tags.resize(32);
  mesh.blocks.push_back(right);
  mesh.groups.insert(mesh.groups.begin() + 3, {1, 8, "lower right"});
  RoughenOptions options;
  options.surfaces = {edge("lower", 1), edge("lower right", 1)};
  for (Roughness& surface : options.surfaces) surface.fixed.clear();
  const RoughMesh rough = run(mesh, options).front();
  EXPECT_EQ(rough.displacements[0], rough.displacements[64]);
  EXPECT_GT(rough.displacements[0].norm(), 0);
}

TEST(SeveralSurfaces, WhatOneFixesNoOtherMoves) {
  Mesh mesh = test::strip(64, 2, 16);
  mesh.periodic_links.clear();
  RoughenOptions options = two_edges(2);
  options.surfaces[0].fixed.clear();
  options.surfaces[1].group = {"ends"};
  options.surfaces[1].fixed = {"lower"};
  options.surfaces[1].flip = false;
  const RoughMesh rough = run(mesh, options).front();
  EXPECT_TRUE(rough.displacements[0].isZero(0));
  EXPECT_TRUE(rough.displacements[64].isZero(0));
  EXPECT_FALSE(rough.displacements[1].isZero(0));
}
