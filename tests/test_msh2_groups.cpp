// SPDX-License-Identifier: BSD-3-Clause
// MSH 2.2 lists an element once for each of its groups; a mesh has it once.
#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"

using namespace roughmesh;
using test::MshStyle;

namespace {

using Nodes = std::vector<Index>;
using Groups = std::vector<Tag>;

const std::string five_nodes =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
    "5 1 1 1\n$EndNodes\n";

Mesh read_elements(const test::TemporaryFolder& folder, const std::vector<std::string>& elements) {
  std::string bytes = five_nodes + "$Elements\n" + std::to_string(elements.size()) + "\n";
  for (std::size_t i = 0; i < elements.size(); ++i)
    bytes += std::to_string(i + 1) + " " + elements[i] + "\n";
  test::write_bytes(folder / "a.msh", bytes + "$EndElements\n");
  return read_mesh(folder / "a.msh");
}

void expect_block(const ElementBlock& block, Tag entity, const Groups& groups, const Nodes& nodes,
                  const std::vector<Tag>& tags) {
  EXPECT_EQ(block.entity, entity);
  EXPECT_EQ(block.physical_groups, groups);
  EXPECT_EQ(block.nodes, nodes);
  EXPECT_EQ(block.tags, tags);
}

/// Nodes, as sets, of the elements of each (type, entity, groups).
std::map<std::tuple<std::string, Tag, Groups>, std::multiset<Nodes>> contents(const Mesh& mesh) {
  std::map<std::tuple<std::string, Tag, Groups>, std::multiset<Nodes>> result;
  for (const ElementBlock& block : mesh.blocks)
    for (Index i = 0; i < block.size(); ++i) {
      Nodes nodes(block.element(i).begin(), block.element(i).end());
      std::sort(nodes.begin(), nodes.end());
      result[{name(block.type), block.entity, block.physical_groups}].insert(nodes);
    }
  return result;
}

/// A block for each of its groups: what MSH 2.2 makes of a mesh.
Mesh listed_per_group(const Mesh& mesh) {
  Mesh listed = mesh;
  listed.blocks.clear();
  for (const ElementBlock& block : mesh.blocks)
    for (const Tag group : block.physical_groups) {
      listed.blocks.push_back(block);
      listed.blocks.back().physical_groups = {group};
    }
  return listed;
}

/// A ball of gold in a box of air; everything is in a third group too.
Mesh ball_in_overlapping_groups() {
  Mesh mesh = test::ball_in_box(4);
  Tag all = 0;
  for (const PhysicalGroup& group : mesh.groups) all = std::max(all, group.tag + 1);
  for (ElementBlock& block : mesh.blocks)
    if (dimension(block.type.shape) == 3) block.physical_groups.push_back(all);
  mesh.groups.push_back({3, all, "all"});
  return mesh;
}

}  // namespace

class Msh2Groups : public testing::TestWithParam<bool> {};

TEST_P(Msh2Groups, ReadsTheSameMeshAsFromMsh4) {
  const test::TemporaryFolder folder;
  const Mesh made = ball_in_overlapping_groups();
  const MshStyle style2{.version = 2, .binary = GetParam()};
  const std::string bytes = test::msh_bytes(listed_per_group(made), style2);
  test::write_bytes(folder / "2.msh", bytes);
  write_mesh(made, folder / "4.msh");
  const Mesh mesh2 = read_mesh(folder / "2.msh"), mesh4 = read_mesh(folder / "4.msh");
  EXPECT_EQ(contents(mesh2), contents(mesh4));
  EXPECT_EQ(n_elements(mesh2), n_elements(made));
  EXPECT_EQ(mesh2.blocks.size(), made.blocks.size());
  write_mesh(mesh2, folder / "out.msh");
  EXPECT_EQ(test::read_bytes(folder / "out.msh"), bytes);
}

INSTANTIATE_TEST_SUITE_P(Styles, Msh2Groups, testing::Bool(),
                         [](const auto& test) { return test.param ? "binary" : "text"; });

// Groups 5 = {a, b}, 6 = {b, c}: three sets; the triangle in between keeps its place.
TEST(ReadMsh2, MakesABlockForEachSetOfGroups) {
  const test::TemporaryFolder folder;
  const Mesh mesh =
      read_elements(folder, {"4 2 5 1 1 2 3 4", "4 2 5 1 1 2 3 5", "2 2 5 1 1 2 3",
                             "4 2 6 1 1 2 3 5", "4 2 6 1 1 2 4 5", "4 2 6 2 1 2 4 5"});
  ASSERT_EQ(mesh.blocks.size(), 5);
  expect_block(mesh.blocks[0], 1, {5}, {0, 1, 2, 3}, {1});
  expect_block(mesh.blocks[1], 1, {5, 6}, {0, 1, 2, 4}, {2});
  expect_block(mesh.blocks[2], 1, {5}, {0, 1, 2}, {3});
  expect_block(mesh.blocks[3], 1, {6}, {0, 1, 3, 4}, {5});
  expect_block(mesh.blocks[4], 2, {6}, {0, 1, 3, 4}, {6});
  EXPECT_EQ(mesh.groups.size(), 3);
}

// Gmsh reverses elements in groups of reversed entities; the first listing decides.
TEST(ReadMsh2, TakesReversedListingsForTheSameElement) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_elements(folder, {"2 2 9 1 1 3 2", "2 2 -4 1 1 2 3", "2 2 0 1 2 3 1"});
  ASSERT_EQ(mesh.blocks.size(), 1);
  expect_block(mesh.blocks[0], 1, {4, 9}, {0, 2, 1}, {1});
}

TEST(ReadMsh2, KeepsApartWhatOneGroupOrOneTypeListsTwice) {
  const test::TemporaryFolder folder;
  // Two triangles back to back, both in groups 1 and 2; an element without an entity.
  const Mesh pillow = read_elements(
      folder, {"2 2 1 1 1 2 3", "2 2 1 1 1 3 2", "2 2 2 1 1 2 3", "2 2 2 1 1 3 2", "2 0 1 2 3"});
  ASSERT_EQ(pillow.blocks.size(), 2);
  expect_block(pillow.blocks[0], 1, {1, 2}, {0, 1, 2, 0, 2, 1}, {1, 2});
  expect_block(pillow.blocks[1], 0, {}, {0, 1, 2}, {5});
  // A group without an entity; 0 is no group.
  const Mesh no_entity = read_elements(folder, {"2 1 7 1 2 3", "2 2 0 0 1 2 4"});
  ASSERT_EQ(no_entity.blocks.size(), 2);
  expect_block(no_entity.blocks[0], 0, {7}, {0, 1, 2}, {1});
  expect_block(no_entity.blocks[1], 0, {}, {0, 1, 3}, {2});
  // A quadrangle and a tetrahedron on the same nodes.
  EXPECT_EQ(n_elements(read_elements(folder, {"3 2 1 1 1 2 3 4", "4 2 2 1 1 2 3 4"})), 2);
}

TEST(ReadMsh2, ReadsWhatGmshWritesOfOverlappingGroups) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.geo",
                    "SetFactory(\"OpenCASCADE\");\n"
                    "Box(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {1, 0, 0, 1, 1, 1};\n"
                    "BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n"
                    "Physical Volume(\"all\") = {1, 2};\nPhysical Volume(\"gold\") = {1};\n"
                    "Physical Volume(\"air\") = {2};\nPhysical Surface(\"front\") = {1};\n"
                    "Physical Surface(\"sides\") = {-1, 2};\nMesh.MeshSizeMax = 0.5;\n");
  const auto gmsh = [&](const std::string& arguments) {
    return test::run("cd " + folder.path().string() + " && gmsh " + arguments + " > log 2>&1");
  };
  ASSERT_EQ(gmsh("-3 -format msh41 -o 4.msh a.geo"), 0);
  ASSERT_EQ(gmsh("-save -format msh22 -o 2.msh 4.msh"), 0);
  ASSERT_EQ(gmsh("-save -bin -format msh22 -o 2b.msh 4.msh"), 0);
  const Mesh mesh4 = read_mesh(folder / "4.msh");
  for (const char* file : {"2.msh", "2b.msh"}) {
    const Mesh mesh2 = read_mesh(folder / file);
    EXPECT_EQ(n_elements(mesh2, 3), n_elements(mesh4, 3));
    EXPECT_EQ(n_elements(mesh2), n_elements(mesh4));
    EXPECT_EQ(contents(mesh2), contents(mesh4));
  }
}
