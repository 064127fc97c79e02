// SPDX-License-Identifier: BSD-3-Clause
// Nastran bulk data: fields of every kind, entries of moved nodes, files written anew.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "fortran_real.hpp"
#include "io_nastran.hpp"
#include "support/text_formats.hpp"

using namespace roughmesh;
using test::Kind;
using test::read_text;
using test::with;

namespace {

// A pyramid on a quadrangle, in small, large and free fields, with and without continuations.
const char* const pyramid =
    "SOL 101\n"
    "CEND\n"
    "GRID = 1\n"
    "BEGIN BULK\n"
    "$ comment: 1.5\n"
    "$ Femap Property 3 : Gold plate\n"
    "$HMNAME PROP                   4\"core\" 4\n"
    "PSHELL  3       1       .1\n"
    "GRID    1               0.0     0.0     -0.0\n"
    "GRID    2       0       1.0     0.              0       123\n"
    "grid*   3               0               1.00+0          1.00000000E+00  *G3\n"
    "*G3     0.                              \n"
    "\n"
    "GRID,4,,0.,1.\n"
    "GRID,5,,+.5,5.-1,2.5D-1,,,  $ apex\n"
    "CQUAD4  1       3       1       2       3       4\n"
    "CPYRAM  2       4       1       2       3       4       5\n"
    "CROD,3,3,1,2\n"
    "PLOTEL  4       1       3\n"
    "CONM2   9       5               1.0\n"
    "ENDDATA\n"
    "GRID    6\n";

// Field 3 of the first line holds 16 characters from column 41 on.
std::string large(const std::string& a, const std::string& b, const std::string& c,
                  const std::string& d) {
  return fmt::format("{:<16}{:<16}{:<16}{:<16}", a, b, c, d);
}

}  // namespace

TEST(Nastran, ReadsFieldsOfEveryKind) {
  const test::TemporaryFolder folder;
  for (const char* const name : {"a.bdf", "a.nas", "a.fem", "a.dat", "A.BDF"})
    for (const std::string& bytes : {std::string(pyramid), test::with_crlf(pyramid)}) {
      const Mesh mesh = read_text(folder, name, bytes);
      EXPECT_EQ(mesh.format, MeshFormat::nastran);
      EXPECT_EQ(mesh.node_tags, (std::vector<Tag>{1, 2, 3, 4, 5}));
      EXPECT_EQ(mesh.nodes[2], Vec3(1, 1, 0));
      EXPECT_EQ(mesh.nodes[3], Vec3(0, 1, 0));
      EXPECT_EQ(mesh.nodes[4], Vec3(0.5, 0.5, 0.25));
      EXPECT_EQ(n_elements(mesh), 4);
      EXPECT_EQ(test::members(mesh),
                (std::map<std::pair<int, std::string>, std::vector<Tag>>{
                    {{1, "Gold plate"}, {3}}, {{2, "Gold plate"}, {1}}, {{3, "core"}, {2}}}));
    }
}

TEST(Nastran, ReadsTabsAndOldContinuations) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(
      folder, "a.bdf",
      "GRID\t1\t\t0.5\t1.5\t-2.5\nGRID,2,0,1.,0.,0.\nGRID,3,0,0.,1.,0.\nGRID,4,0,0.,0.,1.\n"
      "GRID,5,,.1,.1,.1\nGRID,6,,.1,.1,.1\nGRID,7,,.1,.1,.1\nGRID,8,,.1,.1,.1\n"
      "CHEXA   1       1       1       2       3       4       5       6       +A1\n"
      "$ between\n"
      "+A1     7       8\n"
      "CHEXA,2,1,1,2,3,4,5,6,+B\n+B,7,8\n"
      "CHEXA,3,1,1,2,3,4,5,6\n,7,8\n"
      "CHEXA   4       1       1       2       3       4       5       6\n        7       8\n");
  EXPECT_EQ(mesh.nodes[0], Vec3(0.5, 1.5, -2.5));
  EXPECT_EQ(n_elements(mesh, 3), 4);
  for (Index e = 0; e < 4; ++e) EXPECT_EQ(mesh.blocks[0].element(e)[7], 7);
}

TEST(Nastran, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {std::string(pyramid), test::with_crlf(pyramid)}) {
    write_mesh(read_text(folder, "a.bdf", bytes), folder / "b.bdf");
    EXPECT_EQ(test::read_bytes(folder / "b.bdf"), bytes);
  }
}

