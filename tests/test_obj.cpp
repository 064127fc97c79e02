// SPDX-License-Identifier: BSD-3-Clause
// OBJ: statements in any order, continued lines, relative numbers, names as groups.
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/errors.hpp"
#include "support/refusals.hpp"
#include "support/surface_checks.hpp"

using namespace roughmesh;
using test::Kind;

namespace {

class Obj : public testing::Test {
 protected:
  Mesh read(const std::string& bytes) const {
    test::write_trial(folder / "a.obj", bytes);
    return read_mesh(folder / "a.obj");
  }
  std::string written(const Mesh& mesh) const {
    write_mesh(mesh, folder / "b.obj");
    return test::read_bytes(folder / "b.obj");
  }
  test::TemporaryFolder folder;
};

const char* const small = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

// The strip of test::strip() with everything that a file may have.
const char* const wild =
    "# made by hand \\\r\n"
    "mtllib stuff.mtl\r\n"
    "g\r\n"
    "v 0 0 0 1.0\r\n"
    "v 1 0 .250\\\r\n"
    "  0.5 0.5 0.5\r\n"
    "\tv  1 1 0 # a corner\r\n"
    "vn 0 0 1\r\n"
    "v 0 \\\r\n"
    " 1 -5e-1\r\n"
    "vt 0.5 0.5\r\n"
    "vn nan 0 0\r\n"
    "o the strip\r\n"
    "usemtl red\r\n"
    "s off\r\n"
    "f 1/1/1 2/1/1 3/1/1\r\n"
    "g left  side\r\n"
    "v 2 0 +0.125\r\n"
    "v 2 1 -0.0\r\n"
    "v 0 0 0\r\n"
    "v 9 9 9\r\n"
    "f -2//-1 -6//-1 -5//-1\r\n"
    "g default\r\n"
    "f 2/1 5/1 \\\r\n"
    "6/1 3/1\r\n"
    "l 1 2 -6\r\n"
    "p 8 1\r\n"
    "vp 1 2\r\n"
    "end of it";

Mesh wild_mesh() {
  Mesh mesh = test::strip();
  mesh.nodes[5][2] = -0.0;
  mesh.blocks = {test::make_block(test::triangle_type, 0, {1}, {0, 1, 2}, 1),
                 test::make_block(test::triangle_type, 0, {1, 2, 3}, {6, 2, 3}, 2),
                 test::make_block(test::quadrangle_type, 0, {1}, {1, 4, 5, 2}, 3),
                 test::make_block(test::line_type, 0, {1}, {0, 1, 1, 2}, 4),
                 test::make_block({ElementShape::point, 1, 1}, 0, {1}, {7, 0}, 6)};
  mesh.groups = {{0, 1, "the strip"},
                 {1, 1, "the strip"},
                 {2, 1, "the strip"},
                 {2, 2, "left"},
                 {2, 3, "side"}};
  return mesh;
}

}  // namespace

TEST_F(Obj, IsReadWithContinuedLinesAndRelativeNumbers) {
  const Mesh mesh = read(wild);
  EXPECT_EQ(mesh.format, MeshFormat::obj);
  test::expect_same_elements(mesh, wild_mesh());
  test::expect_same_topology(mesh, wild_mesh());
}

TEST_F(Obj, FacesMayStandBeforeTheirVertices) {
  EXPECT_EQ(read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").blocks[0].nodes,
            (std::vector<Index>{0, 1, 2}));
}

TEST_F(Obj, ComesOutIdenticalWhenNothingMoves) {
  for (const char* const bytes : {small, wild}) EXPECT_EQ(written(read(bytes)), bytes);
}

// Only the triangle of nodes 6, 2 and 3 moves, and it alone uses the second normal.
TEST_F(Obj, ChangesInMovedCoordinatesAndTheirNormalsOnly) {
  Mesh mesh = read(wild);
  mesh.nodes[3] = {0, 1, 0};
  mesh.nodes[7] = {9, 8, 9};
  std::string expected = test::replaced(wild, " 1 -5e-1", " 1 0");
  expected = test::replaced(expected, "vn nan 0 0", "vn 0 0 1");
  EXPECT_EQ(written(mesh), test::replaced(expected, "v 9 9 9", "v 9 8 9"));
}

