// SPDX-License-Identifier: BSD-3-Clause
// SU2: plane meshes and meshes of volumes, markers by name.
#include <gtest/gtest.h>

#include "support/cells.hpp"
#include "support/format_files.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;
using test::read_as;
using test::replaced;

namespace {

const std::string plane =
    "% a plane mesh\r\nNDIME= 2\n%\nNELEM =3\n5 0 1 2 0\n5\t0 2 3 1 % last\n 9 1 4 5 2\n"
    "NPOIN=6 6\n0 0 0\n1.0 0.0 1\n1 1 2\n\n0 1.50e0 3\n2 0 4\n2 1% no number\n"
    "NMARK= 2\nMARKER_TAG= lower side\nMARKER_ELEMS= 2\n3 0 1 0\n3 1 4\n"
    "marker_tag=wall\nmarker_elems=1\n3 3 0\nSEND_RECV= 1\nAOA= 2.5\n";

const std::string solid =
    "NDIME= 3\nNMARK= 2\nMARKER_TAG= base\nMARKER_ELEMS= 1\n5 0 1 2\n"
    "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\nSEND_RECV= 1\n1 3 0\n"
    "NPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\nNELEM= 1\n10 0 1 2 3 0\n"
    "FFD_NBOX= 1\n0 0 0\n";

// A unit square of triangles with lines on two sides.
Mesh square() {
  Mesh mesh = test::plate(2);
  mesh.blocks.push_back(test::make_block({ElementShape::line, 1, 2}, 1, {3}, {0, 1, 1, 2}, 100));
  mesh.blocks.push_back(test::make_block({ElementShape::line, 1, 2}, 2, {}, {2, 5}, 200));
  mesh.groups.insert(mesh.groups.begin(), {1, 3, "lower side"});
  return mesh;
}

}  // namespace

TEST(Su2, ReadsAPlaneMeshWithItsMarkers) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_as(folder, "a.su2", plane);
  EXPECT_EQ(mesh.format, MeshFormat::su2);
  ASSERT_EQ(mesh.n_nodes(), 6);
  EXPECT_EQ(mesh.nodes[3], Vec3(0, 1.5, 0));
  ASSERT_EQ(mesh.blocks.size(), 4);
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 0, 2, 3}));
  EXPECT_TRUE(mesh.blocks[0].physical_groups.empty());
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{1, 4, 5, 2}));
  EXPECT_EQ(mesh.blocks[2].nodes, (std::vector<Index>{0, 1, 1, 4}));
  EXPECT_EQ(mesh.blocks[2].physical_groups, (std::vector<Tag>{1}));
  EXPECT_EQ(mesh.blocks[3].tags, (std::vector<Tag>{6}));
  ASSERT_EQ(mesh.groups.size(), 2);
  EXPECT_EQ(mesh.groups[0].name, "lower side");
  EXPECT_EQ(mesh.groups[0].dimension, 1);
  EXPECT_EQ(mesh.groups[1].name, "wall");
}

TEST(Su2, ReadsAMeshOfVolumesInAnyOrderOfSections) {
  const test::TemporaryFolder folder;
  // SEND_RECV stands between a marker's count and its elements, as in partitioned files.
  const Mesh mesh = read_as(folder, "a.dat", replaced(solid, "SEND_RECV= 1\n", ""));
  ASSERT_EQ(mesh.blocks.size(), 2);
  EXPECT_EQ(mesh.blocks[0].type, test::tetrahedron_type);
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 2}));
  ASSERT_EQ(mesh.groups.size(), 1);
  EXPECT_EQ(mesh.groups[0].name, "base");
}

TEST(Su2, ReadsPartitionedFiles) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_as(folder, "a.su2", solid).groups.size(), 1);
}

TEST(Su2, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {plane, solid}) {
    write_mesh(read_as(folder, "a.su2", bytes), folder / "b.su2");
    EXPECT_EQ(test::read_bytes(folder / "b.su2"), bytes);
  }
}

