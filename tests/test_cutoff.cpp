// SPDX-License-Identifier: BSD-3-Clause
// The pipeline over the method `lattice`: heights that belong to places, what a cutoff leaves, and
// directions of lengths.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/pipeline.hpp"

#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/planar.hpp"

using namespace roughmesh;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Result {
  std::vector<std::vector<double>> heights;  ///< at the nodes, of each realization
  Report report;

  const LatticeSummary& lattice() const { return *report.surfaces[0].field.lattice; }
};

Result run(const Mesh& mesh, const RoughenOptions& options) {
  Result result;
  result.report = roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
    result.heights.push_back(rough.heights);
  });
  return result;
}

RoughenOptions options_for(const Roughness& surface) {
  RoughenOptions options{.surfaces = {surface}};
  options.surfaces[0].rms = 0.01;
  options.allow_invalid = true;
  return options;
}

/// Of the numbers that both have, the first ones.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

const Roughness exponential{.length = {0.4}, .acf = Family::exponential};

Roughness with_cutoff(Roughness surface, double cutoff) {
  surface.cutoff = cutoff;
  return surface;
}

}  // namespace

// The nodes of an icosphere are the first ones of its refinement. Other heights differ by about Rq
// somewhere; equal ones are the same sums.
TEST(Cutoff, MeshesOfABodyGetTheSameHeightsAtTheSamePlaces) {
  const Mesh coarse = test::icosphere(3), fine = test::icosphere(4);
  ASSERT_EQ(std::vector(fine.nodes.begin(), fine.nodes.begin() + coarse.n_nodes()), coarse.nodes);
  const auto difference = [&](const Roughness& surface, Method method, bool promised) {
    RoughenOptions options = options_for(surface);
    options.method = method;
    const Result a = run(coarse, options), b = run(fine, options);
    for (const Result* result : {&a, &b}) {
      const FieldSummary& field = result->report.surfaces[0].field;
      EXPECT_EQ(field.lattice && field.lattice->same_on_other_meshes, promised);
    }
    return largest_difference(a.heights[0], b.heights[0]) / options.surfaces[0].rms;
  };
  EXPECT_LE(difference({.length = {0.4}}, Method::automatic, true), 1e-12);
  EXPECT_LE(difference(with_cutoff(exponential, 0.1), Method::automatic, true), 1e-12);
  EXPECT_LE(difference(with_cutoff(exponential, 0.1), Method::lattice, true), 1e-12);
  EXPECT_GT(difference(exponential, Method::automatic, false), 0.1);
  EXPECT_GT(difference({.length = {0.4}}, Method::cholesky, false), 0.1);
}

// Seed, cutoff and tolerance are part of what makes a height.
TEST(Cutoff, OtherOptionsGiveOtherHeights) {
  const Mesh sphere = test::icosphere(2);
  const RoughenOptions options = options_for(with_cutoff(exponential, 0.1));
  const auto difference = [&](const auto& change) {
    RoughenOptions other = options;
    change(other);
    return largest_difference(run(sphere, options).heights[0], run(sphere, other).heights[0]);
  };
  EXPECT_EQ(difference([](auto&) {}), 0);
  EXPECT_GT(difference([](auto& o) { o.surfaces[0].seed = 1; }), 1e-3);
  EXPECT_GT(difference([](auto& o) { o.surfaces[0].cutoff = 0.2; }), 1e-4);
  EXPECT_GT(difference([](auto& o) { o.tolerance = 1e-2; }), 1e-6);
}

// The scale of the Gaussians of an exponential is l |w| with w normal, so that those below the
// cutoff c hold erf(c / (sqrt 2 l)) of the variance, up to half the step of the ladder, at most
// 2, on either side.
TEST(Cutoff, LosesTheVarianceBelowIt) {
  const Mesh sphere = test::icosphere(3);
  for (const double cutoff : {0.01, 0.04, 0.1}) {
    const Result result = run(sphere, options_for(with_cutoff(exponential, cutoff)));
    const double l = exponential.length[0], lost = result.lattice().lost_variance;
    EXPECT_GE(lost, std::erf(cutoff / 2 / l));
    EXPECT_LE(lost, std::erf(cutoff / l));
    double kept = 0;
    for (const GaussianTerm& term : result.lattice().terms) {
      kept += term.weight;
      EXPECT_GE(term.scale, cutoff / std::numbers::sqrt2);
    }
    EXPECT_NEAR(kept + lost, 1, 1e-12);
    EXPECT_LE(result.report.surfaces[0].audit.covariance_error, result.report.request.tolerance);
  }
}

