// SPDX-License-Identifier: BSD-3-Clause
// Sharp edges of solids are found and rounded, and wrong solids are refused.
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "roughmesh/cad.hpp"
#include "roughmesh/surface.hpp"

#include "cad_rounding.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

using namespace roughmesh;
using test::message_of;

namespace {

constexpr double pi = std::numbers::pi;

class CadRounding : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_gmsh()) GTEST_SKIP() << "gmsh is not installed";
  }

  std::filesystem::path solid(const std::string& commands) const {
    test::write_bytes(folder_ / "solid.geo", "SetFactory(\"OpenCASCADE\");\n" + commands);
    test::run("cd '" + folder_.path().string() +
              "' && gmsh -0 -v 0 solid.geo -o solid.step > /dev/null 2>&1");
    return folder_ / "solid.step";
  }

  static Mesh rounded(const std::filesystem::path& path, double radius, double size) {
    return mesh_geometry(path, {.mesh_size = size, .round = radius});
  }

  test::TemporaryFolder folder_;
};

double volume_of(const Mesh& mesh) {
  const Surface surface = select_surface(mesh, {.groups = {}});
  return enclosed_volume(surface, surface.points);
}

const std::string cube = "Box(1) = {0, 0, 0, 1, 1, 1};\n";

}  // namespace

// Slabs, quarters of cylinders, eighths of a sphere.
TEST_F(CadRounding, ACubeHasTheVolumeOfARoundedOne) {
  const double r = 0.2, h = 0.05, inner = 1 - 2 * r;
  const double exact = std::pow(inner, 3) + 6 * inner * inner * r + 3 * pi * inner * r * r +
                       4.0 / 3 * pi * r * r * r;
  const Mesh mesh = rounded(solid(cube), r, h);
  // Chords of the fillets leave segments of height h^2 / (8 r) at most, over the area that is
  // curved; size control lets edges be half as long again.
  const double curved = 6 * pi * inner * r + 4 * pi * r * r;
  EXPECT_LT(volume_of(mesh), exact);
  EXPECT_GT(volume_of(mesh), exact - curved * 2.25 * h * h / (8 * r));
  const Surface surface = select_surface(mesh, {.sharp_angle = pi / 4});
  EXPECT_EQ(surface.n_sharp_edges, 0);
}

// A turn by phi costs r^2 (tan(phi/2) - phi/2) a length: of a quarter turn, r^2 (1 - pi/4).
TEST_F(CadRounding, ConvexEdgesTakeAwayAndConcaveOnesAdd) {
  const Mesh block = mesh_geometry(solid(cube), {.mesh_size = 0.3});
  const auto edges = detail::plan_rounding(block, 0.1, pi / 6);
  EXPECT_EQ(edges.curves.size(), 12u);
  EXPECT_NEAR(edges.volume_change, -12 * 0.01 * (1 - pi / 4), 1e-12);
  EXPECT_NEAR(edges.volume_turned, -edges.volume_change, 1e-15);
  const Mesh bracket =
      mesh_geometry(solid(cube + "Box(2) = {0.5, 0.5, 0, 1, 1, 1};\n"
                                 "BooleanDifference{Volume{1}; Delete;}{Volume{2}; Delete;}\n"),
                    {.mesh_size = 0.3});
  const auto bent = detail::plan_rounding(bracket, 0.1, pi / 6);
  EXPECT_EQ(bent.curves.size(), 18u);  // of lengths 6 by 1, 4 by 1/2 twice, 4 by 1
  EXPECT_NEAR(bent.volume_turned, (6 + 2 * 4.0) * 0.01 * (1 - pi / 4), 1e-12);
  EXPECT_NEAR(bent.volume_change, -bent.volume_turned + 2 * 0.01 * (1 - pi / 4), 1e-12);
}

TEST_F(CadRounding, SmoothEdgesAreNone) {
  const Mesh ball = mesh_geometry(solid("Sphere(1) = {0, 0, 0, 1};\n"), {.mesh_size = 0.2});
  EXPECT_TRUE(detail::plan_rounding(ball, 0.1, 2 * pi / 9).curves.empty());
  const auto path = folder_ / "solid.step";
  EXPECT_NE(message_of([&] { rounded(path, 0.1, 0.2); }).find("has no sharp edge to round"),
            std::string::npos);
}

// Two solids that do not touch keep their names.
TEST_F(CadRounding, PartsKeepTheirNames) {
  const auto path = solid(cube + "Box(2) = {2, 0, 0, 1, 1, 1};\n");
  const Mesh mesh = rounded(path, 0.1, 0.2);
  const Mesh sharp = mesh_geometry(path, {.mesh_size = 0.2});
  const auto of_volumes = [](const Mesh& m) {
    return std::count_if(m.groups.begin(), m.groups.end(),
                         [](const PhysicalGroup& group) { return group.dimension == 3; });
  };
  EXPECT_EQ(of_volumes(mesh), of_volumes(sharp));
  ASSERT_GT(of_volumes(sharp), 0);  // gmsh labels the solids that it exports
  for (const ElementBlock& block : mesh.blocks)
    EXPECT_EQ(block.physical_groups.size(), dimension(block.type.shape) == 3 ? 1u : 0u);
  EXPECT_LT(volume_of(mesh), 2 - 0.1 * 24 * 0.01 * (1 - pi / 4));
}

TEST_F(CadRounding, WhatCannotBeRoundedIsOneLine) {
  const auto path = solid(cube);
  EXPECT_EQ(message_of([&] { rounded(path, 0.5, 0.2); }),
            path.string() +
                ": gmsh could not round its 12 sharp edges with a radius of 0.5; use a "
                "smaller --round");
  // Here gmsh itself finds nothing wrong, and returns a body that has grown.
  EXPECT_NE(message_of([&] { rounded(path, 0.6, 0.2); }).find("gave a wrong solid"),
            std::string::npos);
  EXPECT_NE(message_of([&] { rounded(path, -1, 0.2); }).find("--round must be above 0"),
            std::string::npos);
  const auto touching = solid(cube + "Box(2) = {1, 0, 0, 1, 1, 1};\n");
  EXPECT_NE(message_of([&] { rounded(touching, 0.1, 0.2); }).find("do not touch each other"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              rounded(folder_ / "solid.geo", 0.1, 0.2);
            }).find("use Fillet in the script"),
            std::string::npos);
}

// Fillets of a too large radius may succeed and leave a solid that has grown.
TEST(Rounding, VolumesMustChangeAsTheEdgesTell) {
  const detail::Rounding convex{
      .curves = {}, .radius = 0.1, .volume_change = -0.1, .volume_turned = 0.1};
  EXPECT_TRUE(detail::is_plausible(convex, 1, 0.9));
  EXPECT_TRUE(detail::is_plausible(convex, 1, 0.94));
  EXPECT_FALSE(detail::is_plausible(convex, 1, 1.1));   // wrong sign
  EXPECT_FALSE(detail::is_plausible(convex, 1, 1));     // nothing was done
  EXPECT_FALSE(detail::is_plausible(convex, 1, 0.7));   // a part is lost
  EXPECT_FALSE(detail::is_plausible(convex, 1, -0.9));  // inside out
  EXPECT_FALSE(detail::is_plausible(convex, 1, std::nan("")));
  const detail::Rounding both{
      .curves = {}, .radius = 0.1, .volume_change = 0, .volume_turned = 0.2};
  EXPECT_TRUE(detail::is_plausible(both, 1, 1.05));
  EXPECT_FALSE(detail::is_plausible(both, 1, 1.15));
}

// A gmsh that says so, and one that crashes while it rounds.
TEST_F(CadRounding, AWrongSolidAndACrashAreRefused) {
  const auto path = solid(cube);
  const auto program = folder_ / "gmsh";
  const auto message = [&](const std::string& behaviour) {
    test::write_bytes(program, "#!/bin/sh\nif grep -q Fillet driver.geo; then " + behaviour +
                                   "; fi\nexec /usr/bin/env gmsh \"$@\"\n");
    chmod(program.c_str(), 0700);
    return message_of(
        [&] { mesh_geometry(path, {.mesh_size = 0.2, .gmsh = program.string(), .round = 0.1}); });
  };
  EXPECT_NE(message("echo 'roughmesh rounded: 1 1.02'; exit 0").find("gave a wrong solid"),
            std::string::npos);
  EXPECT_THROW(message("kill -SEGV $$"), NumericalError);
}
