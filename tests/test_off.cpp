// SPDX-License-Identifier: BSD-3-Clause
// OFF: every variant of its first word, comments and colours; only moved nodes and normals change.
#include <cstdio>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/errors.hpp"
#include "support/refusals.hpp"
#include "support/surface_checks.hpp"

using namespace roughmesh;
using test::Kind;

namespace {

class Off : public testing::Test {
 protected:
  Mesh read(const std::string& bytes) const {
    test::write_trial(folder / "a.off", bytes);
    return read_mesh(folder / "a.off");
  }
  std::string written(const Mesh& mesh) const {
    write_mesh(mesh, folder / "b.off");
    return test::read_bytes(folder / "b.off");
  }
  test::TemporaryFolder folder;
};

const char* const small = "OFF\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

// The strip of test::strip() with everything that a file may have.
const char* const wild =
    "# made by hand, 1 2 3\r\n"
    "CNOFF # colours and normals\r\n"
    "\r\n"
    "8 3   # no edges\r\n"
    "0 0 0   0 0 1   255 0 0 255\r\n"
    "1 0 0.250   0 0 1   255 0 0 255 # a corner\r\n"
    "  1 1 0   0 0 1   0.5 0 0 1\r\n"
    "# between\r\n"
    "0 1 -.5   0.0 0 9   255 0 0\r\n"
    "\r\n"
    "2 0 125e-3   0 0 7   1\r\n"
    "2 1 +0   0 0 1.0\r\n"
    "0\t0\t0   nan nan nan\r\n"
    "9 9 9   0 0 1\r\n"
    "3 0 1 2  0.1 0.2 0.3\r\n"
    "3 6 2 3\r\n"
    "4  1 4 5 2  7 # coloured by a map";

}  // namespace

TEST_F(Off, IsReadWithColoursNormalsAndComments) {
  const Mesh mesh = read(wild);
  EXPECT_EQ(mesh.format, MeshFormat::off);
  test::expect_same_elements(mesh, test::strip());
  EXPECT_EQ(mesh.node_tags, test::strip().node_tags);
}

TEST_F(Off, IsReadByEveryFirstWord) {
  for (const std::string word : {"OFF", "COFF", "NOFF", "CNOFF", "NCOFF", "STOFF", "STCNOFF",
                                 "OFF 4 2 5 #", "OFF4 2 5 #", "  OFF", "# a comment\nOFF", ""}) {
    SCOPED_TRACE(word);
    std::string bytes = test::replaced(small, "OFF", word);
    if (word.find("4 2 5") != std::string::npos) bytes = test::replaced(bytes, "\n4 2 5", "");
    EXPECT_EQ(n_elements(read(bytes)), 2);
    EXPECT_EQ(written(read(bytes)), bytes);
  }
}

TEST_F(Off, IsToldByItsFirstWordWhateverItsName) {
  test::write_bytes(folder / "a.mesh", small);
  EXPECT_EQ(read_mesh(folder / "a.mesh").format, MeshFormat::off);
}

TEST_F(Off, ComesOutIdenticalWhenNothingMoves) {
  for (const char* const bytes : {small, wild}) EXPECT_EQ(written(read(bytes)), bytes);
}

// Node 3 is of one triangle, with nodes 6 and 2; its new position makes that triangle lie in z = 0.
// Node 2 also has faces that stay, so that its normal is compared by value.
TEST_F(Off, ChangesInMovedCoordinatesAndTheirNormalsOnly) {
  Mesh mesh = read(wild);
  mesh.nodes[3] = {0, 1, 0};
  std::string after = written(mesh);
  std::string expected = test::replaced(wild, "0 1 -.5   0.0 0 9", "0 1 0   0 0 1");
  expected = test::replaced(expected, "nan nan nan", "0 0 1");
  const std::string before_normal = "\r\n  1 1 0   ", behind_normal = "   0.5 0 0 1\r\n";
  const std::size_t start = after.find(before_normal) + before_normal.size();
  const std::size_t end = after.find(behind_normal);
  ASSERT_LT(start, end);
  Vec3 normal;
  ASSERT_EQ(std::sscanf(after.c_str() + start, "%lf %lf %lf", &normal[0], &normal[1], &normal[2]),
            3);
  EXPECT_LT((normal - test::normal_at(mesh, 2)).norm(), 1e-14);  // some ten roundings
  after.replace(start, end - start, "0 0 1");
  EXPECT_EQ(after, expected);
}