TEST(Su2, ChangesInMovedCoordinatesOnly) {
  test::expect_patched(
      "a.su2", plane,
      replaced(replaced(plane, "1.0 0.0 1\n", "1.0 -0.25 1\n"), "2 1% no", "2.5 1% no"),
      [](Mesh& mesh) {
        mesh.nodes[1][1] = -0.25;
        mesh.nodes[5][0] = 2.5;
      });
  test::expect_patched("a.su2", solid, replaced(solid, "0 0 1 3", "0.125 0 1.5 3"), [](Mesh& mesh) {
    mesh.nodes[3] = {0.125, 0, 1.5};
  });
}

TEST(Su2, RefusesToLeaveThePlane) {
  const test::TemporaryFolder folder;
  Mesh mesh = read_as(folder, "a.su2", plane);
  mesh.nodes[2][2] = 1e-9;
  EXPECT_THROW(write_mesh(mesh, folder / "b.su2"), InputError);
  Mesh made = square();
  made.nodes[2][2] = 1e-9;
  EXPECT_THROW(write_mesh(made, folder / "b.su2"), InputError);
  EXPECT_EQ(folder.n_files(), 1);
}

TEST(Su2, HoldsMarkersWhenWrittenAnew) {
  const test::TemporaryFolder folder;
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid}) {
    const Mesh mesh = test::cell_box(shape, 2);
    write_mesh(mesh, folder / "a.su2");
    const Mesh read = read_mesh(folder / "a.su2");
    EXPECT_EQ(read.nodes, mesh.nodes);
    EXPECT_EQ(test::elements_by_position(read, false), test::elements_by_position(mesh, false));
    ASSERT_EQ(read.groups.size(), 2);
    EXPECT_EQ(read.groups[0].name, "middle");
    EXPECT_EQ(read.groups[1].name, "top");
  }
}

TEST(Su2, GivesLinesInNoGroupAMarkerAndNamesWithoutSpaces) {
  const test::TemporaryFolder folder;
  const Mesh mesh = square();
  write_mesh(mesh, folder / "a.su2");
  const Mesh read = read_mesh(folder / "a.su2");
  ASSERT_EQ(read.groups.size(), 2);
  EXPECT_EQ(read.groups[0].name, "no_group");
  EXPECT_EQ(read.groups[1].name, "lower_side");
  EXPECT_EQ(test::elements_by_position(read, false), test::elements_by_position(mesh, false));
}

TEST(Su2, TellsWhatItDoesNotHold) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(conversion_losses(square(), folder / "a.su2"),
            (std::vector<std::string>{"1 physical groups that are not of dimension 1"}));
  EXPECT_THROW(write_mesh(test::icosphere(1), folder / "a.su2"), InputError);  // not plane
  Mesh second_order = test::plate(1);
  second_order.blocks[0].type = {ElementShape::triangle, 2, 6};
  second_order.blocks[0].nodes = {0, 1, 2, 3, 0, 1};
  second_order.blocks[0].tags = {1};
  EXPECT_THROW(write_mesh(second_order, folder / "a.su2"), InputError);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST(Su2, TellsApartMarkersWhoseNamesBecomeAlike) {
  const test::TemporaryFolder folder;
  Mesh mesh = square();
  mesh.blocks[2].physical_groups = {4};
  mesh.groups.insert(mesh.groups.begin() + 1, {1, 4, "lower_side"});
  write_mesh(mesh, folder / "a.su2");
  const Mesh read = read_mesh(folder / "a.su2");
  ASSERT_EQ(read.groups.size(), 2);
  EXPECT_EQ(read.groups[1].name, "lower_side_4");
}

TEST(Su2, ReadsWhatGmshWrites) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::ball_in_box(4);
  write_mesh(mesh, folder / "a.msh");
  ASSERT_EQ(test::run_in(folder, "gmsh -save -format su2 -o a.su2 a.msh").exit_code, 0);
  const Mesh read = read_mesh(folder / "a.su2");
  EXPECT_EQ(test::elements_by_position(read, false), test::elements_by_position(mesh, false));
  ASSERT_EQ(read.groups.size(), 2);
  EXPECT_EQ(read.groups[0].name, "surface");
}

TEST(Su2, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  write_mesh(test::ball_in_box(4), folder / "a.su2");
  const std::string seen = test::seen_by_meshio(
      folder, "a.su2", "print(len(m.points), [(c.type, len(c.data)) for c in m.cells])\n");
  // 6 (8 + 56) tetrahedra; 48 + 192 triangles in two markers
  EXPECT_NE(seen.find("125 [('tetra', 384), ('triangle', 240)]"), std::string::npos) << seen;
}

