// SPDX-License-Identifier: BSD-3-Clause
// MSH 2.2 and 4.1 written anew, as text and as bytes.
#include <gtest/gtest.h>

#include "support/cells.hpp"
#include "support/format_files.hpp"
#include "support/msh_files.hpp"

using namespace roughmesh;

namespace {

struct Target {
  MeshFormat format;
  Encoding encoding;
};

void PrintTo(const Target& target, std::ostream* stream) {
  *stream << name(target.format) << (target.encoding == Encoding::text ? "_text" : "_binary");
}

class NewMsh : public testing::TestWithParam<Target> {
 protected:
  Mesh written(const Mesh& mesh) {
    write_mesh(mesh, folder / "a.msh",
               {.format = GetParam().format, .encoding = GetParam().encoding});
    return read_mesh(folder / "a.msh");
  }

  test::TemporaryFolder folder;
};

// 2.2 lists an element once for each of its groups, which the reader puts together again.
Mesh plate_in_several_groups() {
  Mesh mesh = test::plate(2);
  ElementBlock& block = mesh.blocks[0];
  ElementBlock rest = block;
  block.physical_groups = {1, 4, 9};
  block.nodes.resize(9);
  block.tags.resize(3);
  rest.physical_groups = {4};
  rest.nodes.erase(rest.nodes.begin(), rest.nodes.begin() + 9);
  rest.tags.erase(rest.tags.begin(), rest.tags.begin() + 3);
  mesh.blocks.push_back(rest);
  mesh.groups = {{2, 1, "one"}, {2, 4, "four"}, {2, 9, ""}};
  return mesh;
}

TEST_P(NewMsh, HoldsAllButUnnamedGroupsThatNothingIsIn) {
  for (Mesh mesh : {test::zoo(), test::ball_in_box(4), test::icosphere(1)}) {
    const Mesh read = written(mesh);
    mesh.format = GetParam().format;
    EXPECT_EQ(read.nodes, mesh.nodes);
    test::expect_same_topology(read, mesh);
    ASSERT_EQ(read.periodic_links.size(), mesh.periodic_links.size());
    for (std::size_t i = 0; i < mesh.periodic_links.size(); ++i) {
      EXPECT_EQ(read.periodic_links[i].affine, mesh.periodic_links[i].affine);
      EXPECT_EQ(read.periodic_links[i].nodes, mesh.periodic_links[i].nodes);
    }
  }
}

TEST_P(NewMsh, KeepsElementsInAllTheirGroups) {
  const Mesh mesh = plate_in_several_groups();
  const Mesh read = written(mesh);
  std::map<Tag, std::vector<Tag>> groups;
  for (const ElementBlock& block : read.blocks)
    for (const Tag tag : block.tags) groups[tag] = block.physical_groups;
  ASSERT_EQ(groups.size(), 8);
  for (const auto& [tag, list] : groups)
    EXPECT_EQ(list, tag <= 3 ? (std::vector<Tag>{1, 4, 9}) : std::vector<Tag>{4}) << tag;
  EXPECT_TRUE(conversion_losses(mesh, folder / "a.msh",
                                {.format = GetParam().format, .encoding = GetParam().encoding})
                  .empty());
}

// Written, read and written again there is nothing left to change.
TEST_P(NewMsh, IsTheSameWhenWrittenTwice) {
  const Mesh read = written(test::zoo());
  const std::string bytes = test::read_bytes(folder / "a.msh");
  Mesh made = read;
  made.source.reset();
  written(made);
  EXPECT_EQ(test::read_bytes(folder / "a.msh"), bytes);
}

// gmsh keeps the groups of 2.2 by the entity of an element.
// A double quote ends a name, and a line break the line that it stands in.
TEST_P(NewMsh, KeepsTheFileWholeWhateverANameHolds) {
  Mesh mesh = test::icosphere(1);
  mesh.groups[0].name = "a\"b\n$Nodes\n\x7f";
  const Mesh read = written(mesh);
  EXPECT_EQ(read.groups[0].name, "a'b_$Nodes__");
  EXPECT_EQ(read.nodes, mesh.nodes);
  const auto losses = conversion_losses(mesh, folder / "a.msh", {.format = GetParam().format});
  EXPECT_EQ(losses, std::vector<std::string>{
                        "quotes and control characters in the names of 1 physical groups"});
}

TEST_P(NewMsh, IsReadByGmsh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh = test::ball_in_box(4);
  written(mesh);
  EXPECT_EQ(test::elements_by_position(test::seen_by_gmsh(folder, "a.msh")),
            test::elements_by_position(mesh));
}

TEST_P(NewMsh, IsReadByMeshio) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  written(test::ball_in_box(4));
  EXPECT_EQ(test::seen_by_meshio(folder, "a.msh",
                                 "print(len(m.points), sum(len(c.data) for c in m.cells),"
                                 " sum(sum(x) for x in m.cell_data['gmsh:physical']))\n"),
            // 48 + 192 triangles, 6 (8 + 56) tetrahedra, in groups 1 and 2 of each dimension
            fmt::format("\n125 {} {}\n", 240 + 384, 48 + 2 * 192 + 48 + 2 * 336));
}

