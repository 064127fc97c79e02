// SPDX-License-Identifier: BSD-3-Clause
// Weights of points: fades by exact distance, fixed groups, boxes, balls, and their product.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/mask.hpp"

#include "parallel.hpp"
#include "smooth_step.hpp"
#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/groups.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// A weight has a few roundings of numbers up to 1, times the slope of the step, at most 15/8 over
// the width; widths here are at least 0.1.
constexpr double exact = 1e-13;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

double step(double t) {
  return t <= 0 ? 0 : t >= 1 ? 1 : std::pow(t, 3) * (6 * t * t - 15 * t + 10);
}

// The part of a sphere above z = 0.35: an open surface with a ragged border.
Mesh sphere_cap() {
  Mesh mesh = test::icosphere(3);
  ElementBlock& block = mesh.blocks[0];
  std::vector<Index> kept;
  for (Index e = 0; e < block.size(); ++e) {
    const auto t = block.element(e);
    if (std::all_of(t.begin(), t.end(), [&](Index n) { return mesh.nodes[n].z() > 0.35; }))
      kept.insert(kept.end(), t.begin(), t.end());
  }
  block = test::make_block(test::triangle_type, 1, {1}, kept, 1);
  return mesh;
}

// A circular arc of n lines in the plane z = 0, as a curve selected from a planar mesh.
struct Arc {
  Mesh mesh;
  Surface curve;

  Arc(int n, double angle) {
    const bool is_closed = angle > 6.28;
    const int n_points = is_closed ? n : n + 1;
    for (int i = 0; i < n_points; ++i) {
      const double t = angle * i / n;
      mesh.nodes.emplace_back(std::cos(t), std::sin(t), 0);
    }
    std::vector<Index> lines;
    for (int i = 0; i < n; ++i) lines.insert(lines.end(), {i, (i + 1) % n_points});
    mesh.blocks = {test::make_block(test::line_type, 1, {1}, lines, 1)};
    mesh.groups = {{1, 1, "arc"}};
    test::number_nodes(mesh);
    curve.dimension = 1;
    curve.points = mesh.nodes;
    curve.normals = mesh.nodes;
    curve.nodes.resize(mesh.nodes.size());
    std::iota(curve.nodes.begin(), curve.nodes.end(), 0);
    curve.point_of_node = curve.nodes;
    curve.face_offsets = {0};
    for (int i = 1; i <= n; ++i) curve.face_offsets.push_back(2 * i);
    curve.face_points = lines;
    curve.face_tags = mesh.blocks[0].tags;
    curve.areas.assign(mesh.nodes.size(), angle / n);
    curve.area = angle;
    if (!is_closed) curve.border_edges = {{0, 0}, {n, n}};
    curve.n_border_edges = static_cast<Index>(curve.border_edges.size());
  }
};

double segment_distance(const Vec3& a, const Vec3& b, const Vec3& x) {
  const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - (1 - t) * a - t * b).norm();
}

// Every pair of points that is the side of one face only, by counting.
std::vector<std::pair<Index, Index>> border_by_counting(const Surface& surface) {
  std::map<std::pair<Index, Index>, int> count;
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      ++count[std::minmax(face[k], face[(k + 1) % face.size()])];
  }
  std::vector<std::pair<Index, Index>> border;
  for (const auto& [edge, n] : count)
    if (n == 1) border.push_back(edge);
  return border;
}

void expect_weights(const Surface& surface, const std::vector<double>& weights,
                    const std::function<double(const Vec3&)>& expected, double tolerance = exact) {
  ASSERT_EQ(weights.size(), surface.points.size());
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_NEAR(weights[i], expected(surface.points[i]), tolerance)
        << surface.points[i].transpose();
}

std::string refusal(const Mesh& mesh, const Surface& surface, const MaskOptions& options) {
  return test::message_of([&] { mask_weights(mesh, surface, options); });
}

}  // namespace