TEST_F(Obj, CoordinatesOnContinuedLinesArePatchedInPlace) {
  Mesh mesh = read(test::replaced(small, "v 1 0 0", "v 1\\\n0\\\n0"));
  mesh.nodes[1] = {0.75, 0, 3};
  EXPECT_EQ(written(mesh).substr(8, 14), "v 0.75\\\n0\\\n3\nv");
}

// Every corner has a normal of its own, one for all, or one for each node: what is written is the
// sum of eq. 2 over the corners that use it.
TEST_F(Obj, NormalsAreThoseOfTheCornersThatUseThem) {
  Mesh sphere = test::icosphere(1);
  std::string bytes;
  for (const Vec3& x : sphere.nodes) bytes += fmt::format("v {} {} {}\n", x[0], x[1], x[2]);
  for (Index i = 0; i < sphere.n_nodes(); ++i) bytes += "vn 0 0 0\n";
  for (Index f = 0; f < sphere.blocks[0].size(); ++f) {
    const auto face = sphere.blocks[0].element(f);
    bytes += fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", face[0] + 1, face[1] + 1, face[2] + 1);
  }
  Mesh mesh = read(bytes);
  for (Vec3& x : mesh.nodes) x = Vec3(1.5 * x[0], x[1] + 0.2 * x[0] * x[2], 0.5 * x[2]);
  const std::string after = written(mesh);
  std::size_t place = 0;
  for (Index i = 0; i < mesh.n_nodes(); ++i) {
    place = after.find("vn ", place) + 3;
    Vec3 normal;
    ASSERT_EQ(std::sscanf(after.c_str() + place, "%lf %lf %lf", &normal[0], &normal[1], &normal[2]),
              3);
    EXPECT_LT((normal - test::normal_at(mesh, i)).norm(), 1e-14);  // some ten roundings
  }
}

TEST_F(Obj, ANormalSharedByAFlatFaceIsThatOfTheFace) {
  Mesh mesh = read(small);
  mesh.nodes[2] = {0, 0, 1};
  EXPECT_EQ(written(mesh),
            test::replaced(test::replaced(small, "v 0 1 0", "v 0 0 1"), "vn 0 0 1", "vn 0 -1 0"));
}

TEST_F(Obj, IsWrittenAnewWithGroupsByName) {
  Mesh made = test::strip();
  made.nodes[4] = {0.1, 1.0 / 3, -1e-300};
  made.blocks[0].physical_groups = {7, 9};
  made.blocks[1].physical_groups = {8};
  made.blocks.push_back(test::make_block(test::triangle_type, 0, {}, {0, 1, 3}, 4));
  made.blocks.push_back(test::make_block(test::line_type, 0, {7}, {0, 1}, 5));
  made.groups = {{1, 7, "rim"}, {2, 7, "left side"}, {2, 8, "left_side"}, {2, 9, ""}};
  const Mesh mesh = read(written(made));
  test::expect_same_elements(mesh, made);
  using Faces = std::multiset<std::vector<Index>>;
  EXPECT_EQ(test::elements_by_name(mesh),
            (std::map<std::string, Faces>{{"left_side", {{0, 1, 2}, {6, 2, 3}}},
                                          {"group_9", {{0, 1, 2}, {6, 2, 3}}},
                                          {"left_side_8", {{1, 4, 5, 2}}},
                                          {"rim", {{0, 1}}}}));
  EXPECT_TRUE(mesh.blocks[2].physical_groups.empty());
  EXPECT_EQ(conversion_losses(made, folder / "b.obj"),
            std::vector<std::string>{"numbers of 4 physical groups"});
}

TEST_F(Obj, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  written(test::icosphere(1));
  const std::string script = "import meshio; m = meshio.read('" + (folder / "b.obj").string() +
                             "'); assert m.points.shape == (42, 3); "
                             "assert len(m.cells[0].data) == 80";
  EXPECT_EQ(test::run("/usr/bin/python3 -c \"" + script + "\""), 0);
}