// Fields of 16 characters are read back to a unit of their last digit, free ones exactly.
TEST(Nastran, RewritesMovedEntriesWithAllTheirDigits) {
  const test::TemporaryFolder folder;
  for (const bool crlf : {false, true}) {
    const auto ends = [&](const std::string& text) { return crlf ? test::with_crlf(text) : text; };
    const Mesh before = read_text(folder, "a.bdf", ends(pyramid));
    Mesh mesh = before;
    mesh.nodes[0][2] = 1.0 / 3;
    mesh.nodes[1] = {-2.0 / 3, 0, 1e-20 / 3};
    mesh.nodes[2][1] = 1 + 1.0 / 7;
    mesh.nodes[3][2] = 1.0 / 3;  // a field that the file leaves out
    mesh.nodes[4][0] = 1e22;
    write_mesh(mesh, folder / "b.bdf");
    std::string expected = pyramid;
    expected = with(expected, "GRID    1               0.0     0.0     -0.0\n",
                    "GRID*   " + large("1", "", "0.0", "0.0") + "*\n*       .333333333333333\n");
    expected = with(expected, "GRID    2       0       1.0     0.              0       123\n",
                    "GRID*   " + large("2", "0", "-.66666666666667", "0.") + "*\n*       " +
                        large("3.33333333333-21", "0", "123", "").substr(0, 35) + "\n");
    expected = with(expected, "1.00000000E+00  *G3", "1.14285714285714*G3");
    expected = with(expected, "GRID,4,,0.,1.", "GRID,4,,0.,1.,0.3333333333333333");
    expected = with(expected, "+.5,5.-1", "1.e+22,5.-1");
    EXPECT_EQ(test::read_bytes(folder / "b.bdf"), ends(expected));
    const Mesh again = read_mesh(folder / "b.bdf");
    test::expect_same_elements(again, before);
    EXPECT_EQ(test::members(again), test::members(before));
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_LE(std::abs(again.nodes[i][k] - mesh.nodes[i][k]),
                  i < 3 ? detail::spacing_16(mesh.nodes[i][k]) : 0)
            << i << " " << k;
    mesh = read_mesh(folder / "b.bdf");
    write_mesh(mesh, folder / "c.bdf");
    EXPECT_EQ(test::read_bytes(folder / "c.bdf"), ends(expected));
  }
}

// An entry with lines of two kinds, or one that leaves out a whole line, is written in free fields.
TEST(Nastran, RewritesMovedEntriesOfMixedFields) {
  const test::TemporaryFolder folder;
  const std::string rest = "GRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nCTRIA3,1,1,1,2,3\n";
  const std::string fixed = "GRID*   " + large("1", "", "1.", "0.") + "*\n";
  for (const std::string& entry :
       {std::string("GRID*,1,,1.,0.\n"), std::string("GRID*,1,,1.,0.\n*\t0.\n"),
        std::string("GRID*,1,,1.,0.\n*       0.\n"), fixed + "*,0.\n",
        fixed + "*,0.0000000000000000000\n"}) {
    Mesh mesh = read_text(folder, "a.bdf", entry + rest);
    mesh.nodes[0] = {1.0 / 3, 0, 1.0 / 7};
    write_mesh(mesh, folder / "b.bdf");
    EXPECT_EQ(test::read_bytes(folder / "b.bdf"),
              "GRID,1,,0.3333333333333333,0.,0.14285714285714285\n" + rest)
        << entry;
  }
}

TEST(Nastran, MshOfAnyNameStaysMsh) {
  const test::TemporaryFolder folder;
  write_mesh(test::plate(1), folder / "a.msh");
  EXPECT_EQ(read_text(folder, "a.bdf", test::read_bytes(folder / "a.msh")).format,
            MeshFormat::msh4);
}

TEST(Nastran, MarksAndCommentsOfSmallEntriesStay) {
  const test::TemporaryFolder folder;
  const std::string rest = "GRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nCTRIA3,1,1,1,2,3\n";
  Mesh mesh = read_text(folder, "a.bdf", "GRID    1               0.      0.  $ origin\n" + rest);
  mesh.nodes[0][0] = 0.5;
  write_mesh(mesh, folder / "b.bdf");
  EXPECT_EQ(test::read_bytes(folder / "b.bdf"), "GRID*   " + large("1", "", ".5", "0.") +
                                                    "*\n*       " + std::string(64, ' ') +
                                                    "$ origin\n" + rest);
}