// S(t) <= 10 t^3 says that S, S' and S'' vanish at 0; S(1 - t) = 1 - S(t) says the same of 1.
TEST(Mask, TheStepHasTwoContinuousDerivativesAtBothEnds) {
  for (int k = 0; k <= 1000; ++k) {
    const double t = k / 1000.0;
    EXPECT_LE(detail::smooth_step(t), 10 * t * t * t);
    EXPECT_NEAR(detail::smooth_step(1 - t), 1 - detail::smooth_step(t), 1e-15);
    EXPECT_LE(detail::smooth_step(t), detail::smooth_step(t + 1e-3) + 1e-15);
  }
  EXPECT_EQ(detail::smooth_step(0), 0);
  EXPECT_EQ(detail::smooth_step(1), 1);
  EXPECT_EQ(detail::smooth_step(-3), 0);
  EXPECT_EQ(detail::smooth_step(infinity), 1);
  EXPECT_EQ(detail::smooth_step(0.5), 0.5);
}

TEST(Mask, WithoutMasksEveryWeightIsOne) {
  const Mesh mesh = test::plate(3);
  const MaskOptions none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(mask_weights(mesh, select_surface(mesh), none), std::vector<double>(16, 1.0));
}

TEST(Mask, FadeOnAPlateIsTheStepOfTheDistanceToItsSides) {
  const Mesh mesh = test::framed_plate(20);
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const std::vector<double> weights = mask_weights(mesh, surface, {.fade = {{.width = 0.3}}});
  const auto to_side = [](const Vec3& x) { return std::min({x.x(), 1 - x.x(), x.y(), 1 - x.y()}); };
  expect_weights(surface, weights, [&](const Vec3& x) { return step(to_side(x) / 0.3); });
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (to_side(surface.points[i]) == 0) {
      EXPECT_EQ(weights[i], 0);
    } else if (to_side(surface.points[i]) > 0.31) {
      EXPECT_EQ(weights[i], 1);
    }
  }
  EXPECT_EQ(weights, mask_weights(mesh, surface, {.fade = {{.width = 0.3, .group = "rim"}}}));
  EXPECT_EQ(weights, mask_weights(mesh, surface, {.fade = {{.width = 0.3, .group = "7"}}}));
}

TEST(Mask, FadeOnASphereCapIsTheStepOfTheDistanceToItsBorder) {
  const Mesh mesh = sphere_cap();
  const Surface surface = select_surface(mesh);
  const auto border = border_by_counting(surface);
  ASSERT_GT(border.size(), 20u);
  for (const double width : {0.1, 0.4, 5.0})
    expect_weights(
        surface, mask_weights(mesh, surface, {.fade = {{.width = width}}}), [&](const Vec3& x) {
          double nearest = infinity;
          for (const auto& [a, b] : border)
            nearest = std::min(nearest, segment_distance(surface.points[a], surface.points[b], x));
          return step(nearest / width);
        });
}

// Unselected faces that go on beyond the selected ones do not hide the border between them.
TEST(Mask, FadeStartsWhereUnselectedFacesBegin) {
  Mesh mesh = test::plate(10);
  ElementBlock left = mesh.blocks[0], right = left;
  left.nodes.clear();
  right.nodes.clear();
  for (Index e = 0; e < mesh.blocks[0].size(); ++e) {
    const auto t = mesh.blocks[0].element(e);
    const double x = (mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]]).x() / 3;
    auto& side = x < 0.5 ? left : right;
    side.nodes.insert(side.nodes.end(), t.begin(), t.end());
  }
  mesh.blocks = {test::make_block(test::triangle_type, 1, {1}, left.nodes, 1),
                 test::make_block(test::triangle_type, 2, {2}, right.nodes, 1001)};
  mesh.groups = {{2, 1, "left"}, {2, 2, "right"}};
  const Surface surface = select_surface(mesh, {.groups = {"left"}});
  expect_weights(surface, mask_weights(mesh, surface, {.fade = {{.width = 0.4}}}),
                 [](const Vec3& x) {
                   return step(std::min({x.x(), 0.5 - x.x(), x.y(), 1 - x.y()}) / 0.4);
                 });
  expect_weights(surface, mask_weights(mesh, surface, {.fade = {{.width = 0.4, .group = "right"}}}),
                 [](const Vec3& x) { return step((0.5 - x.x()) / 0.4); });
}