// Mean of Sq over 400 independent realizations: five standard errors, below 2 % of Rq. The fifth of
// the variance and more that this cutoff loses would make 10 %.
TEST(Cutoff, SqIsThatOfWhatIsLeft) {
  RoughenOptions options =
      options_for(with_cutoff({.length = {0.2}, .acf = Family::exponential}, 0.06));
  options.realizations = 400;
  const Result result = run(test::icosphere(3), options);
  ASSERT_GT(result.lattice().lost_variance, 0.2);
  double sum = 0;
  for (const RealizationReport& r : result.report.realizations) sum += r.surfaces[0].heights.sq;
  const SurfaceStatistics& s = result.report.realizations[0].surfaces[0];
  const double error = s.sq_expected_std / std::sqrt(400.0);
  EXPECT_LT(5 * error, 0.02 * options.surfaces[0].rms);
  EXPECT_NEAR(sum / 400, s.sq_expected, 5 * error);
}

TEST(Cutoff, WarnsOfMoreThanOnePercentWithANumberThatHelps) {
  const Mesh sphere = test::icosphere(3);
  const auto warning = [&](const Roughness& surface, double* lost) {
    const Result result = run(sphere, options_for(surface));
    *lost = result.lattice().lost_variance;
    for (const std::string& text : result.report.warnings)
      if (text.find("--cutoff") != std::string::npos) return text;
    return std::string();
  };
  double lost = 0;
  const std::string text = warning(with_cutoff(exponential, 0.1), &lost);
  ASSERT_GT(lost, 0.1);
  for (const std::string& part : {fmt::format("{:.3g} %", 100 * lost),
                                  fmt::format("Rq is {:.4g} ", 0.01 * std::sqrt(1 - lost)),
                                  fmt::format("--rms {:.4g} ", 0.01 / std::sqrt(1 - lost))})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(warning(with_cutoff({.length = {0.4}, .acf = Family::matern, .nu = 2.5}, 0.1), &lost),
            "");
  EXPECT_GT(lost, 0);
  EXPECT_EQ(warning(exponential, &lost), "");
}

TEST(Cutoff, ThatLeavesNothingIsRefused) {
  for (const Roughness& surface :
       {with_cutoff(exponential, 1e6), with_cutoff({.length = {0.4}}, 0.41),
        with_cutoff({.length = {0.4}, .acf = Family::stretched, .power = 2}, 0.4)}) {
    const std::string message =
        test::message_of([&] { run(test::icosphere(1), options_for(surface)); });
    EXPECT_TRUE(message.starts_with("--cutoff")) << message;
  }
}

TEST(Cutoff, BelowTheOnlyScaleLosesNothing) {
  const Result result = run(test::icosphere(2), options_for(with_cutoff({.length = {0.4}}, 0.39)));
  EXPECT_EQ(result.lattice().lost_variance, 0);
  EXPECT_TRUE(result.lattice().same_on_other_meshes);
}

TEST(Cutoff, ReportTellsWhatItLeaves) {
  const Result result = run(test::icosphere(2), options_for(with_cutoff(exponential, 0.1)));
  const auto json = nlohmann::json::parse(to_json(result.report));
  const auto& field = json["field"];
  EXPECT_EQ(field["method"], "lattice");
  EXPECT_EQ(field["tolerance"], 1e-4);
  EXPECT_EQ(field["lost_variance"], result.lattice().lost_variance);
  EXPECT_EQ(field["nugget"], 0);
  EXPECT_EQ(field["same_on_other_meshes"], true);
  ASSERT_EQ(field["terms"].size(), result.lattice().terms.size());
  EXPECT_EQ(field["terms"][0]["scale"], result.lattice().terms[0].scale);
  EXPECT_EQ(field["terms"][0]["weight"], result.lattice().terms[0].weight);
  EXPECT_FALSE(field.contains("rank"));
  EXPECT_EQ(json["request"]["cutoff"], 0.1);
  EXPECT_EQ(json["request"]["method"], "auto");
}

