// SPDX-License-Identifier: BSD-3-Clause
// STL written anew: the triangles of a mesh, with true normals; quadrangles as two triangles each.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/errors.hpp"
#include "support/refusals.hpp"
#include "support/surface_checks.hpp"

using namespace roughmesh;

namespace {

class NewStl : public testing::Test {
 protected:
  std::string written(const Mesh& mesh, Encoding encoding) const {
    write_mesh(mesh, folder / "a.stl", {.encoding = encoding});
    return test::read_bytes(folder / "a.stl");
  }
  Mesh read_back() const { return read_mesh(folder / "a.stl"); }
  test::TemporaryFolder folder;
};

// Positions of the corners of each triangle, in the order of the mesh.
std::vector<Vec3> corners(const Mesh& mesh) {
  std::vector<Vec3> positions;
  for (const ElementBlock& block : mesh.blocks)
    if (block.type == test::triangle_type)
      for (const Index node : block.nodes)
        positions.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
  return positions;
}

}  // namespace

TEST_F(NewStl, HoldsTheTrianglesOfAMesh) {
  const Mesh made = test::ball_in_box(4);
  written(made, Encoding::text);
  EXPECT_EQ(corners(read_back()), corners(made));
  written(made, Encoding::binary);
  std::vector<Vec3> rounded = corners(made);
  for (Vec3& x : rounded) x = test::as_float(x);
  EXPECT_EQ(corners(read_back()), rounded);
}

TEST_F(NewStl, IsBinaryUnlessAskedForText) {
  const Mesh made = test::icosphere(1);
  write_mesh(made, folder / "b.stl");
  const std::string bytes = written(made, Encoding::binary);
  EXPECT_EQ(test::read_bytes(folder / "b.stl"), bytes);
  EXPECT_EQ(bytes.size(), 84 + 80 * 50);
  EXPECT_EQ(read_back().n_nodes(), made.n_nodes());
}

// Quadrangle 0 1 2 3 has the shorter diagonal 1-3, then 0-2; both cuts keep the orientation.
TEST_F(NewStl, QuadranglesAreCutAlongTheirShorterDiagonal) {
  for (const double x : {2.0, 0.5}) {
    Mesh made;
    made.nodes = {{0, 0, 0}, {1, 0, 0}, {x, x, 0}, {0, 1, 0}};
    made.blocks = {test::make_block(test::quadrangle_type, 0, {}, {0, 1, 2, 3}, 1)};
    test::number_nodes(made);
    written(made, Encoding::binary);
    const Mesh mesh = read_back();
    ASSERT_EQ(n_elements(mesh), 2);
    const auto area = [&](Index f) {
      const auto t = mesh.blocks[0].element(f);
      const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(t[k])]; };
      return (at(1) - at(0)).cross(at(2) - at(0)).z() / 2;
    };
    const bool cuts13 = x > 1;
    EXPECT_EQ(area(0), cuts13 ? 0.5 : 0.25);
    EXPECT_EQ(area(1), cuts13 ? 1.5 : 0.25);
    EXPECT_EQ(conversion_losses(made, folder / "b.stl").front(),
              "1 quadrangles, which become two triangles each");
  }
}

TEST_F(NewStl, GroupsAreSolidsOfText) {
  Mesh made = test::plate(1);
  made.blocks = {test::make_block(test::triangle_type, 1, {4}, {0, 1, 3}, 1),
                 test::make_block(test::triangle_type, 2, {}, {0, 3, 2}, 2),
                 test::make_block(test::triangle_type, 3, {4}, {1, 3, 2}, 3),
                 test::make_block(test::triangle_type, 4, {5}, {0, 1, 2}, 4)};
  made.groups = {{2, 4, "left side"}, {2, 5, ""}};
  const std::string bytes = written(made, Encoding::text);
  EXPECT_EQ(bytes.find("solid left side\nfacet normal 0 0 1\n  outer loop\n    vertex 0 0 0\n"), 0);
  const Mesh mesh = read_back();
  ASSERT_EQ(mesh.groups.size(), 2);
  EXPECT_EQ(mesh.groups[0].name, "left side");
  EXPECT_EQ(mesh.groups[1].name, "group_5");
  ASSERT_EQ(mesh.blocks.size(), 3);
  EXPECT_EQ(mesh.blocks[0].size(), 2);
  EXPECT_TRUE(mesh.blocks[1].physical_groups.empty());
  EXPECT_EQ(conversion_losses(made, folder / "a.stl", {.encoding = Encoding::text}),
            std::vector<std::string>{"numbers of 2 physical groups"});
  EXPECT_EQ(conversion_losses(made, folder / "a.stl"),
            (std::vector<std::string>{"2 physical groups", "digits of positions beyond float32"}));
}

TEST_F(NewStl, RefusesWhatItCannotHold) {
  Mesh volume = test::ball_in_box(4);
  volume.blocks.erase(volume.blocks.begin(), volume.blocks.begin() + 2);
  EXPECT_NE(test::message_of([&] { written(volume, Encoding::text); }).find("no surface elements"),
            std::string::npos);
  Mesh large = test::plate(1, 1e39);
  EXPECT_NE(test::message_of([&] { written(large, Encoding::binary); }).find("float32"),
            std::string::npos);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST_F(NewStl, IsReadByGmsh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh made = test::icosphere(2);
  for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
    written(made, encoding);
    ASSERT_EQ(test::run("gmsh -save -format msh41 -o " + (folder / "b.msh").string() + " " +
                        (folder / "a.stl").string() + " > /dev/null 2>&1"),
              0);
    const Mesh mesh = read_mesh(folder / "b.msh");
    EXPECT_EQ(mesh.n_nodes(), made.n_nodes());
    EXPECT_EQ(n_elements(mesh, 2), n_elements(made, 2));
  }
}

// What the file's facets say, computed from its own corners: to the rounding of float32.
TEST_F(NewStl, NormalsAreThoseOfTheCorners) {
  const std::string bytes = written(test::icosphere(1), Encoding::binary);
  const auto triple = [&](std::size_t offset) {
    std::array<float, 3> x{};
    std::memcpy(x.data(), bytes.data() + offset, sizeof x);
    return Vec3(double{x[0]}, double{x[1]}, double{x[2]});
  };
  for (std::size_t f = 84; f < bytes.size(); f += 50) {
    const Vec3 a = triple(f + 12), b = triple(f + 24), c = triple(f + 36);
    EXPECT_LT((triple(f) - (b - a).cross(c - a).normalized()).lpNorm<Eigen::Infinity>(),
              std::ldexp(1.0, -24));
  }
}

// Corners are glued by a hash of their positions, which must decide nothing.
TEST_F(NewStl, CornersAreGluedByPositionAlone) {
  Mesh made;
  std::vector<Index> faces;
  for (int i = 0; i < 30'000; ++i) {
    const double x = std::floor(i / 5.0);  // every position five times
    made.nodes.emplace_back(x, x * x, i % 2 == 0 ? 0.0 : -0.0);
    faces.push_back(i);
  }
  made.blocks = {test::make_block(test::triangle_type, 0, {}, faces, 1)};
  test::number_nodes(made);
  written(made, Encoding::text);
  const Mesh mesh = read_back();
  ASSERT_EQ(mesh.n_nodes(), 6'000);
  for (std::size_t c = 0; c < faces.size(); ++c)
    EXPECT_EQ(mesh.blocks[0].nodes[c], static_cast<Index>(c / 5));
}

TEST_F(NewStl, RealFilesComeOutIdenticalAndMove) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  const std::filesystem::path path = std::filesystem::path(data) / "meshes" / "aorta.stl";
  Mesh mesh = read_mesh(path);
  write_mesh(mesh, folder / "a.stl");
  EXPECT_EQ(test::read_bytes(folder / "a.stl"), test::read_bytes(path));
  for (Vec3& x : mesh.nodes) x = 1.25 * x + Vec3(0, 0, 1);
  write_mesh(mesh, folder / "a.stl");
  const Mesh again = read_back();
  ASSERT_EQ(again.n_nodes(), mesh.n_nodes());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    EXPECT_EQ(again.nodes[i], test::as_float(mesh.nodes[i]));
}
