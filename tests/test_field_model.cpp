// SPDX-License-Identifier: BSD-3-Clause
// A surface and its field are the same for those who only look and for a run.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "roughmesh/pipeline.hpp"

#include "support/errors.hpp"
#include "support/planar.hpp"

using namespace roughmesh;

namespace {

constexpr double length = 16;

/// A strip whose edges are waves that rise through the periodic sides.
Mesh wavy_strip() {
  Mesh mesh = test::strip(64, 2, length);
  for (Vec3& x : mesh.nodes) x.y() += 0.5 * std::sin(2 * std::numbers::pi * x.x() / length);
  return mesh;
}

Roughness lower_edge() {
  Roughness request;
  request.group = {"lower"};
  request.rms = 0.02;
  request.length = {1.0};
  return request;
}

SurfaceModel model_of(const Mesh& mesh, const Roughness& request) {
  return surface_model(mesh, select_surface(mesh, surface_options(request)), request);
}

/// Points at both ends of the edge.
std::pair<Index, Index> ends(const Surface& surface) {
  const auto [left, right] =
      std::minmax_element(surface.points.begin(), surface.points.end(),
                          [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
  return {static_cast<Index>(left - surface.points.begin()),
          static_cast<Index>(right - surface.points.begin())};
}

}  // namespace

TEST(SurfaceModels, TakeDistancePeriodAndNormalsOfTheLinks) {
  const Mesh mesh = wavy_strip();
  for (const std::optional<DistanceKind> distance :
       {std::optional<DistanceKind>(), std::optional(DistanceKind::periodic),
        std::optional(DistanceKind::minimum_image)}) {
    Roughness request = lower_edge();
    request.distance = distance;
    const SurfaceModel model = model_of(mesh, request);
    EXPECT_EQ(model.request.distance, distance.value_or(DistanceKind::periodic));
    EXPECT_EQ(model.request.period, (std::vector<double>{length, 0, 0}));
    EXPECT_EQ(model.refusal, "");
    const auto [left, right] = ends(model.surface);
    EXPECT_NEAR(model.correlation(left, right), 1, 1e-12);
    EXPECT_EQ(model.surface.normals[left], model.surface.normals[right]);
  }
}

TEST(SurfaceModels, AreThoseOfARun) {
  const Mesh mesh = wavy_strip();
  RoughenOptions options;
  options.surfaces = {lower_edge()};
  options.volume = VolumeChoice::none;
  const Report report = roughen(mesh, options, [](const RoughMesh&, Report&) {});
  const SurfaceModel model = model_of(mesh, lower_edge());
  const Resolution ours = assess_resolution(model.surface, model.correlation);
  const Resolution& of_run = report.surfaces[0].resolution;
  EXPECT_EQ(ours.rms_slope, of_run.rms_slope);
  EXPECT_EQ(ours.min_curvature_radius, of_run.min_curvature_radius);
  EXPECT_EQ(ours.largest_safe_rq, of_run.largest_safe_rq);
  EXPECT_EQ(model.request.distance, report.request.surfaces[0].distance);
  EXPECT_EQ(model.request.period, report.request.surfaces[0].period);
}

// Who only looks is told what a run would refuse.
TEST(SurfaceModels, TellOfLinksThatARunWouldTear) {
  const Mesh mesh = wavy_strip();
  Roughness request = lower_edge();
  request.distance = DistanceKind::euclidean;
  const SurfaceModel model = model_of(mesh, request);
  EXPECT_NE(model.refusal.find("--distance periodic"), std::string::npos) << model.refusal;
  const auto [left, right] = ends(model.surface);
  EXPECT_LT(model.correlation(left, right), 1e-12);
  request.distance = DistanceKind::periodic;
  request.period = {3, 0, 0};
  EXPECT_NE(test::message_of([&] { model_of(mesh, request); }).find("--period is 3"),
            std::string::npos);
}