// Of numbers of all sizes: what 16 characters hold is a number within half a unit of its last
// digit, and a unit is what spacing_16 says.
TEST(Nastran, SixteenCharactersHoldAsManyDigitsAsFit) {
  double value = 1.0 / 3;
  for (int step = 0; step < 700; ++step) {
    value *= step < 350 ? 7.1 : 1.0 / 49.3;
    if (value < 1e-290) break;
    for (const double each : {value, -value}) {
      const std::string text = detail::nastran_real_16(each);
      EXPECT_LE(text.size(), 16) << text;
      EXPECT_NE(text.find('.'), std::string::npos) << text;
      const auto back = detail::fortran_real(text);
      ASSERT_TRUE(back) << text;
      // Half a unit, and the rounding of the number read.
      const double half = detail::spacing_16(each) / 2;
      EXPECT_LE(std::abs(*back - each), half * 1.001 + std::abs(each) * 1e-16) << text;
    }
  }
  EXPECT_EQ(detail::nastran_real_16(0), "0.");
  EXPECT_EQ(detail::nastran_real_16(-0.25), "-.25");
  EXPECT_EQ(detail::nastran_real_16(1e-7), "1.-7");
  EXPECT_EQ(detail::nastran_real(5), "5.");
  EXPECT_EQ(detail::nastran_real(1e-7), "1.e-07");
}

// 5 has 14 digits behind its point; -5 has 13, 2^-52 of the binade [4, 8) is for free fields.
TEST(Nastran, CoordinateSpacingIsThatOfItsFields) {
  const test::TemporaryFolder folder;
  const std::string rest = "GRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nCTRIA3,1,1,1,2,3\n";
  EXPECT_DOUBLE_EQ(
      coordinate_spacing(read_text(folder, "a.bdf", "GRID    1               5.0\n" + rest)),
      1e-14);
  EXPECT_DOUBLE_EQ(
      coordinate_spacing(read_text(folder, "a.bdf", "GRID    1               -5.0\n" + rest)),
      1e-13);
  EXPECT_EQ(coordinate_spacing(read_text(folder, "a.bdf", "GRID,1,,5.\n" + rest)),
            std::ldexp(4.0, -52));
}

TEST(Nastran, NumbersOfFortranAreRead) {
  using detail::fortran_real;
  EXPECT_EQ(fortran_real("1.5-3"), 1.5e-3);
  EXPECT_EQ(fortran_real("-1.5+3"), -1.5e3);
  EXPECT_EQ(fortran_real("+1.5E+03"), 1.5e3);
  EXPECT_EQ(fortran_real("1.5d-03"), 1.5e-3);
  EXPECT_EQ(fortran_real(".5"), 0.5);
  EXPECT_EQ(fortran_real("5."), 5.0);
  EXPECT_EQ(fortran_real("1.-400"), 0.0);
  for (const char* const text : {"", "-", ".", "1.5-", "1.5e", "nan", "inf", "-inf", "1.+400",
                                 "1 2", "0x1p3", "1-2-3", "--1", "1.5ee3", "e5"})
    EXPECT_FALSE(fortran_real(text)) << text;
  for (std::size_t n = 2; n < 200; ++n)
    EXPECT_FALSE(fortran_real("1." + std::string(n, '-') + "1")) << n << " signs";
}

TEST(Nastran, IsWrittenAnewAndReadBackToTheLastDigit) {
  const test::TemporaryFolder folder;
  for (const Mesh& made : {test::second_order_zoo(true), test::plate(2), test::icosphere(1)}) {
    write_mesh(made, folder / "a.bdf");
    const Mesh mesh = read_mesh(folder / "a.bdf");
    test::expect_same_elements(mesh, made);
    EXPECT_EQ(test::members(mesh), test::members(made));
    for (std::size_t i = 0; i < made.nodes.size(); ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_LE(std::abs(mesh.nodes[i][k] - made.nodes[i][k]),
                  detail::spacing_16(made.nodes[i][k]));
  }
}

// Groups of different dimensions may share a number, properties of Nastran may not.
TEST(Nastran, GivesEachGroupAPropertyOfItsOwn) {
  const test::TemporaryFolder folder;
  const Mesh made = test::ball_in_box(4);
  write_mesh(made, folder / "a.bdf");
  const Mesh mesh = read_mesh(folder / "a.bdf");
  EXPECT_EQ(test::members(mesh), test::members(made));
  EXPECT_EQ(mesh.groups.size(), 4);
  EXPECT_NE(mesh.groups[0].tag, mesh.groups[2].tag);
}

TEST(Nastran, IsReadByGmsh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh made = test::ball_in_box(4);
  write_mesh(made, folder / "a.bdf");
  const Mesh mesh = test::seen_by_gmsh(folder, folder / "a.bdf");
  EXPECT_EQ(n_elements(mesh, 3), n_elements(made, 3));
  EXPECT_EQ(n_elements(mesh, 2), n_elements(made, 2));
  ASSERT_EQ(mesh.n_nodes(), made.n_nodes());
  // Moved nodes of gmsh's own file are read by gmsh.
  Mesh own = read_mesh(test::gmsh_box(folder, ".bdf", test::Cells::tetrahedra));
  for (Vec3& x : own.nodes) x *= 1.1;
  write_mesh(own, folder / "moved.bdf");
  const Mesh moved = test::seen_by_gmsh(folder, folder / "moved.bdf");
  ASSERT_EQ(moved.n_nodes(), own.n_nodes());
  double sum = 0, expected = 0;
  for (const Vec3& x : moved.nodes) sum += x.lpNorm<1>();
  for (const Vec3& x : own.nodes) expected += x.lpNorm<1>();
  EXPECT_NEAR(sum, expected, 1e-12 * expected);
}

TEST(Nastran, OfGmshHasItsNodesOnTheMiddlesOfEdges) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  for (const test::Cells cells :
       {test::Cells::tetrahedra, test::Cells::prisms, test::Cells::hexahedra}) {
    const test::TemporaryFolder folder;
    const Mesh mesh = read_mesh(test::gmsh_box(folder, ".bdf", cells));
    EXPECT_TRUE(test::has_cells(mesh, cells));
    EXPECT_GT(test::expect_middles(mesh, 1e-5), 9);  // printed with 6 digits
  }
}

