// SPDX-License-Identifier: BSD-3-Clause
// The check of a moved surface: what meets itself, turns over, collapses or closes.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"

#include "parallel.hpp"
#include "self_intersection.hpp"
#include "support/cells.hpp"
#include "support/contact.hpp"
#include "support/errors.hpp"
#include "support/folded_plate.hpp"
#include "support/meshes.hpp"
#include "support/moved_surfaces.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "support/second_order.hpp"
#include "surface_motion.hpp"

using namespace roughmesh;
using namespace roughmesh::test;

namespace {

struct Pairs {
  std::vector<detail::FacePair> found, all;
};

// Found by the hierarchy, and by trying every pair of faces with a node that moved.
Pairs pairs_of(const Mesh& mesh, const std::vector<Vec3>& moved) {
  const Surface surface = all_of(mesh);
  const detail::FacesAtRest rest{detail::collect_faces(mesh, surface.dimension),
                                 surface.plane_normal, 2};
  const detail::SurfaceMotion motion = detail::move_faces(rest, moved);
  const auto now = motion.in_place();
  const detail::FoundPairs found =
      detail::find_intersections(rest.in_place(), now, motion.has_moved);
  Pairs pairs;
  std::merge(found.pairs.begin(), found.pairs.end(), found.in_input.begin(), found.in_input.end(),
             std::back_inserter(pairs.found));
  const auto has_moved = [&](Index face) {
    const auto points = rest.faces.face(face);
    return std::any_of(points.begin(), points.end(), [&](Index p) { return motion.has_moved[p]; });
  };
  const auto n = static_cast<Index>(rest.faces.corners.size());
  for (Index a = 0; a < n; ++a)
    for (Index b = a + 1; b < n; ++b)
      if ((has_moved(a) || has_moved(b)) && now.intersect(a, b)) pairs.all.push_back({a, b});
  return pairs;
}

// What must not depend on numbers and order in the file, as findings by their elements.
void expect_same_findings(const SurfaceCheck& a, const SurfaceCheck& b, const Vec3& shift) {
  EXPECT_EQ(a.self_intersections, b.self_intersections);
  EXPECT_EQ(a.input_intersections, b.input_intersections);
  EXPECT_EQ(a.folded_faces, b.folded_faces);
  EXPECT_EQ(a.closed_walls, b.closed_walls);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  for (std::size_t i = 0; i < a.findings.size(); ++i) {
    EXPECT_EQ(a.findings[i].elements, b.findings[i].elements);
    EXPECT_EQ(a.findings[i].passing_share, b.findings[i].passing_share);
    EXPECT_NEAR((a.findings[i].place + shift - b.findings[i].place).norm(), 0, 1e-12);
  }
}

}  // namespace

// Triangles, quadrangles, elements of order 2, sides without elements, curves; jitter of every
// size.
TEST(SurfaceCheck, FindsThePairsThatBruteForceFinds) {
  const auto second_order = [](Mesh mesh) { return test::second_order(std::move(mesh), false); };
  const Vec3 in_plane(1, 1, 0);
  const std::vector<std::pair<Mesh, Vec3>> cases = {
      {test::icosphere(2), Vec3::Ones()},
      {test::shuffled(test::ball_in_box(4), 3), Vec3::Ones()},
      {test::cell_box(ElementShape::hexahedron, 4), Vec3::Ones()},
      {test::without_faces(test::cell_box(ElementShape::prism, 4)), Vec3::Ones()},
      {second_order(test::icosphere(1)), Vec3::Ones()},
      {second_order(test::cell_box(ElementShape::hexahedron, 2)), Vec3::Ones()},
      {test::ring(48), in_plane},
      {test::strip(40, 4, 4.0, 0.2), in_plane}};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const auto& [mesh, along] = cases[c];
    EXPECT_TRUE(pairs_of(mesh, mesh.nodes).all.empty());
    std::size_t n_found = 0;
    for (const double size : {0.02, 0.1, 0.3, 0.6}) {
      const Pairs pairs = pairs_of(mesh, jittered(mesh.nodes, size, 5, along));
      EXPECT_EQ(pairs.found, pairs.all) << "case " << c << ", jitter " << size;
      n_found += pairs.all.size();
    }
    EXPECT_GT(n_found, 20U) << "case " << c;
  }
}

