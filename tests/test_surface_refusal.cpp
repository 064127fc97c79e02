// SPDX-License-Identifier: BSD-3-Clause
// What a run says and does where its surface meets itself.
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/pipeline.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

// Two plates with edges of 1/20, this far from each other: twice the length, so that they have
// little in common.
Mesh two_plates(double distance) {
  Mesh mesh = test::plate(20);
  const Mesh upper = test::plate(20);
  const Index n = mesh.n_nodes();
  for (const Vec3& x : upper.nodes) mesh.nodes.push_back(x + Vec3(0, 0, distance));
  ElementBlock block = upper.blocks[0];
  for (Index& node : block.nodes) node += n;
  for (Tag& tag : block.tags) tag += 5000;
  mesh.blocks.push_back(std::move(block));
  test::number_nodes(mesh);
  return mesh;
}

RoughenOptions options_of(double rms) {
  RoughenOptions options;
  options.surfaces[0].group = {"all"};
  options.surfaces[0].rms = rms;
  options.surfaces[0].length = {0.06};
  return options;
}

struct Result {
  std::string error;
  std::vector<RoughMesh> meshes;
  Report report;
};

Result run(const Mesh& mesh, const RoughenOptions& options) {
  Result result;
  try {
    result.report = roughen(
        mesh, options, [&](const RoughMesh& rough, Report&) { result.meshes.push_back(rough); });
  } catch (const CheckError& error) {
    result.error = error.what();
  }
  return result;
}

bool warns(const Report& report, const std::string& part) {
  for (const std::string& warning : report.warnings)
    if (warning.find(part) != warning.npos) return true;
  return false;
}

}  // namespace

TEST(SurfaceRefusal, OneLineWithPlaceElementsHeightAndARemedyThatHelps) {
  const Mesh mesh = two_plates(0.12);
  const Result refused = run(mesh, options_of(0.05));
  EXPECT_TRUE(refused.meshes.empty());
  EXPECT_EQ(refused.error.find('\n'), std::string::npos);
  std::smatch match;
  const std::regex pattern(
      R"(^realization 0: the rough surface has \d+ pairs of faces that intersect(?:, [^;]*)?; the worst: )"
      R"(triangle \d+ intersects triangle 5\d\d\d at \(.*\), where nodes moved by 0\.\d+; )"
      R"(lower --rms to about (0\.\d+) \(estimated\) or .*--allow-invalid writes it all the same$)");
  ASSERT_TRUE(std::regex_match(refused.error, match, pattern)) << refused.error;
  const double lower = std::stod(match[1]);
  EXPECT_LT(lower, 0.05);
  const Result passed = run(mesh, options_of(lower));
  EXPECT_EQ(passed.error, "");
  EXPECT_EQ(passed.report.realizations.at(0).self_intersections, 0);
}

TEST(SurfaceRefusal, AllowInvalidWritesAndCounts) {
  const Mesh mesh = two_plates(0.12);
  RoughenOptions options = options_of(0.05);
  options.allow_invalid = true;
  options.realizations = 2;
  const Result result = run(mesh, options);
  ASSERT_EQ(result.meshes.size(), 2U);
  EXPECT_TRUE(warns(result.report, "written because of --allow-invalid"));
  const auto json = nlohmann::json::parse(to_json(result.report));
  for (std::size_t k = 0; k < 2; ++k) {
    const RoughMesh& rough = result.meshes[k];
    EXPECT_GT(rough.surface_check.self_intersections, 0);
    EXPECT_EQ(json["realizations"][k]["self_intersections"],
              rough.surface_check.self_intersections);
    EXPECT_EQ(check_surface(mesh, std::vector{select_surface(mesh, {.groups = {"all"}})},
                            rough.mesh.nodes)
                  .self_intersections,
              rough.surface_check.self_intersections);
  }
}

TEST(SurfaceRefusal, ThinWallsAreWarnedOfBeforeTheyClose) {
  EXPECT_TRUE(warns(run(two_plates(0.12), options_of(0.02)).report, "the gap at"));
  const Report wide = run(two_plates(0.12), options_of(0.001)).report;
  EXPECT_FALSE(warns(wide, "the gap at"));
  EXPECT_FALSE(warns(wide, "the wall at"));
}

TEST(SurfaceRefusal, IntersectionsOfTheInputAreAWarning) {
  Mesh mesh = two_plates(0);
  for (std::size_t i = 441; i < mesh.nodes.size(); ++i)
    mesh.nodes[i] = Vec3(mesh.nodes[i].x(), 0.513, mesh.nodes[i].y() - 0.517);
  RoughenOptions options = options_of(1e-9);
  const Result result = run(mesh, options);
  EXPECT_EQ(result.error, "");
  EXPECT_TRUE(warns(result.report, "pairs of faces intersect or touch in the input already"));
  EXPECT_EQ(result.report.realizations.at(0).self_intersections, 0);
}