TEST(Mask, FadeOnACurveStartsFromItsEnds) {
  const Arc arc(40, 3.0);
  const Vec3 first = arc.mesh.nodes.front(), last = arc.mesh.nodes.back();
  const std::vector<double> weights = mask_weights(arc.mesh, arc.curve, {.fade = {{.width = 0.5}}});
  expect_weights(arc.curve, weights, [&](const Vec3& x) {
    return step(std::min((x - first).norm(), (x - last).norm()) / 0.5);
  });
  EXPECT_EQ(weights.front(), 0);
  EXPECT_EQ(weights.back(), 0);
  EXPECT_EQ(weights[20], 1);
  const Arc circle(40, 2 * 3.14159265358979);
  EXPECT_TRUE(contains(refusal(circle.mesh, circle.curve, {.fade = {{.width = 0.5}}}), "closed"));
}

TEST(Mask, FadeStartsFromElementsOfAnyDimension) {
  Mesh mesh = test::framed_plate(20);
  const Index centre = 10 * 21 + 10, east = 10 * 21 + 20;
  test::add_group(mesh, test::point_type, 5, "middle", {centre});
  test::add_group(mesh, test::line_type, 6, "beam",
                  {centre, east});  // one long line over ten squares
  const auto apex = mesh.n_nodes();
  mesh.nodes.emplace_back(0.5, 0.5, 0.2);
  test::number_nodes(mesh);
  test::add_group(mesh, test::tetrahedron_type, 9, "tent", {0, 20, 20 * 21, apex});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const auto fade = [&](const std::string& group) {
    return mask_weights(mesh, surface, {.fade = {{.width = 0.25, .group = group}}});
  };
  const Vec3 middle(0.5, 0.5, 0), end(1, 0.5, 0);
  expect_weights(surface, fade("middle"),
                 [&](const Vec3& x) { return step((x - middle).norm() / 0.25); });
  expect_weights(surface, fade("beam"),
                 [&](const Vec3& x) { return step(segment_distance(middle, end, x) / 0.25); });
  // The bottom of the tent is the half of the plate below its diagonal.
  expect_weights(surface, fade("tent"),
                 [](const Vec3& x) { return step((x.x() + x.y() - 1) / std::sqrt(2.0) / 0.25); });
}

TEST(Mask, OneDimensionBelowTheSurfaceIsPreferred) {
  Mesh mesh = test::framed_plate(8);
  test::add_group(mesh, test::point_type, 7, "corner", {0});
  test::add_group(mesh, test::point_type, 3, "lone", {0});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const auto fade = [&](const std::string& group) {
    return mask_weights(mesh, surface, {.fade = {{.width = 0.25, .group = group}}});
  };
  EXPECT_EQ(fade("7"), fade("rim"));
  EXPECT_NE(fade("7"), fade("corner"));
  EXPECT_EQ(fade("3"), fade("lone"));
}

TEST(Mask, FixedPointsAreThoseOnElementsOfTheGroup) {
  Mesh mesh = test::framed_plate(6);
  test::add_group(mesh, test::point_type, 5, "middle", {3 * 7 + 3});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const auto on_rim = [](const Vec3& x) {
    return x.x() == 0 || x.x() == 1 || x.y() == 0 || x.y() == 1;
  };
  expect_weights(
      surface, mask_weights(mesh, surface, {.fixed = {"rim"}}),
      [&](const Vec3& x) { return on_rim(x) ? 0 : 1; }, 0);
  expect_weights(
      surface, mask_weights(mesh, surface, {.fixed = {"rim", "5"}}),
      [&](const Vec3& x) { return on_rim(x) || x == Vec3(0.5, 0.5, 0) ? 0 : 1; }, 0);
}

TEST(Mask, FixedVolumesAndFacesHoldTheirPoints) {
  const Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const Surface surface = select_surface(mesh, {.groups = {"middle", "top"}});
  const auto middle = [](const Vec3& x) { return x.z() == 0.5; };
  for (const char* group : {"below", "middle"})
    expect_weights(
        surface, mask_weights(mesh, surface, {.fixed = {group}}),
        [&](const Vec3& x) { return middle(x) ? 0 : 1; }, 0);
  EXPECT_TRUE(contains(refusal(mesh, surface, {.fixed = {"above"}}), "nothing becomes rough"));
}