TEST_F(Obj, RealFilesComeOutIdenticalAndMove) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  const std::string bytes =
      test::read_bytes(std::filesystem::path(data) / "meshes" / "moebius.obj");
  Mesh mesh = read(bytes);
  EXPECT_EQ(mesh.n_nodes(), 280);
  EXPECT_EQ(n_elements(mesh, 2), 224);
  EXPECT_EQ(written(mesh), bytes);
  for (Vec3& x : mesh.nodes) x = 1.25 * x + Vec3(0, 0, 1);
  const Mesh again = read(written(mesh));
  test::expect_same_topology(again, mesh);
  EXPECT_EQ(again.nodes, mesh.nodes);
}

TEST_F(Obj, SurvivesTruncationAndDamage) {
  test::expect_truncations_survived(folder, "a.obj", wild);
  test::expect_damage_survived(folder, "a.obj", wild, 1000);
}

// Ten thousand changes between sets of a hundred groups.
TEST_F(Obj, TakesLinearTimeForManyNames) {
  std::string bytes = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng";
  for (int i = 0; i < 100; ++i) bytes += fmt::format(" g{}", i);
  for (int i = 0; i < 10'000; ++i) bytes += fmt::format("\no n{}\nf 1 2 3", i);
  EXPECT_EQ(read(bytes).groups.size(), 10'100);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, "a.obj", test::replaced(small, what, by), kind, message});
  };
  add("coordinate_missing", "v 1 0 0", "v 1 0", ":2: the line ends where a coordinate is due");
  add("coordinate_nan", "v 1 0 0", "v 1 nan 0", ":2: a number is not finite");
  add("coordinate_word", "v 1 0 0", "v 1 zero 0", ":2: expected a number, found \"zero\"");
  add("coordinate_half_a_number", "v 1 0 0", "v 1 0x 0", "found \"0x\"");
  add("coordinate_overflow", "v 1 0 0", "v 1 1e400 0", "beyond the range");
  add("coordinate_commented", "v 1 0 0", "v 1 # 0 0", "a coordinate is due");
  add("normal_short", "vn 0 0 1", "vn 0", ":4: the line ends where a component of a normal");
  add("corner_dangling", "2//1", "4//1", ":5: vertex 4 does not exist: there are 3");
  add("corner_zero", "2//1", "0//1", ":5: vertex 0 does not exist");
  add("corner_relative_beyond", "2//1", "-4//1", "vertex -4 does not exist");
  add("corner_beyond_index", "2//1", "3000000000//1", "vertex 3000000000 does not exist");
  add("corner_beyond_integers", "2//1", "-9223372036854775808//1", "does not exist");
  add("corner_without_vertex", "2//1", "//1", "a vertex number is missing");
  add("corner_word", "2//1", "two//1", "found \"two\"");
  add("corner_real", "2//1", "2.5//1", "found \"2.5\"");
  add("normal_dangling", "2//1", "2//2", ":5: normal 2 does not exist: there are 1");
  add("normal_relative_beyond", "2//1", "2//-2", "normal -2 does not exist");
  add("face_short", " 3//1", "", "a face with 2 corners");
  add("face_pentagon", "3//1", "3//1 1//1 2//1", "a face with 5 corners");
  add("face_empty", "f 1//1 2//1 3//1", "f", "a face with 0 corners");
  add("line_short", "f 1//1 2//1 3//1", "l 1", "the line ends where the end of a line is due");
  add("no_faces", "f 1//1 2//1 3//1", "", "no faces", Kind::input_error);
  add("free_form", "f 1//1", "surf 0 1 0 1 1 2 3\nf 1//1", "free-form", Kind::input_error);
  std::string names = "g";
  for (int i = 0; i <= 100; ++i) names += fmt::format(" {}", i);
  add("names_without_end", "f 1//1", names + "\nf 1//1", "101 names", Kind::input_error);
  cases.push_back({"no_vertices", "a.obj", "# nothing\n", Kind::format_error, "no vertices"});
  cases.push_back({"noise", "a.obj", std::string(300, '\xa5'), Kind::format_error, "no vertices"});
  return cases;
}

class MalformedObj : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedObj, IsRefusedInOneLine) {
  test::expect_refusal(test::TemporaryFolder(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, MalformedObj, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
