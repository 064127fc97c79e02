// SPDX-License-Identifier: BSD-3-Clause
// Inverted elements of order 2 that their corners do not tell of.
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/mesh_io.hpp"

#include "curved_quality.hpp"
#include "support/curved.hpp"
#include "support/files.hpp"
#include "support/planar.hpp"
#include "support/text_formats.hpp"

using namespace roughmesh;

namespace {

Mesh box(ElementShape shape, bool complete) {
  return test::second_order(test::cell_box(shape, 2), complete);
}

std::vector<Mesh> curved_meshes() {
  std::vector<Mesh> meshes;
  for (const bool complete : {false, true}) {
    for (const ElementShape shape :
         {ElementShape::tetrahedron, ElementShape::hexahedron, ElementShape::prism})
      meshes.push_back(box(shape, complete));
    for (const bool quadrangles : {false, true})
      meshes.push_back(test::second_order(test::ring(16, quadrangles), complete));
  }
  return meshes;
}

const ElementBlock& cells_of(const Mesh& mesh) {
  return *std::find_if(mesh.blocks.begin(), mesh.blocks.end(), [&](const ElementBlock& block) {
    return dimension(block.type.shape) == dimension(mesh);
  });
}

/// The first edge of element 0 of the cells, its middle at this share of it.
struct SlidEdge {
  Index middle = -1;
  std::vector<Vec3> nodes;
};

SlidEdge slide(const Mesh& mesh, double share) {
  const ElementBlock& cells = cells_of(mesh);
  const auto [a, b] = local_edges(cells.type.shape)[0];
  const auto element = cells.element(0);
  SlidEdge result{element[static_cast<std::size_t>(n_corners(cells.type.shape))], mesh.nodes};
  result.nodes[result.middle] =
      (1 - share) * mesh.nodes[element[a]] + share * mesh.nodes[element[b]];
  return result;
}

std::int64_t n_cells_with(const Mesh& mesh, Index node) {
  std::int64_t n = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) == dimension(mesh) && e < block.size(); ++e) {
      const auto nodes = block.element(e);
      n += std::count(nodes.begin(), nodes.end(), node);
    }
  return n;
}

}  // namespace

// Past the quarter point all elements at the edge are inverted and no other; corners see nothing.
TEST(CurvedCheck, FindsEdgesThatFold) {
  for (const Mesh& mesh : curved_meshes()) {
    for (const double share : {0.26, 0.5, 0.74}) {
      const MeshCheck check = check_mesh(mesh, slide(mesh, share).nodes);
      EXPECT_TRUE(check.valid());
      EXPECT_GT(check.min_quality, 0);
      EXPECT_EQ(check.n_corners_only, 0);
    }
    for (const double share : {0.1, 0.24, 0.76}) {
      const SlidEdge slid = slide(mesh, share);
      const MeshCheck check = check_mesh(mesh, slid.nodes);
      EXPECT_EQ(check.inverted_elements, n_cells_with(mesh, slid.middle));
      ASSERT_FALSE(check.findings.empty());
      EXPECT_LE(check.findings[0].value, 0);
      EXPECT_EQ(check.findings[0].value, check.min_quality);
      EXPECT_EQ(check.findings[0].what, "inverted " + name(cells_of(mesh).type));
      const auto& tags = cells_of(mesh).tags;
      EXPECT_TRUE(std::any_of(check.findings.begin(), check.findings.end(),
                              [&](const Finding& f) { return f.element == tags[0]; }));
    }
  }
}

// In the mirror every element is negative and has to stay so; values are the same.
TEST(CurvedCheck, KeepsTheOrientationOfTheInput) {
  for (const Mesh& mesh : curved_meshes())
    for (const double share : {0.15, 0.3}) {
      Mesh mirrored = mesh;
      std::vector<Vec3> moved = slide(mesh, share).nodes;
      const MeshCheck expected = check_mesh(mesh, moved);
      for (auto* nodes : {&mirrored.nodes, &moved})
        for (Vec3& x : *nodes) x.x() = -x.x();
      const MeshCheck check = check_mesh(mirrored, moved);
      EXPECT_EQ(check.inverted_elements, expected.inverted_elements);
      EXPECT_NEAR(check.min_quality, expected.min_quality, 1e-14);
    }
}