TEST_F(Off, ColoursAreNotTakenForNormals) {
  const std::string bytes = test::replaced(small, "1 1 0\n", "1 1 0 1 0 0\n");
  Mesh mesh = read(bytes);
  mesh.nodes[2] = {1, 1, 0.5};
  EXPECT_EQ(written(mesh), test::replaced(bytes, "1 1 0 1 0 0\n", "1 1 0.5 1 0 0\n"));
}

TEST_F(Off, IsWrittenAnewWithTheSurfaceAlone) {
  Mesh made = test::strip();
  made.nodes[4] = {0.1, 1.0 / 3, -1e-300};
  test::expect_same_elements(read(written(made)), made);
  made.blocks.push_back(test::make_block(test::line_type, 0, {7}, {0, 7}, 4));
  made.groups = {{1, 7, "rim"}};
  const Mesh mesh = read(written(made));
  EXPECT_EQ(n_elements(mesh), 3);
  EXPECT_EQ(mesh.n_nodes(), 7);  // node 7 is of the line alone
  EXPECT_EQ(conversion_losses(made, folder / "b.off"),
            (std::vector<std::string>{"1 lines", "1 physical groups"}));
}

TEST_F(Off, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  written(test::icosphere(1));
  const std::string script = "import meshio; m = meshio.read('" + (folder / "b.off").string() +
                             "'); assert m.points.shape == (42, 3); "
                             "assert len(m.cells[0].data) == 80";
  EXPECT_EQ(test::run("/usr/bin/python3 -c \"" + script + "\""), 0);
}

TEST_F(Off, SurvivesTruncationAndDamage) {
  test::expect_truncations_survived(folder, "a.off", wild);
  test::expect_damage_survived(folder, "a.off", wild, 1000);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, "a.off", test::replaced(small, what, by), kind, message});
  };
  add("word_unknown", "OFF", "OOF", ":1: does not begin with OFF");
  add("word_longer", "OFF", "OFFS", ":1: does not begin with OFF");
  add("binary", "OFF", "OFF BINARY", "save it as text", Kind::input_error);
  add("four_dimensions", "OFF", "4OFF", "three dimensions", Kind::input_error);
  add("n_dimensions", "OFF", "nOFF", "three dimensions", Kind::input_error);
  add("count_not_whole", "4 2 5", "4.5 2 5", ":2: expected a whole number");
  add("count_negative", "4 2 5", "-4 2 5", "cannot be negative");
  add("count_zero", "4 2 5", "0 2 5", "no vertices");
  add("count_huge", "4 2 5", "400000 2 5", "do not fit");
  add("count_beyond_index", "4 2 5", "4000000000 2 5", "split the mesh", Kind::input_error);
  add("count_too_large", "4 2 5", "5 2 5", "faces: the file ends here");
  add("count_too_small", "4 2 5", "3 2 5", ":6: faces: a face with 0 corners");
  add("faces_huge", "4 2 5", "4 200000 5", "do not fit");
  add("faces_too_many", "4 2 5", "4 3 5", "faces: the file ends here");
  add("faces_too_few", "4 2 5", "4 1 5", ":8: faces: something stands behind the last face");
  add("no_faces", "4 2 5", "4 0 0", "no faces", Kind::input_error);
  add("coordinate_nan", "1 1 0", "1 nan 0", ":5: vertices: a number is not finite");
  add("coordinate_word", "1 1 0", "1 one 0", "found \"one\"");
  add("coordinate_overflow", "1 1 0", "1 1e999 0", "beyond the range");
  add("corner_dangling", "3 0 2 3", "3 0 2 4", ":8: faces: node 4 does not exist");
  add("corner_negative", "3 0 2 3", "3 0 -2 3", "node -2 does not exist");
  add("face_pentagon", "3 0 2 3", "5 0 1 2 3 0", "a face with 5 corners");
  add("face_line", "3 0 2 3", "2 0 2", "a face with 2 corners");
  cases.push_back({"word_only", "a.off", "OFF", Kind::format_error, ":1: the file ends here"});
  return cases;
}

class MalformedOff : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedOff, IsRefusedInOneLine) {
  test::expect_refusal(test::TemporaryFolder(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, MalformedOff, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