// Lines of a planar mesh are sampled in the plane, everything else in space: the heights are those
// of the sampler that is told so.
TEST(Cutoff, LinesOfAPlaneAreSampledInTwoDimensions) {
  const auto from_sampler = [](const Mesh& mesh, int dimension) {
    const Surface surface = select_surface(mesh);
    const Correlation correlation(surface.points, Autocorrelation({.length = 0.4}),
                                  Distance::euclidean());
    std::vector<double> of_points =
        FieldSampler(correlation, {.dimension = dimension}).heights(0, 0);
    std::vector<double> result(mesh.nodes.size());
    for (std::size_t i = 0; i < surface.nodes.size(); ++i)
      result[surface.nodes[i]] = 0.01 * of_points[surface.point_of_node[i]];
    return result;
  };
  const Mesh line = test::polyline(test::circle_points(test::uneven_angles(40), 1), true);
  const Mesh plate = test::plate(6);
  Mesh upright = line;
  for (Vec3& x : upright.nodes) x = {x.x(), 2, x.y()};
  for (const auto& [mesh, dimension] : {std::pair{&line, 2}, {&plate, 3}, {&upright, 3}}) {
    const std::vector<double> heights = run(*mesh, options_for({.length = {0.4}})).heights[0];
    EXPECT_LE(largest_difference(heights, from_sampler(*mesh, dimension)), 1e-14);
    if (mesh == &upright) continue;  // which has no place in a plane z = const
    EXPECT_GT(largest_difference(heights, from_sampler(*mesh, 5 - dimension)), 1e-3);
  }
}

// Streaks: along a direction of infinite length heights are equal, to the rounding of its
// coordinates; across it they are not.
TEST(Directions, HeightsDoNotChangeAlongStreaks) {
  const int n = 16;
  const Mesh plate = test::plate(n);
  const double s = std::numbers::sqrt2 / 2;
  for (const Method method : {Method::lattice, Method::cholesky})
    for (const bool is_diagonal : {false, true}) {
      Roughness surface{.length = {infinity, 0.1, 0.1}, .acf = Family::exponential};
      if (is_diagonal) surface.axes = {Vec3(s, s, 0), Vec3(-1, 1, 0)};
      RoughenOptions options = options_for(surface);
      options.method = method;
      const std::vector<double> heights = run(plate, options).heights[0];
      double along = 0, across = 0;
      for (std::size_t a = 0; a < heights.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
          const Vec3 d = plate.nodes[a] - plate.nodes[b];
          const double offset = is_diagonal ? s * (d.y() - d.x()) : d.y();
          double& largest = std::abs(offset) < 1e-9 ? along : across;
          largest = std::max(largest, std::abs(heights[a] - heights[b]) / 0.01);
        }
      EXPECT_LE(along, 1e-6) << name(method) << is_diagonal;
      EXPECT_GT(across, 0.5) << name(method) << is_diagonal;
    }
}

// Turned about z by axes or by an angle: one field. The order of the axes is that of the lengths.
TEST(Directions, AxesTurnAsAnglesDoAndOrderLengths) {
  Mesh sphere = test::icosphere(2);
  for (Vec3& x : sphere.nodes) x.x() *= 2;  // no symmetry hides an order
  const double turn = 0.3;
  Roughness by_angle{.length = {1, 0.2, 0.4}, .angle = turn * 180 / std::numbers::pi};
  Roughness by_axes{.length = {1, 0.2, 0.4}};
  by_axes.axes = {Vec3(std::cos(turn), std::sin(turn), 0),
                  Vec3(-std::sin(turn), std::cos(turn), 0)};
  const auto heights = [&](const Roughness& surface) {
    return run(sphere, options_for(surface)).heights[0];
  };
  EXPECT_LE(largest_difference(heights(by_angle), heights(by_axes)), 1e-12);
  // What lies along which axis shows in the slopes on a plate.
  const Mesh plate = test::plate(8);
  Roughness reordered{.length = {0.4, 1, 0.2}};
  reordered.axes = {Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()};
  const auto slopes = [&](const Roughness& surface) {
    return run(plate, options_for(surface)).report.surfaces[0].resolution.rms_slope;
  };
  EXPECT_NEAR(slopes(reordered), slopes({.length = {1, 0.2, 0.4}}), 1e-12);
  reordered.axes = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  EXPECT_GT(std::abs(slopes(reordered) - slopes({.length = {1, 0.2, 0.4}})), 1e-3);
}

// A report is a job: directions and cutoff come back as they were.
TEST(Directions, AReportKeepsThem) {
  const Mesh sphere = test::icosphere(1);
  Roughness surface{.length = {infinity, 0.3, 0.2}, .acf = Family::exponential, .cutoff = 0.1};
  surface.axes = {Vec3(1, 2, 3), Vec3(3, 0, -1)};
  const Result first = run(sphere, options_for(surface));
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "report.json", to_json(first.report));
  RoughenOptions again = read_job(folder / "report.json");
  EXPECT_EQ(again.surfaces[0].axes, surface.axes);
  EXPECT_EQ(run(sphere, again).heights, first.heights);
}
