// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of so many faces that they are worked on in parts: what comes out is that of all faces
// in one go, on any number of threads.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/surface.hpp"

#include "parallel.hpp"
#include "support/cells.hpp"
#include "support/meshes.hpp"
#include "support/same_surface.hpp"

namespace roughmesh {
namespace {

// 48,841 nodes and 96,800 triangles of a hilly plate, as a file may have them: numbered at random,
// a third of them the wrong way round.
Mesh hills() {
  Mesh mesh = test::plate(220);
  for (Vec3& x : mesh.nodes) x.z() = 0.05 * std::sin(20 * x.x()) * std::cos(13 * x.y());
  mesh = test::shuffled(mesh, 1);
  for (Index e = 0; e < mesh.blocks[0].size(); e += 3) test::turn_element(mesh.blocks[0], e);
  return mesh;
}

using EdgeCounts = std::map<std::array<Index, 2>, int>;

EdgeCounts faces_of_edges(const Surface& surface) {
  EdgeCounts counts;
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto face = surface.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto [i, j] = std::minmax(face[k], face[(k + 1) % face.size()]);
      ++counts[{i, j}];
    }
  }
  return counts;
}

// Two triangles that enclose an angle at their common edge.
Mesh roof(double angle) {
  return test::surface_mesh(
      {{0, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {std::cos(angle), 0.4, -std::sin(angle)}},
      {0, 1, 2, 0, 3, 1});
}

TEST(LargeSurface, IsTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = hills();
  const auto select = [&](int n_threads) {
    const detail::ThreadLimit limit(n_threads);
    return select_surface(mesh);
  };
  const Surface one = select(1);
  for (const int n_threads : {2, 7}) {
    const Surface other = select(n_threads);
    test::expect_same_surface(one, other);
    EXPECT_EQ(one.face_tags, other.face_tags);
    EXPECT_EQ(one.point_of_node, other.point_of_node);
    EXPECT_EQ(one.border_edges, other.border_edges);
    EXPECT_EQ(one.n_sharp_edges, other.n_sharp_edges);
  }
}

TEST(LargeSurface, HasTheFacesOfTheFileInTheOrderOfTheirPoints) {
  const Mesh mesh = hills();
  const Surface surface = select_surface(mesh);
  ASSERT_EQ(surface.n_faces(), mesh.blocks[0].size());
  ASSERT_EQ(surface.n_points(), mesh.n_nodes());
  std::map<Tag, Index> element_of_tag;
  for (Index e = 0; e < surface.n_faces(); ++e) element_of_tag[mesh.blocks[0].tags[e]] = e;
  std::array<Index, 3> previous{};
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto in_file = mesh.blocks[0].element(element_of_tag.at(surface.face_tags[f]));
    std::array<Index, 3> points{}, of_file{};
    std::copy_n(surface.face(f).begin(), 3, points.begin());
    for (std::size_t k = 0; k < 3; ++k) of_file[k] = surface.point_of_node[in_file[k]];
    std::sort(points.begin(), points.end());
    std::sort(of_file.begin(), of_file.end());
    ASSERT_EQ(points, of_file);
    ASSERT_LT(previous, points);
    previous = points;
  }
}

// Three times, so that repetitions stand on either side of any part.
TEST(LargeSurface, ATripledFileIsTheSurfaceOnce) {
  const Mesh mesh = hills();
  const Surface once = select_surface(mesh);
  Mesh tripled = mesh;
  const ElementBlock& from = mesh.blocks[0];
  ElementBlock& block = tripled.blocks[0];
  for (const Tag more : {1'000'000, 2'000'000}) {
    block.nodes.insert(block.nodes.end(), from.nodes.begin(), from.nodes.end());
    for (const Tag tag : from.tags) block.tags.push_back(tag + more);
  }
  const Surface surface = select_surface(tripled);
  test::expect_same_surface(once, surface);
  EXPECT_EQ(surface.face_tags, once.face_tags);  // of equal faces the first in the file stays
  EXPECT_EQ(surface.n_duplicate_faces, 2 * once.n_faces());
  EXPECT_EQ(surface.n_elements, once.n_faces());
}

// Max's normal (docs/math.md, eq. 2) and a third of each area, added up face by face.
TEST(LargeSurface, NormalsAndAreasAreSumsOverAllFaces) {
  const Surface surface = select_surface(hills());
  std::vector<Vec3> normals(surface.points.size(), Vec3::Zero());
  std::vector<double> areas(surface.points.size(), 0);
  for (Index f = 0; f < surface.n_faces(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto face = surface.face(f);
      const Vec3& x = surface.points[face[k]];
      const Vec3 a = surface.points[face[(k + 1) % 3]] - x,
                 b = surface.points[face[(k + 2) % 3]] - x;
      normals[face[k]] += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
      areas[face[k]] += a.cross(b).norm() / 6;
    }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    ASSERT_NEAR((surface.normals[i] - normals[i].normalized()).norm(), 0, 1e-14) << i;
    ASSERT_NEAR(surface.areas[i], areas[i], 1e-14 * areas[i]) << i;
  }
}

TEST(LargeSurface, BorderEdgesAreThoseOfOneFace) {
  Mesh holed = hills();
  auto& block = holed.blocks[0];
  block.nodes.erase(block.nodes.begin() + 3000, block.nodes.begin() + 6000);
  block.tags.erase(block.tags.begin() + 1000, block.tags.begin() + 2000);
  for (const Mesh& mesh : {hills(), holed, test::icosphere(5)}) {
    const Surface surface = select_surface(mesh);
    std::vector<std::array<Index, 2>> expected;
    for (const auto& [edge, n] : faces_of_edges(surface))
      if (n == 1) expected.push_back(edge);
    EXPECT_EQ(surface.border_edges, expected);
    EXPECT_EQ(surface.n_border_edges, static_cast<Index>(expected.size()));
  }
}

// Two spheres inside out and right side out, two plates of which 40 % and 60 % look down.
TEST(LargeSurface, EachPieceLooksItsOwnWay) {
  std::vector<Vec3> nodes;
  std::vector<Index> triangles;
  const auto add = [&](const Mesh& mesh, const Vec3& at, auto&& is_turned) {
    const auto first = static_cast<Index>(nodes.size());
    for (const Vec3& x : mesh.nodes) nodes.push_back(at + x);
    for (Index e = 0; e < mesh.blocks[0].size(); ++e) {
      auto face = mesh.blocks[0].element(e);
      std::array<Index, 3> corners = {first + face[0], first + face[1], first + face[2]};
      if (is_turned(e)) std::swap(corners[1], corners[2]);
      triangles.insert(triangles.end(), corners.begin(), corners.end());
    }
  };
  const Mesh ball = test::icosphere(5), plate = test::plate(100);
  add(ball, Vec3(0, 0, 0), [](Index) { return true; });
  add(plate, Vec3(2, 0, 5), [](Index e) { return e % 5 < 2; });
  add(ball, Vec3(4, 0, 0), [](Index) { return false; });
  add(plate, Vec3(6, 0, 5), [](Index e) { return e % 5 < 3; });
  const Surface surface = select_surface(test::surface_mesh(nodes, triangles));
  EXPECT_EQ(surface.n_components, 4);
  for (Index i = 0; i < surface.n_points(); ++i) {
    const Vec3& x = surface.points[i];
    const Vec3 centre(x.x() < 2 ? 0 : 4, 0, 0);
    const Vec3 expected =
        x.z() < 3 ? Vec3((x - centre).normalized()) : Vec3(0, 0, x.x() < 5 ? 1 : -1);
    ASSERT_NEAR((surface.normals[i] - expected).norm(), 0, 1e-12);
  }
}

TEST(LargeSurface, AnEdgeIsSharpBeyondTheAngle) {
  for (const double angle : {1e-3, 0.3, 0.7, 1.5, 1.6, 2.5, 3.1})
    for (const double turn : {-angle, angle}) {
      const auto n_sharp = [&](double limit) {
        return select_surface(roof(turn), {.sharp_angle = limit}).n_sharp_edges;
      };
      EXPECT_EQ(n_sharp(angle * (1 - 1e-9)), 1) << angle;
      EXPECT_EQ(n_sharp(angle * (1 + 1e-9)), 0) << angle;
      EXPECT_EQ(n_sharp(0), 1) << angle;
    }
}

}  // namespace
}  // namespace roughmesh