// Every ray from the centre meets it once.
TEST(SurfaceCheck, AStarShapedSurfaceNeverMeetsItself) {
  std::mt19937 random(1);
  for (const Mesh& mesh : {test::icosphere(3), test::ring(64)}) {
    std::uniform_real_distribution<double> factor(0.7, 1.6);
    std::vector<Vec3> moved = mesh.nodes;
    if (dimension(mesh) == 2 && n_elements(mesh, 1) > 0) {
      for (const Index node : select_surface(mesh, {.groups = {"rim"}}).nodes)
        moved[node] *= factor(random);
      EXPECT_EQ(check(mesh, "rim", moved).self_intersections, 0);
    } else {
      for (Vec3& x : moved) x *= factor(random);
      EXPECT_EQ(check(mesh, moved).self_intersections, 0);
    }
  }
}

TEST(SurfaceCheck, HeightsOverAPlaneNeverMeetAndNeverFold) {
  const Mesh mesh = test::plate(20);
  const SurfaceCheck result = check(mesh, jittered(mesh.nodes, 7, 2, {0, 0, 1}));
  EXPECT_TRUE(result.valid());
  EXPECT_EQ(result.input_intersections, 0);
}

// One node of the lower plate goes through the upper one, at half of its way, beside no node: it
// comes out in one triangle, and the six faces around the node all reach it.
TEST(SurfaceCheck, AFindingNamesElementsPlaceHeightAndShare) {
  const Mesh mesh = two_plates(4, 0.5);
  const Index node = 12;  // (0.5, 0.5, 0)
  std::vector<Vec3> moved = mesh.nodes;
  moved[node] += Vec3(0.08, 0.04, 1.0);
  const SurfaceCheck result = check(mesh, moved);
  EXPECT_EQ(result.folded_faces, 0);
  EXPECT_GT(result.self_intersections, 6);
  ASSERT_EQ(result.findings.size(), detail::DefectTally::most_kept);
  const SurfaceFinding& worst = result.findings.front();
  EXPECT_EQ(worst.defect, SurfaceDefect::intersection);
  EXPECT_LE(worst.elements[0], 32);
  EXPECT_GT(worst.elements[1], 50'000);
  EXPECT_EQ(worst.what, "triangle " + std::to_string(worst.elements[0]) + " intersects triangle " +
                            std::to_string(worst.elements[1]));
  EXPECT_NEAR(worst.passing_share, 0.5, std::ldexp(1, -12));
  EXPECT_LE(worst.passing_share, 0.5);
  EXPECT_NEAR(worst.height, Vec3(0.08, 0.04, 1.0).norm(), 1e-15);
  EXPECT_LT((worst.place - Vec3(0.5, 0.5, 0.5)).norm(), 0.25);
  for (std::size_t i = 1; i < result.findings.size(); ++i)
    EXPECT_GE(result.findings[i].passing_share, result.findings[i - 1].passing_share);
}

// The estimate is where the pairs that intersect in the end start to: a little more fails. A little
// less passes, but for pairs that intersect on the way only: those of few cases.
TEST(SurfaceCheck, TheWorstShareIsWhereThingsStartToFail) {
  const Mesh mesh = test::icosphere(3);
  int n_passed = 0;
  constexpr unsigned n_cases = 10;
  for (unsigned seed = 1; seed <= n_cases; ++seed) {
    const std::vector<Vec3> moved = jittered(mesh.nodes, 0.4, seed);
    const auto at_share = [&](double share) {
      std::vector<Vec3> nodes = mesh.nodes;
      for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] += share * (moved[i] - nodes[i]);
      return check(mesh, nodes);
    };
    const SurfaceCheck result = at_share(1);
    ASSERT_FALSE(result.valid());
    const double share = result.findings.front().passing_share;
    EXPECT_GT(share, 0);
    EXPECT_FALSE(at_share(share + 0.001).valid());
    n_passed += at_share(0.999 * share).valid();
  }
  EXPECT_GE(n_passed, 7);
}

TEST(SurfaceCheck, NumbersOrderAndPlaceDoNotMatter) {
  for (const Mesh& mesh : {test::ball_in_box(8), test::cell_box(ElementShape::hexahedron, 4)}) {
    std::vector<Vec3> shifts = jittered(std::vector<Vec3>(mesh.nodes.size(), Vec3::Zero()), 0.2, 9);
    for (Vec3& x : shifts) x = (x * 0x1p20).array().round() / 0x1p20;  // sums are exact
    Mesh rounded = mesh;
    for (Vec3& x : rounded.nodes) x = (x * 0x1p20).array().round() / 0x1p20;
    Mesh displaced = rounded;
    for (std::size_t i = 0; i < shifts.size(); ++i) displaced.nodes[i] += shifts[i];
    const SurfaceCheck result = check(rounded, displaced.nodes);
    EXPECT_GT(result.self_intersections, 50);
    const SurfaceCheck other =
        check(test::shuffled(rounded, 4), test::shuffled(displaced, 4).nodes);
    expect_same_findings(result, other, Vec3::Zero());
    const Vec3 far(1024, -512, 64);
    expect_same_findings(result, check(moved_by(rounded, far), moved_by(displaced, far).nodes),
                         far);
  }
}

TEST(SurfaceCheck, TheDiagonalOfAQuadrangleDoesNotMatter) {
  Mesh mesh = test::cell_box(ElementShape::hexahedron, 4);
  const std::vector<Vec3> moved = jittered(mesh.nodes, 0.2, 3);
  const SurfaceCheck result = check(mesh, moved);
  EXPECT_GT(result.self_intersections, 10);
  for (ElementBlock& block : mesh.blocks)
    if (block.type.shape == ElementShape::quadrangle)
      for (Index e = 0; e < block.size(); ++e) {
        const auto first = block.nodes.begin() + 4 * e;
        std::rotate(first, first + 1, first + 4);
      }
  expect_same_findings(result, check(mesh, moved), Vec3::Zero());
}

// Several hundred tasks, and as many ranges of pairs.
TEST(SurfaceCheck, ThreadsDoNotMatter) {
  const Mesh mesh = test::icosphere(4);
  const std::vector<Vec3> moved = jittered(mesh.nodes, 0.2, 1);
  const auto run = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return check(mesh, moved);
  };
  const SurfaceCheck one = run(1);
  EXPECT_GT(one.self_intersections, 1000);
  for (const int n_threads : {2, 7}) {
    const SurfaceCheck other = run(n_threads);
    expect_same_findings(one, other, Vec3::Zero());
    for (std::size_t i = 0; i < one.findings.size(); ++i)
      EXPECT_EQ(one.findings[i].what, other.findings[i].what);
  }
}

// ---- What was there before ----

TEST(SurfaceCheck, IntersectionsOfTheInputAreNotBlamed) {
  const Mesh mesh = joined(test::icosphere(2), moved_by(test::icosphere(2), {0.9, 0.1, 0.2}));
  const SurfaceCheck at_rest = check(mesh, mesh.nodes);
  EXPECT_TRUE(at_rest.valid());
  EXPECT_EQ(at_rest.input_intersections, 0);  // nothing moved, nothing is looked at
  const std::vector<Vec3> shifted = moved_by(mesh, {0.5, 0, 0}).nodes;
  const SurfaceCheck result = check(mesh, shifted);
  EXPECT_TRUE(result.valid());
  EXPECT_GT(result.input_intersections, 20);
  EXPECT_EQ(result.input_intersections,
            static_cast<std::int64_t>(pairs_of(mesh, shifted).all.size()));
  // One more that was not there: a node of the first far from the second, pushed through itself.
  std::vector<Vec3> pushed = shifted;
  const Index leftmost = static_cast<Index>(
      std::min_element(mesh.nodes.begin(), mesh.nodes.end(),
                       [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); }) -
      mesh.nodes.begin());
  pushed[leftmost] += Vec3(0.1, 0.05, 4);
  const SurfaceCheck worse = check(mesh, pushed);
  EXPECT_GT(worse.self_intersections, 0);
  EXPECT_LE(worse.input_intersections, result.input_intersections);
}

