// SPDX-License-Identifier: BSD-3-Clause
// What gmsh could crash on never reaches it, and whatever it does, one clear line comes of it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "fill_volumes.hpp"
#include "size_lattice.hpp"
#include "support/errors.hpp"
#include "support/fake_gmsh.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;
using namespace roughmesh::detail;

namespace {

// The inside of an icosphere of radius 1 whose edges are about 0.3.
FillTask ball_task() {
  const Mesh mesh = test::icosphere(2);
  FillTask task;
  task.nodes = mesh.nodes;
  Sheet& sheet = task.sheets.emplace_back();
  for (Index e = 0; e < mesh.blocks[0].size(); ++e) {
    const auto nodes = mesh.blocks[0].element(e);
    sheet.triangles.push_back({nodes[0], nodes[1], nodes[2]});
    sheet.elements.push_back(mesh.blocks[0].tags[e]);
  }
  task.volumes = {{.boundary = {0}}};
  task.sizes = growing_sizes(task.nodes, std::vector<double>(task.nodes.size(), 0.3));
  return task;
}

/// The message of an error of this kind, and nothing else, before gmsh is started.
template <class E>
std::string refusal(const FillTask& task) {
  const test::FakeGmsh gmsh("touch \"$(dirname \"$0\")/started\"; exit 0");
  std::string message = "no error";
  try {
    fill_volumes(task, {gmsh.path(), 60});
  } catch (const E& error) {
    message = error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(gmsh.folder() / "started"));
  EXPECT_EQ(message.find('\n'), message.npos);
  return message;
}

template <class E>
std::string failure(const std::string& script, double timeout = 60) {
  const test::FakeGmsh gmsh(script);
  try {
    fill_volumes(ball_task(), {gmsh.path(), timeout});
  } catch (const E& error) {
    return error.what();
  }
  return "no error";
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

}  // namespace

TEST(FillVolumes, NodesAtOnePlaceAreRefused) {
  FillTask task = ball_task();
  const Index copy = static_cast<Index>(task.nodes.size());
  const Index old = task.sheets[0].triangles[5][0];
  task.nodes.push_back(task.nodes[old]);
  for (auto& t : task.sheets[0].triangles)
    for (Index& node : t)
      if (node == old && &t > &task.sheets[0].triangles[5]) node = copy;
  EXPECT_SAYS(refusal<InputError>(task), "open beside");  // a crack is open first
  FillTask two = ball_task();                             // the ball twice, at one place
  const Index n = static_cast<Index>(two.nodes.size());
  two.nodes.insert(two.nodes.end(), two.nodes.begin(), two.nodes.begin() + n);
  two.sheets.push_back(two.sheets[0]);
  for (auto& t : two.sheets[1].triangles)
    for (Index& node : t) node += n;
  two.volumes.push_back({.boundary = {1}});
  EXPECT_SAYS(refusal<InputError>(two), "two nodes of the surface lie at (");
}

TEST(FillVolumes, ATriangleListedTwiceIsRefused) {
  FillTask task = ball_task();
  const auto [a, b, c] = task.sheets[0].triangles[7];
  task.sheets.push_back({{{b, c, a}}, {99'999}});
  EXPECT_SAYS(refusal<InputError>(task), "triangles 8 and 99999 have the same three nodes");
}

TEST(FillVolumes, CoordinatesThatAreNotFiniteAreRefused) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    FillTask task = ball_task();
    task.nodes[3].y() = bad;
    EXPECT_SAYS(refusal<InputError>(task),
                "has a coordinate that is not finite; lower the heights");
  }
}

TEST(FillVolumes, AnOpenSurfaceIsRefused) {
  FillTask task = ball_task();
  task.sheets[0].triangles.pop_back();
  task.sheets[0].elements.pop_back();
  EXPECT_SAYS(refusal<InputError>(task), "open beside");
}

TEST(FillVolumes, TrianglesThatIntersectAreRefused) {
  FillTask task = ball_task();
  task.nodes[0] = -1.5 * task.nodes[0];
  EXPECT_SAYS(refusal<CheckError>(task), "intersect");
}

TEST(FillVolumes, WhateverGmshDoesOneLineSaysIt) {
  EXPECT_SAYS(failure<NumericalError>("echo 'Error   : HXT 3D mesh failed'; exit 1"),
              "could not fill the volume (exit status 1): HXT 3D mesh failed; try a newer gmsh");
  EXPECT_SAYS(failure<NumericalError>("exit 0"), "could not fill the volume (exit status 0)");
  EXPECT_SAYS(failure<NumericalError>("kill -SEGV $$"),
              "crashed (Segmentation fault); try a newer");
  EXPECT_SAYS(failure<InputError>("sleep 1000", 0.3), "give it more time with --timeout");
  EXPECT_SAYS(failure<NumericalError>("echo nonsense > mesh.msh"), "cannot be read");
  try {
    fill_volumes(ball_task(), {"/nonexistent/gmsh", 60});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/nonexistent/gmsh: not found; install it or give --gmsh PATH");
  }
}

// What comes back is compared with what was asked for: here the surface alone, and a mesh of one
// tetrahedron.
TEST(FillVolumes, AMeshThatDoesNotFitIsRefused) {
  EXPECT_SAYS(failure<NumericalError>("cp surfaces.msh mesh.msh"), "its boundary is another");
  EXPECT_SAYS(
      failure<NumericalError>(
          "printf '$MeshFormat\\n2.2 0 8\\n$EndMeshFormat\\n$Nodes\\n4\\n1 0 0 0\\n2 1 0 0\\n"
          "3 0 1 0\\n4 0 0 1\\n$EndNodes\\n$Elements\\n1\\n1 4 2 1 1 1 2 3 4\\n"
          "$EndElements\\n' > mesh.msh"),
      "moved a node of the surface");
}

TEST(FillVolumes, TheProgramIsLookedForInPath) {
  const test::FakeGmsh gmsh("exit 0");
  EXPECT_TRUE(GmshProgram{gmsh.path()}.exists());
  EXPECT_TRUE(GmshProgram{"sh"}.exists());
  EXPECT_FALSE(GmshProgram{"no-such-program"}.exists());
  EXPECT_FALSE(GmshProgram{gmsh.folder().path().string() + "/other"}.exists());
}

// Sizes are the least of h + growth times distance over all places (docs/math.md, eq. 63); on the
// lattice the distance along its 26 directions is at most 1 / cos of half the angle between them,
// below 13 % too long, and a place is at most a diagonal of a cell away from a lattice point.
TEST(GrowingSizes, GrowWithTheDistance) {
  const std::vector<Vec3> places = {{0, 0, 0}, {32, 0, 0}, {0, 16, 8}};
  const std::vector<double> sizes = {1, 3, 0.5};
  const SizeLattice lattice = growing_sizes(places, sizes);
  for (int i = 0; i < lattice.n[0]; ++i)
    for (int j = 0; j < lattice.n[1]; ++j)
      for (int k = 0; k < lattice.n[2]; ++k) {
        const Vec3 x = lattice.place({i, j, k});
        double exact = 1e9;
        for (std::size_t p = 0; p < places.size(); ++p)
          exact = std::min(exact, sizes[p] + growth * (x - places[p]).norm());
        const double size = lattice.sizes[lattice.number({i, j, k})];
        EXPECT_GT(size, exact - 1e-12);
        EXPECT_LT(size, 1.13 * exact + 1e-12);
      }
}

// Sizes of gradient g at nodes not further than a diagonal of a cell give means that differ by at
// most that times g; points beside these grow by another diagonal.
TEST(MeanSizes, FollowThoseOfTheMesh) {
  std::vector<Vec3> places;
  std::vector<double> sizes;
  const auto size_at = [](const Vec3& x) { return 1 + 0.1 * x.x() + 0.2 * x.y(); };
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 20; ++k) {
        places.emplace_back(i + 0.3 * std::sin(7 * j), j, k + 0.2 * std::cos(5 * i));
        sizes.push_back(size_at(places.back()));
      }
  const SizeLattice lattice = mean_sizes(places, sizes);
  const double diagonal = std::sqrt(3.0) * lattice.spacing;
  for (int i = 0; i < lattice.n[0]; ++i)
    for (int j = 0; j < lattice.n[1]; ++j)
      for (int k = 0; k < lattice.n[2]; ++k)
        EXPECT_NEAR(lattice.sizes[lattice.number({i, j, k})], size_at(lattice.place({i, j, k})),
                    (2 * std::hypot(0.1, 0.2) + growth) * diagonal);
}
