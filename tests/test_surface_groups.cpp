// SPDX-License-Identifier: BSD-3-Clause
// Which faces a choice of groups selects.
#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/surface.hpp"

#include "support/cells.hpp"
#include "support/meshes.hpp"
#include "support/same_surface.hpp"

using namespace roughmesh;

TEST(SurfaceGroups, ByNameByNumberAndOnce) {
  const Mesh mesh = test::ball_in_box(4);
  const Surface by_name = select_surface(mesh, {.groups = {"surface"}});
  test::expect_same_surface(by_name, select_surface(mesh, {.groups = {"1"}}));
  test::expect_same_surface(by_name, select_surface(mesh, {.groups = {"1", "surface", "1"}}));
  EXPECT_EQ(by_name.groups, std::vector<std::string>{"surface"});
  EXPECT_EQ(by_name.n_faces(), 12 * 4);
  const Surface both = select_surface(mesh, {.groups = {"outer", "1"}});
  EXPECT_EQ(both.n_faces(), 12 * 4 + 12 * 16);
  EXPECT_EQ(both.groups, (std::vector<std::string>{"outer", "surface"}));
  EXPECT_EQ(both.n_duplicate_faces, 0);
}

TEST(SurfaceGroups, ANameGoesBeforeANumber) {
  Mesh mesh = test::ball_in_box(4);
  mesh.groups[1].name = "1";  // group 2 is called 1
  EXPECT_EQ(select_surface(mesh, {.groups = {"1"}}).n_faces(), 12 * 16);
}

TEST(SurfaceGroups, AllMeansEveryElementOfDimension2) {
  const Mesh mesh = test::ball_in_box(4);
  const Surface all = select_surface(mesh, {.groups = {"all"}});
  EXPECT_EQ(all.n_faces(), 12 * 4 + 12 * 16);
  EXPECT_EQ(all.n_components, 2);
  const Surface derived = select_surface(test::without_faces(mesh), {.groups = {"all"}});
  EXPECT_EQ(derived.n_faces(), 12 * 16);
}

TEST(SurfaceGroups, WithoutAChoice) {
  Mesh mesh = test::ball_in_box(4);
  const Surface box = select_surface(mesh, {.groups = {"outer"}});
  const Surface derived = select_surface(test::without_faces(mesh));
  test::expect_same_surface(box, derived);  // the boundary of the volume is the box
  EXPECT_EQ(derived.groups, std::vector<std::string>{"boundary"});
  EXPECT_EQ(std::set<Tag>(derived.face_tags.begin(), derived.face_tags.end()), std::set<Tag>{0});

  std::erase_if(mesh.blocks, [](const ElementBlock& b) {
    return b.physical_groups == std::vector<Tag>{2} && b.type == test::triangle_type;
  });
  EXPECT_EQ(select_surface(mesh).groups, std::vector<std::string>{"surface"});

  Mesh bare = test::plate(2);
  bare.groups.clear();
  bare.blocks[0].physical_groups.clear();
  EXPECT_EQ(select_surface(bare).n_faces(), 8);
}

TEST(SurfaceGroups, ErrorsNameTheGroupAndTheChoice) {
  Mesh mesh = test::ball_in_box(4);
  mesh.groups.push_back({2, 9, "empty"});
  const auto message = [&](std::vector<std::string> groups) -> std::string {
    try {
      select_surface(mesh, {.groups = std::move(groups)});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string choice = "surface groups: surface (1), outer (2)";
  EXPECT_EQ(message({"gold"}), "there is no physical group 'gold'; " + choice);
  EXPECT_EQ(message({"surface", "7"}), "there is no physical group '7'; " + choice);
  EXPECT_EQ(message({""}), "there is no physical group ''; " + choice);
  EXPECT_EQ(message({"99999999999999999999"}),
            "there is no physical group '99999999999999999999'; " + choice);
  EXPECT_EQ(message({"inside"}), "physical group 'inside' has dimension 3, not 2; " + choice);
  EXPECT_EQ(message({"empty"}), "physical group 'empty' has no element; " + choice);
  EXPECT_EQ(
      message({}),
      "several groups could become rough; choose with --group, more than once or `all`; " + choice);
}

TEST(SurfaceGroups, ALongListIsCutShort) {
  Mesh mesh = test::plate(4);
  const ElementBlock block = mesh.blocks[0];
  mesh.groups.clear();
  mesh.blocks.clear();
  for (Tag group = 1; group <= 13; ++group) {
    mesh.groups.push_back({2, group, ""});
    mesh.blocks.push_back(block);
    mesh.blocks.back().physical_groups = {group};
  }
  try {
    select_surface(mesh);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("9, 10 and 3 more"), std::string::npos);
  }
}

TEST(SurfaceGroups, WhatIsNotASurfaceOfFirstOrSecondOrderIsRefused) {
  EXPECT_THROW(select_surface(Mesh{}), InputError);
  Mesh points = test::plate(1);
  points.blocks = {test::make_block({ElementShape::point, 1, 1}, 1, {}, {0, 1}, 1)};
  EXPECT_THROW(select_surface(points), InputError);
  Mesh curved = test::plate(1);
  curved.nodes.resize(10, Vec3::Zero());
  curved.blocks = {test::make_block({ElementShape::triangle, 3, 10}, 1, {1},
                                    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, 17)};
  test::number_nodes(curved);
  try {
    select_surface(curved);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 17 is a triangle of order 3"),
              std::string::npos);
    EXPECT_NE(std::string(error.what()).find("-order 1 or -order 2"), std::string::npos);
  }
}