// Two bodies that touch with equal meshes, each with nodes of its own: before, after they moved
// together, and apart.
TEST(SurfaceCheck, FacesInContactDoNotIntersect) {
  const Mesh mesh = two_plates(6, 0);
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& x : moved) x.z() = 0.1 * std::sin(5 * x.x()) * std::cos(4 * x.y());
  EXPECT_TRUE(check(mesh, moved).valid());
  EXPECT_EQ(check(mesh, moved).input_intersections, 0);
  const std::size_t half = moved.size() / 2;
  for (std::size_t i = half; i < moved.size(); ++i) moved[i].z() += 0.2;
  EXPECT_TRUE(check(mesh, moved).valid());
  // The second through the first: every face meets neighbours of the one it touched.
  for (std::size_t i = half; i < moved.size(); ++i) moved[i].z() = -2 * moved[i - half].z();
  EXPECT_GT(check(mesh, moved).self_intersections, 0);
}

// Elements that a file lists once for each of their groups are one face.
TEST(SurfaceCheck, RepeatedElementsAreOne) {
  Mesh mesh = test::plate(3);
  mesh.blocks.push_back(mesh.blocks[0]);
  mesh.blocks[1].physical_groups = {2};
  const SurfaceCheck result = check(mesh, jittered(mesh.nodes, 1, 1, {0, 0, 1}));
  EXPECT_TRUE(result.valid());
  EXPECT_EQ(result.input_intersections, 0);
}

// The two halves of a plate with nodes of their own along the middle.
TEST(SurfaceCheck, TheSidesOfACrackAreOneUntilTheyComeApart) {
  const Mesh left = test::plate(4), right = moved_by(test::plate(4), {1, 0, 0});
  const Mesh mesh = joined(left, right);
  const auto bend = [](const Vec3& x) { return Vec3(x.x(), x.y(), std::sin(3 * x.x() + x.y())); };
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& x : moved) x = bend(x);
  EXPECT_TRUE(check(mesh, moved).valid());
  EXPECT_EQ(check(mesh, moved).input_intersections, 0);
  // The left half slides into the right one, and away from it.
  for (const double slide : {0.1, -0.1}) {
    std::vector<Vec3> slid = mesh.nodes;
    for (Index i = 0; i < left.n_nodes(); ++i) slid[i].x() += slide;
    EXPECT_EQ(check(mesh, slid).valid(), slide < 0);
  }
}

TEST(SurfaceCheck, BodiesInContactMoveTogether) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  test::detach(mesh, 3, 0);
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& x : moved)
    if (x.z() == 0.5) x.z() += 0.1 * std::sin(5 * x.x()) * std::cos(7 * x.y());
  EXPECT_TRUE(check(mesh, moved).valid());
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (node >= 125 && mesh.nodes[node].z() == 0.5) moved[node] = mesh.nodes[node];
  const SurfaceCheck apart = check(mesh, moved);  // the upper body stays
  EXPECT_FALSE(apart.valid());
  EXPECT_LT(apart.findings.front().passing_share, 0.01);  // no height passes
}

TEST(SurfaceCheck, WhatDoesNotMoveIsNotLookedAt) {
  Mesh mesh = joined(test::icosphere(1), moved_by(test::icosphere(1), {0.5, 0, 0}));
  mesh = joined(std::move(mesh), moved_by(test::plate(2), {5, 0, 0}));
  std::vector<Vec3> moved = mesh.nodes;
  moved.back().z() += 0.1;
  const SurfaceCheck result = check(mesh, moved);
  EXPECT_TRUE(result.valid());
  EXPECT_EQ(result.input_intersections, 0);
}

// ---- Faces that turn or vanish ----

TEST(SurfaceCheck, FoldedFacesAreCounted) {
  const auto [mesh, moved, n_clockwise] = test::folded_plate();
  const SurfaceCheck result = check(mesh, moved);
  EXPECT_EQ(result.folded_faces, n_clockwise);
  EXPECT_GT(result.self_intersections, 0);  // folded onto each other, in one plane
}