TEST(Su2, IsReadOrRefusedWhereverItIsCut) {
  test::n_read_when_cut("a.su2", plane);
  test::n_read_when_cut("a.su2", solid);
}

// Nothing marks the end of a file, but NMARK tells how many markers there are.
TEST(Su2, IsRefusedWhenCutBetweenMarkers) {
  test::expect_refused("a.su2", {"", plane.substr(0, plane.find("marker_tag")),
                                 "1 markers where NMARK announces 2"});
}

TEST(Su2, SurvivesDamagedBytes) {
  for (const std::string& bytes : {plane, solid}) test::expect_survives_damage("a.su2", bytes);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> list;
  const auto add = [&](const std::string& name, std::string_view what, std::string_view by,
                       const std::string& message, bool is_input_error = false) {
    list.push_back({name, replaced(plane, what, by), message, is_input_error});
  };
  add("dimension", "NDIME= 2", "NDIME= 4", "NDIME is 4");
  add("no_dimension", "NDIME= 2", "", "NDIME is 0 or missing");
  add("dimension_word", "NDIME= 2", "NDIME= two", ":2: NDIME: expected a whole number");
  add("zones", "NDIME= 2", "NZONE= 2\nNDIME= 2", "2 zones", true);
  add("no_points", "NPOIN=6 6", "NPOINTS=6", "no NPOIN");
  add("no_elements", "NELEM =3", "NELEMS=3", "no NELEM");
  add("points_zero", "NPOIN=6", "NPOIN=0", "no points");
  add("points_negative", "NPOIN=6", "NPOIN=-6", "cannot be negative");
  add("points_huge", "NPOIN=6", "NPOIN=2000000000", "do not fit");
  add("points_beyond_index", "NPOIN=6", "NPOIN=3000000000", "split the mesh", true);
  add("points_too_many", "NPOIN=6 6", "NPOIN=7 7", "expected a number, found \"NMARK=\"");
  add("points_too_few", "NPOIN=6 6", "NPOIN=5 5", "point 5 does not exist");
  add("nan", "1.0 0.0 1", "1.0 nan 1", ":10: NPOIN: a number is not finite");
  add("point_short", "2 0 4\n2 1%", "2\n2 1%", ":14: NPOIN: too few numbers on the line");
  add("point_long", "2 0 4\n", "2 0 4 5 6\n", "too many numbers on the line");
  add("elements_huge", "NELEM =3", "NELEM =99999999", "do not fit");
  add("element_type", "5 0 1 2 0", "6 0 1 2 0", ":5: NELEM: element type 6 is none of SU2's");
  add("element_dangling", "5 0 1 2 0", "5 0 1 6 0",
      ":5: NELEM: point 6 does not exist: they are numbered 0 to 5");
  add("element_negative", "5 0 1 2 0", "5 0 -1 2 0", "point -1 does not exist");
  add("element_dimension", "5 0 1 2 0", "3 0 1 0", "a line where elements of dimension 2 stand");
  add("element_short", "5 0 1 2 0\n", "5 0 1\n", "too few numbers");
  add("element_long", "5 0 1 2 0\n", "5 0 1 2 0 7\n", "too many numbers");
  add("marker_elements", "MARKER_ELEMS= 2", "MARKER_ELEM= 2", "expected MARKER_ELEMS");
  add("marker_unnamed", "MARKER_TAG= lower side", "MARKER_TAG=", "without a name");
  add("marker_type", "3 0 1 0", "5 0 1 2", "a triangle where elements of dimension 1 stand");
  add("markers", "NMARK= 2", "NMARK= 3", "2 markers where NMARK announces 3");
  add("second_points", "AOA= 2.5", "NPOIN= 1", "a second NPOIN");
  list.push_back({"empty_of_sense", "hello\n", "NDIME is 0 or missing"});
  return list;
}

class MalformedSu2 : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedSu2, IsRefusedInOneLine) { test::expect_refused("a.su2", GetParam()); }

INSTANTIATE_TEST_SUITE_P(Files, MalformedSu2, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