// What was inverted before is no finding, but counted, and shows in the quality.
TEST(CurvedCheck, InvertedInTheInputIsNoFinding) {
  for (Mesh mesh : curved_meshes()) {
    const SlidEdge slid = slide(mesh, 0.1);
    mesh.nodes = slid.nodes;
    const MeshCheck check = check_mesh(mesh, mesh.nodes);
    EXPECT_TRUE(check.valid());
    EXPECT_EQ(check.curved_inverted_before, n_cells_with(mesh, slid.middle));
    EXPECT_LE(check.min_quality, 0);
    EXPECT_EQ(check.min_quality, min_quality(mesh));
  }
}

// Eq. 61 is 1 on straight simplices and parallelepipeds; of an edge of a triangle whose middle is
// at s, the least determinant is at its end: 4 s - 1 of the straight one.
TEST(CurvedCheck, QualityOfStraightAndOfSlidElements) {
  for (const ElementShape shape :
       {ElementShape::tetrahedron, ElementShape::hexahedron, ElementShape::prism})
    for (const bool complete : {false, true})
      EXPECT_NEAR(min_quality(box(shape, complete)), min_quality(test::cell_box(shape, 2)), 1e-14);
  for (const int n : {8, 9}) {  // whose determinant is linear, smallest at two corners
    const ElementType type{ElementShape::quadrangle, 2, n};
    Mesh trapezoid = test::single_element(type.shape, {{2, 1, 0}, {1, 1, 0}, {0, 0, 0}, {3, 0, 0}});
    trapezoid = test::second_order(trapezoid, n == 9);
    const auto quality = detail::curved_quality(type, trapezoid.blocks[0].nodes, trapezoid.nodes,
                                                {.sign = 1, .normal = Vec3::UnitZ()});
    EXPECT_NEAR(quality.value().value, 1, 1e-14);
  }
  Mesh triangle = test::single_curved({ElementShape::triangle, 2, 6});
  for (const double s : {0.3, 0.4, 0.55}) {
    triangle.nodes[3] = s * Vec3::UnitX();
    EXPECT_NEAR(min_quality(triangle), std::min(4 * s - 1, 3 - 4 * s), 1e-14);
  }
}

TEST(CurvedCheck, TellsWhatItSeesAtCornersOnly) {
  const Mesh pyramids = box(ElementShape::pyramid, true);
  EXPECT_EQ(check_mesh(pyramids, pyramids.nodes).n_corners_only, n_elements(pyramids, 3));
  const Mesh sphere = test::second_order(test::icosphere(1), true);
  EXPECT_EQ(check_mesh(sphere, sphere.nodes).n_corners_only, n_elements(sphere));
}

// One order of nodes in memory, whatever that of the file: with two nodes in each other's place an
// element is inverted.
TEST(CurvedCheck, ElementsOfEveryFormatAreStraight) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  for (const test::Cells cells : {test::Cells::tetrahedra, test::Cells::hexahedra})
    for (const std::string extension : {".msh", ".vtk", ".inp", ".mesh", ".unv"}) {
      if (cells == test::Cells::hexahedra && extension == ".mesh") continue;  // of order 1 there
      const Mesh mesh = read_mesh(test::gmsh_box(folder, extension, cells).string());
      const ElementBlock& block = cells_of(mesh);
      ASSERT_EQ(block.type,
                (cells == test::Cells::tetrahedra ? ElementType{ElementShape::tetrahedron, 2, 10}
                                                  : ElementType{ElementShape::hexahedron, 2, 20}))
          << extension;
      EXPECT_GT(min_quality(mesh), cells == test::Cells::tetrahedra ? 0.2 : 0.99) << extension;
      Mesh swapped = mesh;
      for (ElementBlock& each : swapped.blocks)
        if (each.type == block.type)
          for (Index e = 0; e < each.size(); ++e) {
            const auto end =
                each.nodes.begin() + static_cast<std::ptrdiff_t>(e + 1) * each.type.n_nodes;
            std::iter_swap(end - 1, end - 2);
          }
      EXPECT_LT(min_quality(swapped), 0) << extension;
      // By way of the other formats.
      for (const std::string other : {"b.msh", "b.vtk", "b.inp"}) {
        write_mesh(mesh, (folder / other).string());
        EXPECT_NEAR(min_quality(read_mesh((folder / other).string())), min_quality(mesh), 1e-5)
            << extension << " " << other;
      }
    }
}