INSTANTIATE_TEST_SUITE_P(Targets, NewMsh,
                         testing::Values(Target{MeshFormat::msh2, Encoding::text},
                                         Target{MeshFormat::msh2, Encoding::binary},
                                         Target{MeshFormat::msh4, Encoding::text},
                                         Target{MeshFormat::msh4, Encoding::binary}),
                         testing::PrintToStringParamName());

}  // namespace

TEST(WriteMsh, StaysInTheEncodingOfTheSourceWhenMoreThanPositionsChanged) {
  const test::TemporaryFolder folder;
  for (const test::MshStyle& style : test::all_msh_styles()) {
    Mesh mesh = test::read_as(folder, "a.msh", test::msh_bytes(test::zoo(), style));
    mesh.groups[1].name = "renamed";
    write_mesh(mesh, folder / "b.msh");
    const std::string bytes = test::read_bytes(folder / "b.msh");
    EXPECT_EQ(bytes.substr(12, 5),
              fmt::format("{} {}", style.version == 2 ? "2.2" : "4.1", style.binary ? 1 : 0));
  }
}

TEST(WriteMsh, GivesRepeatedListingsNumbersOfTheirOwn) {
  const test::TemporaryFolder folder;
  write_mesh(plate_in_several_groups(), folder / "a.msh", {.format = MeshFormat::msh2});
  const std::string bytes = test::read_bytes(folder / "a.msh");
  // Eight elements; three of them are in three groups, so there are six listings more.
  EXPECT_NE(bytes.find("$Elements\n14\n1 2 2 1 1 1 2 5\n"), std::string::npos) << bytes;
  EXPECT_NE(bytes.find("\n9 2 2 4 1 1 2 5\n"), std::string::npos) << bytes;
  EXPECT_NE(bytes.find("\n14 2 2 9 1 "), std::string::npos) << bytes;
}

// Gmsh loses its place in the links where one names an entity that the file does not list.
TEST(WriteMsh, ListsThePointsAndCurvesThatLinksName) {
  Mesh mesh = test::plate(2);  // nodes 0 and 2 are ends of the side y = 0
  mesh.periodic_links = {{0, 9, 7, {}, {{2, 0}}}, {1, 5, 6, {}, {{2, 0}, {5, 3}}}};
  const test::TemporaryFolder folder;
  write_mesh(mesh, folder / "linked.msh",
             {.fields = {}, .format = MeshFormat::msh4, .encoding = Encoding::text});
  const std::string text = test::read_bytes(folder / "linked.msh");
  const std::size_t begin = text.find("$Entities\n");
  ASSERT_NE(begin, text.npos);
  EXPECT_EQ(text.substr(begin + 10, 8), "2 2 1 0\n");
  EXPECT_NE(text.find("\n7 0 0 0 0", begin), text.npos);  // place of node 0, no group
  EXPECT_EQ(read_mesh(folder / "linked.msh").periodic_links.size(), 2u);
}

TEST(WriteMsh, RefusesNumbersThatTheVersionCannotHold) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::plate(1);
  mesh.node_tags[0] = 3'000'000'000;
  EXPECT_THROW(write_mesh(mesh, folder / "a.msh", {.format = MeshFormat::msh2}), InputError);
  write_mesh(mesh, folder / "b.msh", {.encoding = Encoding::binary});
  EXPECT_EQ(read_mesh(folder / "b.msh").node_tags, mesh.node_tags);
  mesh = test::plate(1);
  mesh.blocks[0].tags[0] = std::numeric_limits<Tag>::max();
  EXPECT_THROW(write_mesh(mesh, folder / "a.msh", {.format = MeshFormat::msh2}), InputError);
  mesh = test::plate(1);
  mesh.blocks[0].physical_groups = {3'000'000'000};
  for (const MeshFormat format : {MeshFormat::msh2, MeshFormat::msh4})
    EXPECT_THROW(write_mesh(mesh, folder / "a.msh", {.format = format}), InputError);
  EXPECT_EQ(folder.n_files(), 1);
}