// A node goes to the middle of the opposite edge and beyond: half of twice that way passes.
TEST(SurfaceCheck, AFaceCollapsesAndFolds) {
  const Mesh mesh = test::surface_mesh({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {0, 1, 2});
  for (const double depth : {1.0, 2.0}) {
    std::vector<Vec3> moved = mesh.nodes;
    moved[2].y() -= depth;
    const SurfaceCheck result = check(mesh, moved);
    EXPECT_EQ(result.collapsed_faces, depth == 1.0);
    EXPECT_EQ(result.folded_faces, depth == 2.0);
    ASSERT_EQ(result.findings.size(), 1U);
    const SurfaceFinding& finding = result.findings.front();
    EXPECT_NEAR(finding.passing_share, 1 / depth, std::ldexp(1, -12));
    EXPECT_EQ(finding.elements, (std::array<Tag, 2>{0, 1}));
    EXPECT_EQ(finding.what,
              depth == 1.0 ? "triangle 1 has collapsed" : "triangle 1 is folded over");
  }
}

TEST(SurfaceCheck, ALineThatTurnsBack) {
  const Mesh mesh = test::ring(16);
  std::vector<Vec3> moved = mesh.nodes;
  const auto line = mesh.blocks[2].element(3);  // of the rim
  moved[line[0]] += 1.5 * (mesh.nodes[line[1]] - mesh.nodes[line[0]]);
  const SurfaceCheck result = check(mesh, "rim", moved);
  EXPECT_EQ(result.folded_faces, 1);
  const auto is_it = [&](const SurfaceFinding& f) {
    return f.defect == SurfaceDefect::folded && f.elements[1] == mesh.blocks[2].tags[3];
  };
  EXPECT_TRUE(std::any_of(result.findings.begin(), result.findings.end(), is_it));
}

// A face without area in the input has no side to lose.
TEST(SurfaceCheck, FacesWithoutAreaInTheInputAreLeftAlone) {
  const Mesh mesh = test::surface_mesh({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, -1, 0}},
                                       {0, 2, 3, 2, 1, 3, 0, 1, 2, 0, 4, 1});
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& x : moved) x.z() += 0.2 * x.x() * x.x();
  EXPECT_TRUE(check(mesh, moved).valid());
}

// ---- What nobody should give ----

TEST(SurfaceCheck, PositionsMustBeFiniteAndComplete) {
  const Mesh mesh = test::plate(2);
  const Surface surface = all_of(mesh);
  EXPECT_THROW(SurfaceChecker(mesh, {}), InputError);
  std::vector<Vec3> moved = mesh.nodes;
  EXPECT_THROW(check(mesh, std::span(moved).first(3)), InputError);
  for (const double bad : {std::nan(""), static_cast<double>(INFINITY)}) {
    moved[4].y() = bad;
    EXPECT_THROW(check(mesh, moved), NumericalError);
  }
}

// All corners go to three places: three million pairs, of which a part is enough. So does all that
// collapses into a point, which has no area to intersect with.
TEST(SurfaceCheck, AllFacesAtOnePlaceEndsSoon) {
  const Mesh mesh = test::plate(36);
  std::vector<Vec3> moved = mesh.nodes;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const int place = (static_cast<int>(i) % 37 + static_cast<int>(i) / 37) % 3;
    moved[i] = Vec3(place == 0, place == 1, place == 2);
  }
  const SurfaceCheck heap = check(mesh, moved);
  EXPECT_FALSE(heap.is_complete);
  EXPECT_GE(heap.self_intersections, 200'000);
  EXPECT_EQ(heap.findings.size(), detail::DefectTally::most_kept);
  // Those faces as the input: nothing new is found, but not all was looked at.
  Mesh messy = mesh;
  messy.nodes = jittered(moved, 1e-5, 1);
  const SurfaceCheck unknown = check(messy, moved_by(messy, {1, 0, 0}).nodes);
  EXPECT_TRUE(unknown.findings.empty());
  EXPECT_FALSE(unknown.is_complete);
  EXPECT_FALSE(unknown.valid());
  moved.assign(moved.size(), Vec3(1, 2, 3));
  EXPECT_EQ(check(mesh, moved).collapsed_faces, n_elements(mesh));
}

TEST(SurfaceCheck, AMeshThatIsOnePlaceInTheInput) {
  Mesh mesh = test::plate(20);
  const Surface surface = all_of(mesh);
  for (Vec3& x : mesh.nodes) x = Vec3(1, 2, 3);
  const std::vector<Vec3> moved = jittered(mesh.nodes, 1, 1);
  EXPECT_TRUE(check_surface(mesh, test::only(surface), moved).valid());
}