TEST(Nastran, SurvivesCutsAndDamage) {
  test::expect_survives_cuts("a.bdf", pyramid);
  test::expect_survives_damage("a.bdf", pyramid);
}

class NastranRefusal : public testing::TestWithParam<test::Refusal> {};

TEST_P(NastranRefusal, IsOneLine) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.bdf", GetParam().bytes);
  test::expect_refused(folder / "a.bdf", GetParam().kind, GetParam().part_of_message);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, with(pyramid, what, by), message, kind});
  };
  add("node_twice", "GRID,4,", "GRID,2,", ":14: two nodes have the number 2");
  add("node_dangling", "CROD,3,3,1,2", "CROD,3,3,1,7", ":18: element 3 names node 7");
  add("node_nan", "+.5,", "nan,", ":15: GRID: node 5: \"nan\" is no finite number");
  add("node_words", "+.5,", "a b,", "\"a b\" is no finite number");
  add("node_overflow", "+.5,", "1.+999,", "\"1.+999\" is no finite number");
  add("node_unnumbered", "GRID,4,", "GRID,,", "expected the number of a node, found \"\"");
  add("node_negative", "GRID,4,", "GRID,-4,", "found \"-4\"");
  add("node_system", "GRID,4,,", "GRID,4,7,", "GRID 4 is in coordinate system 7",
      Kind::input_error);
  add("default_system", "PSHELL  3", "GRDSET,,6\nPSHELL  3", "coordinate system 6",
      Kind::input_error);
  add("columns_shifted", "GRID    1               0.0     0.0     -0.0\n",
      "GRID    1              0.0    0.0    -0.0\n", "is no finite number");
  add("element_twice", "CROD,3,", "CROD,1,", ":18: two elements have the number 1");
  add("element_short", "CROD,3,3,1,2", "CROD,3,3,1", ":18: CROD: expected the number of a node");
  add("element_words", "CROD,3,3,1,2", "CROD,3,3,1,b", "found \"b\"");
  add("element_unnumbered", "CROD,3,", "CROD,,", "expected the number of an element");
  add("half_of_the_middles", "CPYRAM  2       4       1       2       3       4       5",
      "CPYRAM,2,4,1,2,3,4,5,1,\n,2,3", "3 of the 8 nodes on its edges");
  add("axisymmetric", "CROD,3,3,1,2", "CTRIAX6,3,3,1,2,3,4,5,1", "CTRIAX6 elements are not handled",
      Kind::input_error);
  add("include", "PSHELL  3", "INCLUDE 'a.bdf'\nPSHELL  3", "put its lines into this file",
      Kind::input_error);
  add("repeated", "CROD,3,", "=,*(1),=,*(1.),==\nCROD,3,", "repeat the one before",
      Kind::input_error);
  add("superelement", "BEGIN BULK", "BEGIN SUPER=1", "superelements", Kind::input_error);
  cases.push_back({"without_nodes", "BEGIN BULK\nENDDATA\n", "no nodes"});
  cases.push_back({"without_elements", "GRID,1,,0.,0.,0.\nENDDATA\n", "no elements"});
  cases.push_back({"other_text", "hello\nworld\n", "no nodes"});
  cases.push_back({"zeros", std::string(500, '\0'), "no nodes"});
  return cases;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Files, NastranRefusal, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });
