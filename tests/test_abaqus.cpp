// SPDX-License-Identifier: BSD-3-Clause
// Abaqus input: what is read, what stays when nodes move, what is written anew.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/surface.hpp"

#include "support/cells.hpp"
#include "support/text_formats.hpp"

using namespace roughmesh;
using test::Kind;
using test::read_text;
using test::with;

namespace {

// Two tetrahedra on the triangle 2 3 4, in the free spelling of hand-made files.
const char* const two_cells =
    "*Heading\n"
    "** a comment, with commas\n"
    " two cells\n"
    "*NODE , nset = ALL\n"
    "1, 0., 0.0D+00, 0\n"
    " 2 ,1.0,0,  0.,\n"
    "3, 0, 1.000, -0.0\n"
    "\n"
    "4,0,0,1E0, 0, 0, 1\n"
    "9, 1, 1, 1\n"
    "77, 5, 5\n"
    "*Element, Type=C3D4, ELSET=Left part\n"
    "1, 1, 2, 3, 4\n"
    "*element,\n"
    " type=c3d4h,\n"
    " elset=right\n"
    "12, 2, 3,\n"
    " 4, 9\n"
    "*ELEMENT, TYPE=SPRING1, ELSET=springs\n"
    "30, 77\n"
    "*NSET, NSET=fixed, GENERATE\n"
    "1, 3, 1\n"
    "*ELSET, ELSET=both, GENERATE\n"
    "1, 12\n"
    "*ELSET, ELSET=nested\n"
    "RIGHT, 1, 30, springs\n"
    "*SURFACE, NAME=outside, TYPE=ELEMENT\n"
    "left part, S1\n"
    "12, s3\n"
    "*SURFACE, NAME=skin\n"
    "both,\n"
    "*MATERIAL, NAME=STEEL\n"
    "*ELASTIC\n"
    "210000., 0.3\n"
    "*STEP\n"
    "*NODE PRINT\n"
    "U\n"
    "*END STEP";

using Members = std::map<std::pair<int, std::string>, std::vector<Tag>>;

}  // namespace

TEST(Abaqus, ReadsNodesElementsAndSets) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(folder, "a.inp", two_cells);
  EXPECT_EQ(mesh.format, MeshFormat::abaqus);
  EXPECT_EQ(mesh.node_tags, (std::vector<Tag>{1, 2, 3, 4, 9, 77}));
  EXPECT_EQ(mesh.nodes[3], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.nodes[5], Vec3(5, 5, 0));
  const Members members = test::members(mesh);
  EXPECT_EQ(members.at({3, "Left part"}), std::vector<Tag>{1});
  EXPECT_EQ(members.at({3, "right"}), std::vector<Tag>{12});
  EXPECT_EQ(members.at({3, "both"}), (std::vector<Tag>{1, 12}));
  EXPECT_EQ(members.at({3, "nested"}), (std::vector<Tag>{1, 12}));
  EXPECT_EQ(members.count({3, "springs"}), 0);
  EXPECT_EQ(n_elements(mesh, 3), 2);
}

// S1 of the first cell is 1 2 3 and faces down; S3 of the second, whose corners are 2 3 4 9, is
// 3 4 9. The two cells share 2 3 4, so that six faces are free.
TEST(Abaqus, SurfacesAreElementsThatFaceOutward) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(folder, "a.inp", two_cells);
  const Members members = test::members(mesh);
  ASSERT_EQ(members.at({2, "outside"}).size(), 2);
  EXPECT_EQ(members.at({2, "skin"}).size(), 6);
  EXPECT_EQ(n_elements(mesh, 2), 6);
  std::vector<std::vector<Index>> faces;
  for (const ElementBlock& block : mesh.blocks)
    if (block.physical_groups.size() == 2 && dimension(block.type.shape) == 2)
      for (Index e = 0; e < block.size(); ++e)
        faces.emplace_back(block.element(e).begin(), block.element(e).end());
  EXPECT_EQ(faces, (std::vector<std::vector<Index>>{{0, 2, 1}, {2, 3, 4}}));
  const Surface surface = select_surface(mesh, {.groups = {"skin"}});
  EXPECT_EQ(surface.nodes.size(), 5);
}

// The faces of every shape, by their numbers, close its surface: their area vectors add up to zero
// to the rounding of a sum, and the volume that they enclose by Gauss' theorem is positive.
TEST(Abaqus, FacesOfEveryShapeLookOutward) {
  const test::TemporaryFolder folder;
  const std::map<ElementShape, int> n_faces = {{ElementShape::tetrahedron, 4},
                                               {ElementShape::hexahedron, 6},
                                               {ElementShape::prism, 5},
                                               {ElementShape::pyramid, 5}};
  for (const auto& [shape, n] : n_faces) {
    write_mesh(test::single_element(shape, test::ideal_corners(shape)), folder / "a.inp");
    std::string bytes = test::read_bytes(folder / "a.inp");
    bytes += "*SURFACE, NAME=S\n";
    for (int face = 1; face <= n; ++face) bytes += fmt::format("1, S{}\n", face);
    const Mesh mesh = read_text(folder, "b.inp", bytes);
    ASSERT_EQ(n_elements(mesh, 2), n);
    Vec3 sum = Vec3::Zero();
    double volume = 0;
    for (const ElementBlock& block : mesh.blocks) {
      if (dimension(block.type.shape) != 2) continue;
      for (Index e = 0; e < block.size(); ++e) {
        const auto nodes = block.element(e);
        for (std::size_t k = 1; k + 1 < nodes.size(); ++k) {
          const Vec3 &a = mesh.nodes[nodes[0]], &b = mesh.nodes[nodes[k]],
                     &c = mesh.nodes[nodes[k + 1]];
          sum += (b - a).cross(c - a) / 2;
          volume += a.dot(b.cross(c)) / 6;
        }
      }
    }
    EXPECT_LT(sum.norm(), 1e-14) << n;
    EXPECT_GT(volume, 0.1) << n;
  }
}

TEST(Abaqus, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {std::string(two_cells), test::with_crlf(two_cells)}) {
    write_mesh(read_text(folder, "a.inp", bytes), folder / "b.inp");
    EXPECT_EQ(test::read_bytes(folder / "b.inp"), bytes);
  }
}

TEST(Abaqus, ChangesInMovedCoordinatesOnly) {
  const test::TemporaryFolder folder;
  for (const bool crlf : {false, true}) {
    const auto ends = [&](const std::string& text) { return crlf ? test::with_crlf(text) : text; };
    const Mesh before = read_text(folder, "a.inp", ends(two_cells));
    Mesh mesh = before;
    mesh.nodes[0][1] = 1e-9;
    mesh.nodes[1] = {1.0 / 3, 0, 0.5};
    mesh.nodes[3][2] = -1e300;
    mesh.nodes[5][2] = 0.25;  // a coordinate that the file leaves out
    write_mesh(mesh, folder / "b.inp");
    std::string expected = two_cells;
    expected = with(expected, "0.0D+00", "1e-09");
    expected = with(expected, " 2 ,1.0,0,  0.,", " 2 ,0.3333333333333333,0,  0.5,");
    expected = with(expected, "1E0", "-1e+300");
    expected = with(expected, "77, 5, 5", "77, 5, 5, 0.25");
    EXPECT_EQ(test::read_bytes(folder / "b.inp"), ends(expected));
    const Mesh again = read_mesh(folder / "b.inp");
    EXPECT_EQ(again.nodes, mesh.nodes);
    test::expect_same_elements(again, before);
    EXPECT_EQ(test::members(again), test::members(before));
  }
}

TEST(Abaqus, PlaneMeshesHaveSurfacesOfEdges) {
  const test::TemporaryFolder folder;
  const Mesh mesh =
      read_text(folder, "a.inp",
                "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, .5, 0\n6, 1, .5\n"
                "7, .5, 1\n8, 0, .5\n*ELEMENT, TYPE=CPE8R\n1, 1,2,3,4,5,6,7,8\n"
                "*ELSET, ELSET=E\n1\n*SURFACE, NAME=right\nE, S2\n*SURFACE, NAME=all\n"
                "E\n");
  EXPECT_EQ(test::members(mesh).at({1, "all"}).size(), 4);
  ASSERT_EQ(test::members(mesh).at({1, "right"}).size(), 1);
  for (const ElementBlock& block : mesh.blocks)
    if (block.physical_groups.size() == 2) {
      EXPECT_EQ(block.nodes, (std::vector<Index>{1, 2, 5}));
    }
  EXPECT_EQ(test::expect_middles(mesh, 0), 5);
}

TEST(Abaqus, SetsOfTheAssemblyBelongToItsPart) {
  const test::TemporaryFolder folder;
  const std::string bytes =
      "*Heading\n*Part, name=Plate\n*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n"
      "*Element, type=C3D4\n1, 1, 2, 3, 4\n*Elset, elset=Set-1\n1\n*End Part\n"
      "*Part, name=\"Rigid wall\"\n*End Part\n"
      "*Assembly, name=Assembly\n*Instance, name=Plate-1, part=plate\n 0., 0., 9.\n*End Instance\n"
      "*Instance, name=Wall-1, part=\"Rigid wall\"\n*End Instance\n"
      "*Node\n1, 8, 8, 8\n*Element, type=MASS, elset=m\n1, 1\n"
      "*Elset, elset=_Top_S2, internal, instance=Plate-1\n1,\n"
      "*Elset, elset=Set-1, instance=Plate-1, generate\n1, 1, 1\n"
      "*Elset, elset=elsewhere, instance=Wall-1\n1,\n"
      "*Surface, type=ELEMENT, name=Top\n_Top_S2, S2\n"
      "*Surface, type=ELEMENT, name=Low\nPlate-1.Set-1, S1\nelsewhere, S1\nm, S1\n"
      "*Surface, type=NODE, name=Nodes\nfixed, 1.\n*End Assembly\n";
  const Mesh mesh = read_text(folder, "a.inp", bytes);
  EXPECT_EQ(mesh.n_nodes(), 4);
  EXPECT_EQ(test::members(mesh), (Members{{{2, "Low"}, {2}},
                                          {{2, "Top"}, {3}},
                                          {{3, "Set-1"}, {1}},
                                          {{3, "assembly.Set-1"}, {1}}}));
}

TEST(Abaqus, IsWrittenAnewAndReadBackExactly) {
  const test::TemporaryFolder folder;
  Mesh ball = test::ball_in_box(4);
  for (const Mesh& made : {ball, test::second_order_zoo(true), test::plate(2)}) {
    write_mesh(made, folder / "a.inp");
    const Mesh mesh = read_mesh(folder / "a.inp");
    EXPECT_EQ(mesh.nodes, made.nodes);
    test::expect_same_elements(mesh, made);
    EXPECT_EQ(test::members(mesh), test::members(made));
  }
}

TEST(Abaqus, TellsWhatItDoesNotHold) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::plate(1);
  mesh.blocks.push_back(test::make_block({ElementShape::point, 1, 1}, 0, {}, {0}, 100));
  EXPECT_EQ(conversion_losses(mesh, folder / "a.inp"), std::vector<std::string>{"1 points"});
  mesh.blocks = {test::make_block({ElementShape::triangle, 2, 6}, 0, {}, {0, 1, 2, 3, 0, 1}, 1)};
  mesh.blocks.push_back(
      test::make_block({ElementShape::quadrangle, 2, 9}, 0, {}, {0, 1, 2, 3, 0, 1, 2, 3, 0}, 2));
  EXPECT_THROW(write_mesh(mesh, folder / "a.inp"), InputError);
}

TEST(Abaqus, OfGmshHasItsNodesOnTheMiddlesOfEdges) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  for (const test::Cells cells :
       {test::Cells::tetrahedra, test::Cells::prisms, test::Cells::hexahedra}) {
    const test::TemporaryFolder folder;
    const Mesh mesh = read_mesh(test::gmsh_box(folder, ".inp", cells));
    EXPECT_TRUE(test::has_cells(mesh, cells));
    EXPECT_GT(test::expect_middles(mesh, 1e-12), 9);  // printed with 16 digits
    EXPECT_EQ(test::members(mesh).count({3, "inside"}), 1);
  }
}

TEST(Abaqus, IsReadByMeshio) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  write_mesh(test::ball_in_box(4), folder / "a.inp");
  test::write_bytes(folder / "show.py",
                    "import meshio, sys\nm = meshio.read(sys.argv[1])\n"
                    "print(len(m.points), sum(len(c.data) for c in m.cells if c.type == 'tetra'),\n"
                    "      sorted(m.cell_sets))\n");
  test::run("/usr/bin/python3 " + (folder / "show.py").string() + " " +
            (folder / "a.inp").string() + " > " + (folder / "seen").string() + " 2>&1");
  const std::string seen = test::read_bytes(folder / "seen");
  EXPECT_NE(seen.find("125 384 "), std::string::npos) << seen;  // 4^3 cells of six tetrahedra
  EXPECT_NE(seen.find("'surface'"), std::string::npos) << seen;
}

TEST(Abaqus, SurvivesCutsAndDamage) {
  test::expect_survives_cuts("a.inp", two_cells);
  test::expect_survives_damage("a.inp", two_cells);
}

// Sets that repeat others could list 2^50 elements.
TEST(Abaqus, TakesLinearTimeForSetsOfSets) {
  const test::TemporaryFolder folder;
  std::string bytes = two_cells;
  bytes += "\n*ELSET, ELSET=s0\n1\n";
  for (int i = 1; i < 50; ++i)
    bytes += fmt::format("*ELSET, ELSET=s{}\ns{}, s{}\n", i, i - 1, i - 1);
  test::write_bytes(folder / "a.inp", bytes);
  test::expect_refused(folder / "a.inp", Kind::format_error, "far more elements");
}

class AbaqusRefusal : public testing::TestWithParam<test::Refusal> {};

TEST_P(AbaqusRefusal, IsOneLine) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.inp", GetParam().bytes);
  test::expect_refused(folder / "a.inp", GetParam().kind, GetParam().part_of_message);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, with(two_cells, what, by), message, kind});
  };
  add("node_twice", "9, 1, 1, 1", "3, 1, 1, 1", ":10: two nodes have the number 3");
  add("node_dangling", " 4, 9\n", " 4, 8\n", ":17: element 12 names node 8");
  add("node_nan", "9, 1, 1, 1", "9, 1, nan, 1", ":10: *NODE: node 9: \"nan\" is no finite");
  add("node_overflow", "9, 1, 1, 1", "9, 1, 1e999, 1", "no finite number");
  add("node_words", "9, 1, 1, 1", "9, 1, 1 2, 1", "\"1 2\"");
  add("node_negative", "9, 1, 1, 1", "-9, 1, 1, 1", "expected the number of a node");
  add("node_alone", "9, 1, 1, 1", "9", "node 9 has no coordinates");
  add("node_of_parameter", "9, 1, 1, 1", "9, <x>, 1, 1", "\"<x>\"");
  add("element_twice", "12, 2, 3,", "1, 2, 3,", ":17: two elements have the number 1");
  add("element_short", "1, 1, 2, 3, 4\n", "1, 1, 2, 3\n", "element 1 has 3 nodes where 4 are due");
  add("element_long", "1, 1, 2, 3, 4\n", "1, 1, 2, 3, 4, 9\n", "more than the 4 nodes");
  add("element_words", "1, 1, 2, 3, 4\n", "1, 1, x, 3, 4\n", ":13: *ELEMENT: expected a number");
  add("type_unknown", "c3d4h", "C3D27", "\"C3D27\" are not handled", Kind::input_error);
  add("type_missing", " type=c3d4h,\n", "", "type \"\" are not handled", Kind::input_error);
  add("include", "*MATERIAL", "*INCLUDE, INPUT=b.inp\n*MATERIAL", "put its lines into this file",
      Kind::input_error);
  add("node_input", "*NODE , nset", "*NODE, INPUT=nodes.txt, nset", "\"nodes.txt\"",
      Kind::input_error);
  add("generator", "*NSET", "*NGEN\n1, 3\n*NSET", "*NGEN makes or moves", Kind::input_error);
  add("cylinder", "*NODE ,", "*NODE, SYSTEM=C,", "makes or moves", Kind::input_error);
  add("set_unnamed", "*ELSET, ELSET=nested", "*ELSET", "has no ELSET=NAME");
  add("set_unknown", "RIGHT, 1, 30", "WRONG, 1, 30", ":26: *ELSET: set \"WRONG\" is not defined");
  add("generate_endless", "1, 12\n", "1, 12, 0\n", "the step not 0");
  add("generate_words", "1, 12\n", "1, many\n", "found \"many\"");
  add("face_beyond", "12, s3", "12, s5", "element 12 has no face S5");
  cases.push_back({"empty_of_nodes", "*HEADING\n", "no nodes"});
  cases.push_back({"empty_of_elements", "*NODE\n1, 0, 0, 0\n", "no elements"});
  cases.push_back({"other_inp", "# AVS UCD\n1 2 3\n", "does not begin with a keyword"});
  cases.push_back(
      {"two_parts",
       "*PART, NAME=A\n*NODE\n1, 0, 0, 0\n*END PART\n*PART, NAME=B\n*NODE\n1, 0, 0, 0\n",
       "both have nodes", Kind::input_error});
  return cases;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Files, AbaqusRefusal, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });
