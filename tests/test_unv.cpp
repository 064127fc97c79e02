// SPDX-License-Identifier: BSD-3-Clause
// UNV: datasets that are read, those that are kept, numbers with D exponents, files written anew.
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/text_formats.hpp"

using namespace roughmesh;
using test::Kind;
using test::read_text;
using test::with;

namespace {

const char* const tetrahedron =
    "    -1\n"
    "   151\n"
    "a title\n"
    "    -1\n"
    "    -1\n"
    "   164\n"
    "         1SI: Meter (newton)           2\n"
    "   1.0000000000000000D+00   1.0000000000000000D+00   1.0000000000000000D+00\n"
    "    -1\n"
    "    -1\n"
    "  2411\n"
    "         1         1         1        11\n"
    "   0.0000000000000000D+00   0.0000000000000000D+00  -0.0000000000000000D+00\n"
    "        20         1         1        11\n"
    "   1.0000000000000000E+00   0.0000000000000000E+00   0.0000000000000000E+00\n"
    "         3         1         1        11\n"
    "0. 1 0.\n"
    "         4         1         1        11\n"
    "   0.0000000000000000D+00   0.0000000000000000D+00   1.0000000000000000D+00\n"
    "    -1\n"
    "    -1\n"
    "  2412\n"
    "         1        21         2         1         7         2\n"
    "         0         1         1\n"
    "         1        20\n"
    "         2        91         5         1         7         3\n"
    "         1         3        20\n"
    "         3       111         6         1         7         4\n"
    "         1        20\n"
    "         3         4\n"
    "         9       161         6         1         7         1\n"
    "         4\n"
    "    -1\n"
    "    -1\n"
    "  2467\n"
    "         7         0         0         0         0         0         0         3\n"
    "base and edge\n"
    "         8         2         0         0         8         1         0         0\n"
    "         7         4         0         0\n"
    "         8         0         0         0         0         0         0         2\n"
    "bulk\n"
    "         8         3         0         0         8         9         0         0\n"
    "    -1\n"
    "    -1\n"
    "  9999\n"
    "anything\n"
    "    -1\n";

using Members = std::map<std::pair<int, std::string>, std::vector<Tag>>;

}  // namespace

TEST(Unv, ReadsNodesElementsAndGroups) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {std::string(tetrahedron), test::with_crlf(tetrahedron)}) {
    const Mesh mesh = read_text(folder, "a.unv", bytes);
    EXPECT_EQ(mesh.format, MeshFormat::unv);
    EXPECT_EQ(mesh.node_tags, (std::vector<Tag>{1, 20, 3, 4}));
    EXPECT_EQ(mesh.nodes[1], Vec3(1, 0, 0));
    EXPECT_EQ(n_elements(mesh), 3);
    EXPECT_EQ(
        test::members(mesh),
        (Members{{{1, "base and edge"}, {1}}, {{2, "base and edge"}, {2}}, {{3, "bulk"}, {3}}}));
    EXPECT_EQ(mesh.blocks[2].entity, 6);
    EXPECT_EQ(mesh.blocks[2].nodes, (std::vector<Index>{0, 1, 2, 3}));
  }
}

TEST(Unv, ReadsTheOlderDatasets) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(
      folder, "a.unv",
      "    -1\n   781\n 1 0 0 1\n 0.D0 0. 0\n 2 0 0 1\n 1.D0 0. 0\n 3 0 0 1\n 0 1.D0 0\n    -1\n"
      "    -1\n   780\n 5 91 1 4 1 1 7 3\n 1 2 3\n    -1\n"
      "    -1\n  2430\n 3 0 0 0 0 0 0 3\nold\n 7 1 7 2 8 5\n    -1\n");
  EXPECT_EQ(test::members(mesh), (Members{{{2, "old"}, {5}}}));
  EXPECT_EQ(mesh.blocks[0].entity, 4);
}

TEST(Unv, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {std::string(tetrahedron), test::with_crlf(tetrahedron)}) {
    write_mesh(read_text(folder, "a.unv", bytes), folder / "b.unv");
    EXPECT_EQ(test::read_bytes(folder / "b.unv"), bytes);
  }
}

TEST(Unv, ChangesInMovedCoordinatesOnlyAndKeepsTheirColumns) {
  const test::TemporaryFolder folder;
  for (const bool crlf : {false, true}) {
    const auto ends = [&](const std::string& text) { return crlf ? test::with_crlf(text) : text; };
    const Mesh before = read_text(folder, "a.unv", ends(tetrahedron));
    Mesh mesh = before;
    mesh.nodes[0][2] = 0.5;
    mesh.nodes[1] = {1, -1.0 / 3, 1e100};
    mesh.nodes[2][1] = 2;
    write_mesh(mesh, folder / "b.unv");
    std::string expected = tetrahedron;
    expected = with(expected, "  -0.0000000000000000D+00", "   5.0000000000000000D-01");
    expected = with(expected, "   0.0000000000000000E+00   0.0000000000000000E+00",
                    "  -3.3333333333333331E-01  1.0000000000000000E+100");
    expected = with(expected, "0. 1 0.", "0. 2.0000000000000000E+00 0.");
    EXPECT_EQ(test::read_bytes(folder / "b.unv"), ends(expected));
    const Mesh again = read_mesh(folder / "b.unv");
    EXPECT_EQ(again.nodes, mesh.nodes);
    test::expect_same_elements(again, before);
  }
}

TEST(Unv, IsWrittenAnewAndReadBackExactly) {
  const test::TemporaryFolder folder;
  for (const Mesh& made : {test::ball_in_box(4), test::second_order_zoo(false), test::plate(2)}) {
    write_mesh(made, folder / "a.unv");
    const Mesh mesh = read_mesh(folder / "a.unv");
    EXPECT_EQ(mesh.nodes, made.nodes);
    test::expect_same_elements(mesh, made);
    EXPECT_EQ(test::members(mesh), test::members(made));
    for (std::size_t b = 0; b < made.blocks.size(); ++b)
      EXPECT_EQ(mesh.blocks[b].entity, made.blocks[b].entity);
  }
}

TEST(Unv, RefusesPyramidsAndCompleteElements) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_mesh(test::second_order_zoo(true), folder / "a.unv"), InputError);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST(Unv, IsReadByGmsh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  for (const Mesh& made : {test::ball_in_box(4), test::second_order_zoo(false)}) {
    write_mesh(made, folder / "a.unv");
    const Mesh mesh = test::seen_by_gmsh(folder, folder / "a.unv");
    EXPECT_EQ(mesh.n_nodes(), made.n_nodes());
    for (int d = 1; d <= 3; ++d) EXPECT_EQ(n_elements(mesh, d), n_elements(made, d));
    // Positions of the nodes of order 2 in the middles of their edges, to the rounding of gmsh.
    test::expect_middles(mesh, 1e-14);
    std::map<std::string, std::size_t> sizes, expected;
    for (const auto& [group, tags] : test::members(mesh)) sizes[group.second] = tags.size();
    for (const auto& [group, tags] : test::members(made)) expected[group.second] = tags.size();
    if (made.groups.size() == 4) {
      EXPECT_EQ(sizes, expected);  // of the other, gmsh ends names at a space
    }
  }
}

TEST(Unv, OfGmshHasItsNodesOnTheMiddlesOfEdges) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  for (const test::Cells cells :
       {test::Cells::tetrahedra, test::Cells::prisms, test::Cells::hexahedra}) {
    const test::TemporaryFolder folder;
    const Mesh mesh = read_mesh(test::gmsh_box(folder, ".unv", cells));
    EXPECT_TRUE(test::has_cells(mesh, cells));
    EXPECT_GT(test::expect_middles(mesh, 1e-14), 9);
    EXPECT_EQ(test::members(mesh).count({3, "inside"}), 1);
  }
}

TEST(Unv, SurvivesCutsAndDamage) {
  test::expect_survives_cuts("a.unv", tetrahedron);
  test::expect_survives_damage("a.unv", tetrahedron);
}

class UnvRefusal : public testing::TestWithParam<test::Refusal> {};

TEST_P(UnvRefusal, IsOneLine) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.unv", GetParam().bytes);
  test::expect_refused(folder / "a.unv", GetParam().kind, GetParam().part_of_message);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, with(tetrahedron, what, by), message, kind});
  };
  add("node_twice", "        20         1         1        11\n", " 3 1 1 11\n",
      "two nodes have the number 3");
  add("node_dangling", "         3         4\n", "         3        44\n",
      ":28: element 3 names node 44");
  add("node_nan", "0. 1 0.", "0. nan 0.", ":17: dataset 2411: node 3: \"nan\" is no finite");
  add("node_overflow", "0. 1 0.", "0. 1.D+999 0.", "no finite number");
  add("node_words", "0. 1 0.", "0. one 0.", "\"one\" is no finite number");
  add("node_short", "0. 1 0.", "0. 1", "node 3 has 2 coordinates");
  add("node_negative", "        20         1         1        11\n", " -20 1 1 11\n",
      "cannot be negative");
  add("node_unnumbered", "         3         1         1        11\n", " x 1 1 11\n",
      ":16: dataset 2411: expected a whole number, found \"x\"");
  add("element_twice", "         3       111", "         2       111",
      ":28: two elements have the number 2");
  add("element_count", "         2        91         5         1         7         3",
      "2 91 5 1 7 4", "element 2 has 4 nodes where descriptor 91 has 3");
  add("element_huge", "         9       161         6         1         7         1",
      "9 161 6 1 7 2000000000", "do not fit");
  add("element_short", "         2        91         5         1         7         3", "2 91 5",
      "3 numbers where 6 are due");
  add("element_unknown", "         3       111", "         3       117",
      "element 3 has the finite element descriptor 117", Kind::input_error);
  add("element_long", "         3         4\n", "         3         4         1\n",
      "has 5 nodes where 4 are due");
  add("group_huge", "         0         2\nbulk", "         0 999999999\nbulk", "do not fit");
  add("group_words", "         0         2\nbulk", "         0        2x\nbulk", "found \"2x\"");
  add("dataset_words", "  9999", "  word", "expected the number of a dataset");
  add("text_between", "  9999\nanything\n    -1\n", "  9999\nanything\n    -1\nmore\n",
      "expected -1 before a dataset");
  add("cut_in_dataset", "anything\n    -1\n", "anything\n", "cut short");
  cases.push_back({"without_nodes", "    -1\n   151\na\n    -1\n", "no nodes"});
  cases.push_back(
      {"without_elements", "    -1\n  2411\n 1 1 1 1\n 0 0 0\n    -1\n", "no elements"});
  cases.push_back({"other_text", "hello\n", "does not begin with a line of -1"});
  return cases;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Files, UnvRefusal, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });
