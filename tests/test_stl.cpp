// SPDX-License-Identifier: BSD-3-Clause
// STL: equal corners are one node, triangles stay as they are, normals of moved triangles are true.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

// On machines of either byte order: STL is little-endian.
void append_float(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((bits >> shift) & 0xff);
}

float float_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < 4; ++k)
    bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + k])) << (8 * k);
  return std::bit_cast<float>(bits);
}

Vec3 triple_at(const std::string& bytes, std::size_t offset) {
  return {float_at(bytes, offset), float_at(bytes, offset + 4), float_at(bytes, offset + 8)};
}

// A header that begins with "solid", as some exporters write, normals of zero, and an attribute for
// each triangle that counts up.
std::string binary_stl(const Mesh& mesh) {
  std::string bytes = "solid but binary";
  bytes.resize(80, ' ');
  const auto n = static_cast<std::uint32_t>(n_elements(mesh));
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((n >> shift) & 0xff);
  for (Index f = 0; f < static_cast<Index>(n); ++f) {
    for (int k = 0; k < 3; ++k) append_float(bytes, 0);
    for (const Index node : mesh.blocks[0].element(f))
      for (const double c : mesh.nodes[static_cast<std::size_t>(node)]) append_float(bytes, c);
    bytes += static_cast<char>(f % 100);
    bytes += '\x7f';
  }
  return bytes;
}

const char* const two_solids =
    "solid left side\r\n"
    " FACET normal 0 0 9\r\n"
    "  outer   loop\r\n"
    "   vertex 0 0 0\r\n"
    "   vertex  1.000 0\t0\r\n"
    "   vertex 0 1 0\r\n"
    "  endloop\r\n"
    " endfacet\r\n"
    "endsolid left side\r\n"
    "\r\n"
    "solid right side\n"
    "facet normal nan nan nan outer loop vertex 1 0 -0 vertex 1 1 0.5e0 vertex 0 1 0 endloop "
    "endfacet\n"
    "endsolid";

class Stl : public testing::Test {
 protected:
  Mesh read(const std::string& bytes) {
    test::write_bytes(folder / "a.stl", bytes);
    return read_mesh(folder / "a.stl");
  }
  std::string written(const Mesh& mesh) {
    write_mesh(mesh, folder / "b.stl");
    return test::read_bytes(folder / "b.stl");
  }
  test::TemporaryFolder folder;
};

}  // namespace

TEST_F(Stl, BinaryCornersAtEqualPositionsAreOneNode) {
  const Mesh sphere = test::icosphere(2);
  const Mesh mesh = read(binary_stl(sphere));
  EXPECT_EQ(mesh.format, MeshFormat::stl);
  ASSERT_EQ(mesh.n_nodes(), sphere.n_nodes());
  ASSERT_EQ(n_elements(mesh), n_elements(sphere));
  for (Index f = 0; f < mesh.blocks[0].size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& x = sphere.nodes[static_cast<std::size_t>(sphere.blocks[0].element(f)[k])];
      EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(mesh.blocks[0].element(f)[k])],
                x.cast<float>().cast<double>());
    }
  EXPECT_EQ(mesh.blocks[0].tags.back(), mesh.blocks[0].size());
}

TEST_F(Stl, ComesOutIdenticalWhenNothingMoves) {
  for (const std::string& bytes : {binary_stl(test::icosphere(1)), std::string(two_solids)})
    EXPECT_EQ(written(read(bytes)), bytes);
}

TEST_F(Stl, NamedSolidsAreGroups) {
  const Mesh mesh = read(two_solids);
  EXPECT_EQ(mesh.n_nodes(), 4);  // (1, 0, 0) and (1, 0, -0) are one
  ASSERT_EQ(mesh.groups.size(), 2);
  EXPECT_EQ(mesh.groups[0].name, "left side");
  EXPECT_EQ(mesh.groups[1].name, "right side");
  EXPECT_EQ(mesh.groups[1].dimension, 2);
  ASSERT_EQ(mesh.blocks.size(), 2);
  EXPECT_EQ(mesh.blocks[1].physical_groups, std::vector<Tag>{2});
  EXPECT_EQ(mesh.blocks[1].entity, 2);
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{1, 3, 2}));
}

TEST_F(Stl, SolidsOfOneNameAreOneGroup) {
  std::string bytes = two_solids;
  bytes.replace(bytes.find("right"), 5, "left");
  const Mesh mesh = read(bytes);
  EXPECT_EQ(mesh.groups.size(), 1);
  EXPECT_EQ(mesh.blocks[1].physical_groups, mesh.blocks[0].physical_groups);
}

TEST_F(Stl, TextChangesInMovedCornersAndTheirNormalsOnly) {
  Mesh mesh = read(two_solids);
  mesh.nodes[3] = {1, 1, 0};  // of the second triangle only, which is flat then
  std::string expected = two_solids;
  expected.replace(expected.find("nan nan nan"), 11, "0 0 1");
  expected.replace(expected.find("0.5e0"), 5, "0");
  EXPECT_EQ(written(mesh), expected);
}

// The unit normal of a triangle of the written, rounded positions is within a rounding of float32
// (half of 2^-24 for components in [1/2, 1)) of what stands in the file.
TEST_F(Stl, BinaryNormalsFollowTheCornersAndAttributesStay) {
  const std::string before = binary_stl(test::icosphere(1));
  Mesh mesh = read(before);
  for (Vec3& x : mesh.nodes) x = Vec3(1.1 * x[0], x[1] / 3, x[2] + 1e-3 * x[0]);
  const std::string after = written(mesh);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(after.substr(0, 84), before.substr(0, 84));
  for (std::size_t f = 84; f < after.size(); f += 50) {
    const Vec3 a = triple_at(after, f + 12), b = triple_at(after, f + 24),
               c = triple_at(after, f + 36);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    EXPECT_LT((triple_at(after, f) - normal).lpNorm<Eigen::Infinity>(), std::ldexp(1.0, -24));
    EXPECT_EQ(after.substr(f + 48, 2), before.substr(f + 48, 2));
  }
  const Mesh again = read(after);
  ASSERT_EQ(again.n_nodes(), mesh.n_nodes());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    EXPECT_EQ(again.nodes[i], mesh.nodes[i].cast<float>().cast<double>());  // nearest float32
}

TEST_F(Stl, TrianglesWithoutAreaHaveNoNormal) {
  Mesh mesh = read(binary_stl(test::plate(1)));
  for (Vec3& x : mesh.nodes) x = Vec3(x[0] + x[1], 0, 0);
  const std::string bytes = written(mesh);
  for (std::size_t f = 84; f < bytes.size(); f += 50) EXPECT_EQ(triple_at(bytes, f), Vec3::Zero());
}

TEST_F(Stl, NormalsSurviveTheSmallestAndLargestTriangles) {
  for (const double scale : {1e-42, 1e-30, 1e30, 3e38}) {
    Mesh mesh = read(binary_stl(test::plate(1)));
    for (Vec3& x : mesh.nodes) x *= scale;
    EXPECT_EQ(triple_at(written(mesh), 84), Vec3(0, 0, 1)) << scale;
  }
}

TEST_F(Stl, PositionsBeyondFloat32AreRefused) {
  Mesh mesh = read(binary_stl(test::plate(1)));
  mesh.nodes[0] = {1e39, 0, 0};
  EXPECT_THROW(written(mesh), InputError);
  EXPECT_EQ(folder.n_files(), 1);
}

// 5 lies in the binade [4, 8), whose float32 numbers are 4 * 2^-23 apart.
TEST_F(Stl, CoordinateSpacingIsThatOfTheFile) {
  std::string text = two_solids;
  text.replace(text.find("1.000"), 5, "5");
  EXPECT_EQ(coordinate_spacing(read(text)), std::ldexp(4.0, -52));
  EXPECT_EQ(coordinate_spacing(read(binary_stl(test::plate(1, 5.0)))), std::ldexp(4.0, -23));
}