TEST(Mask, ABoxIsOneInsideAndFadesOutside) {
  const Mesh mesh = test::icosphere(3);
  const Surface surface = select_surface(mesh);
  BoxMask box{.min = {-0.2, -infinity, 0}, .max = {0.5, infinity, 0.8}, .fade = 0.4};
  const auto distance = [](const Vec3& x) {
    const double dx = std::max({-0.2 - x.x(), x.x() - 0.5, 0.0});
    const double dz = std::max({-x.z(), x.z() - 0.8, 0.0});
    return std::hypot(dx, dz);
  };
  expect_weights(surface, mask_weights(mesh, surface, {.boxes = {box}}),
                 [&](const Vec3& x) { return 1 - step(distance(x) / 0.4); });
  box.outside = true;
  expect_weights(surface, mask_weights(mesh, surface, {.boxes = {box}}),
                 [&](const Vec3& x) { return step(distance(x) / 0.4); });
  box.fade = 0;
  expect_weights(
      surface, mask_weights(mesh, surface, {.boxes = {box}}),
      [&](const Vec3& x) { return distance(x) > 0 ? 1 : 0; }, 0);
  box.outside = false;
  expect_weights(
      surface, mask_weights(mesh, surface, {.boxes = {box}}),
      [&](const Vec3& x) { return distance(x) > 0 ? 0 : 1; }, 0);
}

TEST(Mask, ABallIsOneInsideAndFadesOutside) {
  const Mesh mesh = test::plate(20);
  const Surface surface = select_surface(mesh);
  const Vec3 centre(0.3, 0.4, 0.1);
  SphereMask ball{.centre = centre, .radius = 0.25, .fade = 0.3};
  const auto t = [&](const Vec3& x) { return ((x - centre).norm() - 0.25) / 0.3; };
  expect_weights(surface, mask_weights(mesh, surface, {.spheres = {ball}}),
                 [&](const Vec3& x) { return 1 - step(t(x)); });
  ball.outside = true;
  expect_weights(surface, mask_weights(mesh, surface, {.spheres = {ball}}),
                 [&](const Vec3& x) { return step(t(x)); });
  ball.fade = 0;
  expect_weights(
      surface, mask_weights(mesh, surface, {.spheres = {ball}}),
      [&](const Vec3& x) { return t(x) > 0 ? 1 : 0; }, 0);
}

// One rounding for each of six factors up to 1.
TEST(Mask, MasksCombineByTheirProduct) {
  Mesh mesh = test::framed_plate(12);
  test::add_group(mesh, test::point_type, 5, "corner", {0});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const MaskOptions all{.fade = {{.width = 0.4}, {.width = 0.8, .group = "corner"}},
                        .fixed = {"corner"},
                        .boxes = {{.min = {0, 0, 0}, .max = {0.5, 1, 0}, .fade = 0.6}},
                        .spheres = {{.centre = {1, 1, 0}, .radius = 0.5, .fade = 0.7}},
                        .formulas = {{"0.2 + x*y"}, {"1.2 - x"}}};
  std::vector<double> product(surface.points.size(), 1.0);
  const auto multiply = [&](const MaskOptions& one) {
    const std::vector<double> weights = mask_weights(mesh, surface, one);
    for (std::size_t i = 0; i < product.size(); ++i) product[i] *= weights[i];
  };
  for (const auto& one : all.fade) multiply({.fade = {one}});
  for (const auto& one : all.fixed) multiply({.fixed = {one}});
  for (const auto& one : all.boxes) multiply({.boxes = {one}});
  for (const auto& one : all.spheres) multiply({.spheres = {one}});
  for (const auto& one : all.formulas) multiply({.formulas = {one}});
  const std::vector<double> together = mask_weights(mesh, surface, all);
  for (std::size_t i = 0; i < product.size(); ++i) EXPECT_NEAR(together[i], product[i], 1e-15);
}

TEST(Mask, NumberingAndThreadsChangeNoBit) {
  const auto weights_of = [](const Mesh& mesh, int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    const Surface surface = select_surface(mesh, {.groups = {"middle", "top"}});
    return mask_weights(mesh, surface,
                        {.fade = {{.width = 0.37}, {.width = 0.6, .group = "below"}},
                         .boxes = {{.min = {0.1, 0.1, 0}, .max = {0.7, 0.7, 1}, .fade = 0.5}}});
  };
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron}) {
    Mesh mesh = test::cell_box(shape, 6);
    for (Vec3& x : mesh.nodes)  // curved faces and cells
      x += 0.02 * Vec3(std::sin(5 * x.y()), std::sin(4 * x.z()), std::sin(7 * x.x() + 3 * x.y()));
    const std::vector<double> weights = weights_of(mesh, 1);
    EXPECT_GT(*std::max_element(weights.begin(), weights.end()), 0.1);
    EXPECT_EQ(weights, weights_of(mesh, 4));
    for (const unsigned seed : {1u, 2u, 3u})
      EXPECT_EQ(weights, weights_of(test::shuffled(mesh, seed), 2));
  }
}

// A warped quadrangle is the same whichever corner the file names first.
TEST(Mask, QuadranglesHaveNoPreferredDiagonal) {
  Mesh mesh = test::cell_box(ElementShape::hexahedron, 4);
  for (Vec3& x : mesh.nodes) x.z() += 0.2 * std::sin(9 * x.x()) * std::sin(8 * x.y());
  const auto weights_of = [](const Mesh& some) {
    return mask_weights(some, select_surface(some, {.groups = {"top"}}),
                        {.fade = {{.width = 0.9, .group = "middle"}}});
  };
  const std::vector<double> weights = weights_of(mesh);
  EXPECT_LT(*std::max_element(weights.begin(), weights.end()), 1);
  EXPECT_GT(*std::min_element(weights.begin(), weights.end()), 0);
  std::vector<Index>& middle = mesh.blocks[0].nodes;
  for (std::size_t e = 0; e < middle.size(); e += 8)  // every second one
    std::rotate(&middle[e], &middle[e + 1], &middle[e + 4]);
  EXPECT_EQ(weights, weights_of(mesh));
}

// Nodes at one position up to round-off are one point, from which its group is at distance 0.
TEST(Mask, GroupsOnWeldedNodesAreAtDistanceZero) {
  Mesh mesh = test::plate(4);
  const Index centre = 12, east = 13, twin = mesh.n_nodes();
  mesh.nodes.push_back(mesh.nodes[centre] + Vec3(1e-12, 0, 0));
  mesh.nodes.emplace_back(0.5, 0.5, 1.0);
  test::number_nodes(mesh);
  mesh.blocks.push_back(test::make_block(test::triangle_type, 1, {1}, {twin, east, twin + 1}, 900));
  test::add_group(mesh, test::point_type, 5, "twin", {twin});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const Index point = surface.point_of_node[twin];  // every node is on the surface
  ASSERT_EQ(point, surface.point_of_node[centre]);
  EXPECT_EQ(mask_weights(mesh, surface, {.fade = {{.width = 0.3, .group = "twin"}}})[point], 0);
  EXPECT_EQ(mask_weights(mesh, surface, {.fixed = {"twin"}})[point], 0);
}

TEST(Mask, AGroupBesideTheSurfaceCountsAsFarAsItReaches) {
  for (const Vec3& place : {Vec3(1.2, 0.5, 0), Vec3(-0.2, 0.5, 0), Vec3(0.5, 0.5, 0.3)}) {
    Mesh mesh = test::plate(8);
    mesh.nodes.push_back(place);
    test::number_nodes(mesh);
    test::add_group(mesh, test::point_type, 5, "post", {mesh.n_nodes() - 1});
    const Surface surface = select_surface(mesh, {.groups = {"surface"}});
    expect_weights(surface,
                   mask_weights(mesh, surface, {.fade = {{.width = 0.5, .group = "post"}}}),
                   [&](const Vec3& x) { return step((x - place).norm() / 0.5); });
  }
}

TEST(Mask, AFarGroupFadesNothing) {
  Mesh mesh = test::plate(4);
  mesh.nodes.emplace_back(0, 0, 5);
  test::number_nodes(mesh);
  test::add_group(mesh, test::point_type, 5, "far", {mesh.n_nodes() - 1});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  EXPECT_EQ(mask_weights(mesh, surface, {.fade = {{.width = 1, .group = "far"}}}),
            std::vector<double>(25, 1.0));
  EXPECT_EQ(refusal(mesh, surface, {.fixed = {"far"}}),
            "fixed: no point of the surface is on physical group 'far' (dimension 0); name a group "
            "that touches the surface");
}

TEST(Mask, RefusalsNameTheValueAndTheRemedy) {
  Mesh mesh = test::framed_plate(4);
  mesh.groups.push_back({2, 9, "empty"});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  for (const double width : {0.0, -1.0, infinity, not_a_number}) {
    const std::string message = refusal(mesh, surface, {.fade = {{.width = width}}});
    EXPECT_TRUE(contains(message, "fade: the width is ")) << message;
    EXPECT_TRUE(contains(message, "finite length above 0")) << message;
  }
  EXPECT_EQ(refusal(mesh, surface, {.fixed = {"gold"}}),
            "mask: there is no physical group 'gold'; groups of the mesh: rim (7), surface (1), "
            "empty (9)");
  EXPECT_TRUE(contains(refusal(mesh, surface, {.fixed = {""}}), "no physical group ''"));
  EXPECT_TRUE(contains(refusal(mesh, surface, {.fade = {{1, "empty"}}}), "has no element"));
  const Vec3 one = Vec3::Ones();
  for (const BoxMask& box : {BoxMask{one, -one}, BoxMask{Vec3(not_a_number, 0, 0), one},
                             BoxMask{infinity * one, infinity * one}})
    EXPECT_TRUE(contains(refusal(mesh, surface, {.boxes = {box}}), "is no interval"));
  for (const double fade : {-1.0, infinity, not_a_number}) {
    EXPECT_TRUE(contains(refusal(mesh, surface, {.boxes = {{-one, one, fade}}}), "the fade is"));
    EXPECT_TRUE(contains(refusal(mesh, surface, {.spheres = {{one, 1, fade}}}), "the fade is"));
  }
  for (const double radius : {0.0, -1.0, infinity, not_a_number})
    EXPECT_TRUE(contains(refusal(mesh, surface, {.spheres = {{one, radius}}}), "the radius is"));
  EXPECT_TRUE(contains(refusal(mesh, surface, {.spheres = {{not_a_number * one, 1}}}),
                       "sphere mask: the centre"));
  EXPECT_TRUE(contains(refusal(mesh, surface, {.spheres = {{9 * one, 1}}}),
                       "none of the 25 points of the surface above 0"));
}

TEST(Mask, AClosedSurfaceHasNoBorderToFadeFrom) {
  const Mesh mesh = test::icosphere(1);
  const std::string message = refusal(mesh, select_surface(mesh), {.fade = {{.width = 0.1}}});
  EXPECT_TRUE(contains(message, "closed and has no border")) << message;
  EXPECT_TRUE(contains(message, "name a physical group")) << message;
}

TEST(Mask, APositionThatIsNoNumberIsTold) {
  Mesh mesh = test::plate(4);
  mesh.nodes.emplace_back(not_a_number, 0, 0);
  test::number_nodes(mesh);
  test::add_group(mesh, test::line_type, 5, "torn", {0, mesh.n_nodes() - 1});
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  EXPECT_EQ(refusal(mesh, surface, {.fade = {{.width = 1, .group = "torn"}}}),
            "element 100000 has a coordinate that is not finite; mend the mesh");
}

TEST(Mask, ASurfaceOfAnotherMeshIsRefused) {
  const Surface surface = select_surface(test::plate(4));
  EXPECT_TRUE(contains(refusal(test::plate(2), surface, {}), "select it from this mesh"));
}

// A unit of length is a factor of everything.
TEST(Mask, WeightsDoNotDependOnTheUnit) {
  const Mesh mesh = test::framed_plate(8);
  const std::vector<double> weights =
      mask_weights(mesh, select_surface(mesh, {.groups = {"surface"}}), {.fade = {{.width = 0.3}}});
  for (const double unit : {0x1p-40, 0x1p40}) {
    Mesh scaled = mesh;
    for (Vec3& x : scaled.nodes) x *= unit;
    EXPECT_EQ(weights, mask_weights(scaled, select_surface(scaled, {.groups = {"surface"}}),
                                    {.fade = {{.width = 0.3 * unit}}}));
  }
}

TEST(Mask, FullWeightAreasAreThoseOfWeightOne) {
  const Mesh mesh = test::framed_plate(10);
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  const std::vector<double> weights = mask_weights(mesh, surface, {.fade = {{.width = 0.25}}});
  const std::vector<double> areas = full_weight_areas(surface, weights);
  for (std::size_t i = 0; i < areas.size(); ++i)
    EXPECT_EQ(areas[i], weights[i] == 1 ? surface.areas[i] : 0);
  EXPECT_THROW(full_weight_areas(surface, std::vector<double>(3)), InputError);
}
