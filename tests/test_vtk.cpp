// SPDX-License-Identifier: BSD-3-Clause
// Legacy VTK: text and binary, both layouts of cells, the order of nodes, groups, normals.
#include <bit>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/format_files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"
#include "support/quadratic.hpp"

using namespace roughmesh;
using test::read_as;
using test::replaced;

namespace {

template <typename T>
std::string big(std::initializer_list<T> values) {
  std::string bytes;
  for (T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (std::endian::native == std::endian::little) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
  }
  return bytes;
}

const std::string text =
    "# vtk DataFile Version 3.0\r\na title, with # signs\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 5 float\n0 0 0   1.0 0 0\n\t1 1 0\n0 1.50e0 0 .5 .5 1\n"
    "CELLS 3 13\n3 0 1 2\n3 0 2 3\n4 0 1 2 4\n\nCELL_TYPES 3\n5 5\n10\n"
    "CELL_DATA 3\nscalars Material int\nLOOKUP_TABLE default\n7 7\n9\n"
    "POINT_DATA 5\nFIELD FieldData 2\nheight 1 5 double\n1 2 3 4 5\nid%20x 2 5 int\n"
    "0 1 2 3 4 5 6 7 8 9\nMETADATA\nINFORMATION 0\n\nVECTORS u float\n"
    "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

// The same with OFFSETS and CONNECTIVITY, as VTK 9 writes it.
std::string binary_51() {
  return "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" +
         big<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1.5, 0, .5, .5, 1}) +
         "\nCELLS 4 10\nOFFSETS vtktypeint64\n" + big<std::int64_t>({0, 3, 6, 10}) +
         "\nCONNECTIVITY vtktypeint64\n" + big<std::int64_t>({0, 1, 2, 0, 2, 3, 0, 1, 2, 4}) +
         "\nCELL_TYPES 3\n" + big<std::int32_t>({5, 5, 10}) +
         "\nCELL_DATA 3\nFIELD FieldData 1\nmaterial 1 3 short\n" + big<std::int16_t>({7, 7, 9}) +
         "\nMETADATA\nINFORMATION 0\n\n";
}

std::string binary_30() {
  return "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n" +
         big<double>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1.5, 0, .5, .5, 1}) + "\nCELLS 3 13\n" +
         big<std::int32_t>({3, 0, 1, 2, 3, 0, 2, 3, 4, 0, 1, 2, 4}) + "\nCELL_TYPES 3\n" +
         big<std::int32_t>({5, 5, 10}) + "\nCELL_DATA 3\nSCALARS material unsigned_char\n" +
         "LOOKUP_TABLE default\n" + big<std::uint8_t>({7, 7, 9}) + "\n";
}

void expect_two_triangles_and_a_tetrahedron(const Mesh& mesh) {
  EXPECT_EQ(mesh.format, MeshFormat::vtk);
  ASSERT_EQ(mesh.n_nodes(), 5);
  EXPECT_EQ(mesh.nodes[3], Vec3(0, 1.5, 0));
  ASSERT_EQ(mesh.blocks.size(), 2);
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(mesh.blocks[0].tags, (std::vector<Tag>{1, 2}));
  EXPECT_EQ(mesh.blocks[0].physical_groups, (std::vector<Tag>{7}));
  EXPECT_EQ(mesh.blocks[1].type, test::tetrahedron_type);
  EXPECT_EQ(mesh.blocks[1].physical_groups, (std::vector<Tag>{9}));
  ASSERT_EQ(mesh.groups.size(), 2);
  EXPECT_EQ(mesh.groups[1].dimension, 3);
  EXPECT_EQ(mesh.groups[1].tag, 9);
}

const std::string surface =
    "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n"
    "0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\nLINES 1 3\n2 0 1\n"
    "CELL_DATA 3\nSCALARS region int 1\nLOOKUP_TABLE default\n5 2 3\n"
    "POINT_DATA 4\nNORMALS n float\n0 0 1\n0 0 1\n0 0 1\n0 0 -1\nSCALARS s float\n"
    "LOOKUP_TABLE default\n1 2 3 4\n";

std::string as_vtk(const Mesh& mesh, const test::TemporaryFolder& folder, Encoding encoding) {
  write_mesh(mesh, folder / "written.vtk", {.encoding = encoding});
  return test::read_bytes(folder / "written.vtk");
}

Mesh first_order_zoo() {
  Mesh mesh = test::zoo();
  std::erase_if(mesh.blocks, [](const ElementBlock& block) { return block.type.order > 1; });
  return mesh;
}

}  // namespace

TEST(Vtk, IsReadInEveryEncodingAndLayout) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {text, binary_30(), binary_51()})
    expect_two_triangles_and_a_tetrahedron(read_as(folder, "a.vtk", bytes));
}

TEST(Vtk, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {text, binary_30(), binary_51(), surface}) {
    write_mesh(read_as(folder, "a.vtk", bytes), folder / "b.vtk");
    EXPECT_EQ(test::read_bytes(folder / "b.vtk"), bytes);
  }
}

TEST(Vtk, ChangesInMovedCoordinatesOnly) {
  const auto move = [](Mesh& mesh) {
    mesh.nodes[1][2] = 0.25;
    mesh.nodes[3] = {0, 1.625, -0.5};
  };
  test::expect_patched(
      "a.vtk", text,
      replaced(replaced(text, "1.0 0 0\n", "1.0 0 0.25\n"), "0 1.50e0 0 ", "0 1.625 -0.5 "), move);
  const std::string b30 = binary_30(), b51 = binary_51();
  test::expect_patched("a.vtk", b30,
                       replaced(b30, big<double>({1, 0, 0, 1, 1, 0, 0, 1.5, 0}),
                                big<double>({1, 0, .25, 1, 1, 0, 0, 1.625, -.5})),
                       move);
  test::expect_patched("a.vtk", b51,
                       replaced(b51, big<float>({1, 0, 0, 1, 1, 0, 0, 1.5, 0}),
                                big<float>({1, 0, .25, 1, 1, 0, 0, 1.625, -.5})),
                       move);
}

// Data at the cells of a POLYDATA count lines before polygons, wherever they stand.
TEST(Vtk, ReadsPolydataWithItsDataInVtksOrder) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_as(folder, "a.vtk", surface);
  ASSERT_EQ(mesh.blocks.size(), 3);
  EXPECT_EQ(mesh.blocks[0].type.shape, ElementShape::line);
  EXPECT_EQ(mesh.blocks[0].physical_groups, (std::vector<Tag>{5}));
  EXPECT_EQ(mesh.blocks[1].physical_groups, (std::vector<Tag>{2}));
  EXPECT_EQ(mesh.blocks[2].physical_groups, (std::vector<Tag>{3}));
  EXPECT_EQ(mesh.blocks[2].nodes, (std::vector<Index>{0, 2, 3}));
}

// The node between the triangles is lifted along the diagonal's ends' middle: all normals change
// but stay on their side. Turning the square about the x axis by 90 degrees has known normals.
TEST(Vtk, ComputesNormalsOfMovedFacesAnew) {
  test::expect_patched("a.vtk", surface,
                       replaced(replaced(surface, "1 1 0 0 1 0\n", "1 0 1 0 0 1\n"),
                                "0 0 1\n0 0 1\n0 0 1\n0 0 -1\n", "0 -1 0\n0 -1 0\n0 -1 0\n0 1 0\n"),
                       [](Mesh& mesh) {
                         mesh.nodes[2] = {1, 0, 1};
                         mesh.nodes[3] = {0, 0, 1};
                       });
}

TEST(Vtk, KeepsNormalsOfFacesThatDoNotMove) {
  const std::string two = replaced(
      replaced(replaced(surface, "POINTS 4 double\n", "POINTS 7 double\n5 5 5 6 5 5 5 6 5\n"),
               "POLYGONS 2 8\n3 0 1 2\n3 0 2 3", "POLYGONS 2 8\n3 3 4 5\n3 0 1 2"),
      "POINT_DATA 4\nNORMALS n float\n", "POINT_DATA 7\nNORMALS n float\n9 nan 9\n1 0 0\n0 2 0\n");
  const std::string fixed = replaced(two, "1 2 3 4\n", "1 2 3 4 5 6 7\n");
  // Only the node without a face moves, then one of a triangle in a plane of constant x.
  test::expect_patched("a.vtk", fixed, replaced(fixed, "0 1 0\nPOLY", "0 1 7\nPOLY"),
                       [](Mesh& mesh) { mesh.nodes[6][2] = 7; });
}

TEST(Vtk, TellsGroupsAndEntitiesByTheNamesOfArrays) {
  const test::TemporaryFolder folder;
  const Mesh gmsh = read_as(folder, "a.vtk", replaced(text, "Material", "CellEntityIds"));
  EXPECT_EQ(gmsh.blocks[0].entity, 7);
  EXPECT_EQ(gmsh.blocks[0].physical_groups, (std::vector<Tag>{7}));
  const Mesh meshio = read_as(folder, "a.vtk", replaced(text, "Material", "gmsh%3Aphysical"));
  EXPECT_EQ(meshio.blocks[0].physical_groups, (std::vector<Tag>{7}));
  EXPECT_EQ(meshio.blocks[0].entity, 0);
  EXPECT_TRUE(read_as(folder, "a.vtk", replaced(text, "Material", "pressure")).groups.empty());
  EXPECT_TRUE(
      read_as(folder, "a.vtk", replaced(text, "Material int", "Material float")).groups.empty());
}

TEST(Vtk, TakesPixelsVoxelsAndSmallPolygons) {
  const test::TemporaryFolder folder;
  const Mesh mesh =
      read_as(folder, "a.vtk",
              "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
              "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\nCELLS 5 24\n4 0 1 2 3\n"
              "8 0 1 2 3 4 5 6 7\n4 0 1 3 2\n2 0 1\n1 5\nCELL_TYPES 5\n8 11 7 4 2\n");
  ASSERT_EQ(mesh.blocks.size(), 4);
  EXPECT_EQ(mesh.blocks[0].nodes,
            (std::vector<Index>{0, 1, 3, 2, 0, 1, 3, 2}));  // both quadrangles
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 3, 2, 4, 5, 7, 6}));
  EXPECT_EQ(mesh.blocks[2].type.shape, ElementShape::line);
  EXPECT_EQ(mesh.blocks[3].nodes, (std::vector<Index>{5}));
}

// gmsh has tables of its own. It leaves out pyramids of order 2 and turns no wedge.
TEST(Vtk, OrdersNodesOfSecondOrderElementsAsGmshDoes) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  std::vector<ElementType> types = test::quadratic_types();
  std::erase_if(types, [](const ElementType& type) { return type.shape == ElementShape::pyramid; });
  const Mesh mesh = test::quadratic_elements(types);
  write_mesh(mesh, folder / "a.msh");
  const test::Outcome outcome =
      test::run_in(folder, "gmsh -save -format vtk -setnumber Mesh.SaveAll 1 -o gmsh.vtk a.msh");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  std::string bytes = test::read_bytes(folder / "gmsh.vtk");
  EXPECT_EQ(test::elements_by_position(read_as(folder, "b.vtk", bytes), false),
            test::elements_by_position(mesh, false));
}

TEST(Vtk, HoldsEveryElementWhenWrittenAnew) {
  const test::TemporaryFolder folder;
  for (const Encoding encoding : {Encoding::text, Encoding::binary})
    for (Mesh mesh : {first_order_zoo(), test::quadratic_elements(test::quadratic_types())}) {
      as_vtk(mesh, folder, encoding);
      const Mesh read = read_mesh(folder / "written.vtk");
      EXPECT_EQ(read.nodes, mesh.nodes);
      EXPECT_EQ(test::elements_by_position(read), test::elements_by_position(mesh));
      EXPECT_EQ(read.blocks[1].entity, mesh.blocks[1].entity);
    }
}

TEST(Vtk, CarriesFieldsAndLargeNumbers) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::plate(1);
  mesh.blocks[0].physical_groups = {3'000'000'000};
  for (const Encoding encoding : {Encoding::text, Encoding::binary}) {
    write_mesh(mesh, folder / "a.vtk",
               {.fields = {{"a height", 1, {1, 2, 3, 4}}, {"u", 3, std::vector<double>(12, 0.5)}},
                .encoding = encoding});
    const Mesh read = read_mesh(folder / "a.vtk");
    EXPECT_EQ(read.blocks[0].physical_groups, mesh.blocks[0].physical_groups);
    EXPECT_NE(test::read_bytes(folder / "a.vtk").find("a%20height 1 4 double\n"),
              std::string::npos);
  }
  EXPECT_EQ(conversion_losses(mesh, folder / "a.vtk"),
            (std::vector<std::string>{"names of 1 physical groups"}));
}

TEST(Vtk, RefusesElementsWithoutACell) {
  const test::TemporaryFolder folder;
  const Mesh mesh = test::quadratic_elements({{ElementShape::pyramid, 2, 14}});
  for (const char* file : {"a.vtk", "a.vtu"}) {
    EXPECT_THROW(write_mesh(mesh, folder / file), InputError);
    EXPECT_EQ(folder.n_files(), 0);
  }
}

TEST(Vtk, IsReadByGmshWhenWrittenAnew) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::ball_in_box(4);
  for (const Encoding encoding : {Encoding::text, Encoding::binary}) {
    as_vtk(mesh, folder, encoding);
    EXPECT_EQ(test::elements_by_position(test::seen_by_gmsh(folder, "written.vtk"), false),
              test::elements_by_position(mesh, false));
  }
}

TEST(Vtk, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  for (const Encoding encoding : {Encoding::text, Encoding::binary}) {
    as_vtk(test::ball_in_box(4), folder, encoding);
    EXPECT_EQ(
        test::seen_by_meshio(folder, "written.vtk",
                             "print(len(m.points), [(c.type, len(c.data)) for c in m.cells],"
                             " sum(x.sum() for x in m.cell_data['physical_group']))\n"),
        // 48 + 192 triangles, 6 (8 + 56) tetrahedra, in groups 1 and 2 of each dimension
        fmt::format("125 [('triangle', 240), ('tetra', 384)] {}\n", 48 + 2 * 192 + 48 + 2 * 336));
  }
}

TEST(Vtk, ReadsWhatMeshioWrites) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::ball_in_box(4);
  write_mesh(mesh, folder / "a.msh");
  for (const std::string options :
       {"'4.2', binary=False", "'4.2', binary=True", "'5.1', binary=False", "'5.1', binary=True"}) {
    test::seen_by_meshio(folder, "a.msh",
                         "import meshio.vtk\nm.cell_sets = {}\n"
                         "meshio.vtk.write('b.vtk', m, " +
                             options + ")\n");
    const Mesh read = read_mesh(folder / "b.vtk");
    EXPECT_EQ(test::elements_by_position(read), test::elements_by_position(mesh)) << options;
  }
}

// A file that ends within the last line of data that nothing asks for is whole enough.
TEST(Vtk, IsReadOrRefusedWhereverItIsCut) {
  const int n_text = test::n_read_when_cut("a.vtk", text);
  EXPECT_LE(n_text, 100);
  test::n_read_when_cut("a.vtk", binary_30());
  test::n_read_when_cut("a.vtk", binary_51());
  test::n_read_when_cut("a.vtk", surface);
}

TEST(Vtk, SurvivesDamagedBytes) {
  for (const std::string& bytes : {text, binary_30(), binary_51(), surface})
    test::expect_survives_damage("a.vtk", bytes, 150);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> list;
  const auto add = [&](const std::string& name, std::string_view what, std::string_view by,
                       const std::string& message, bool is_input_error = false) {
    list.push_back({name, replaced(text, what, by), message, is_input_error});
  };
  add("no_mark", "# vtk", "# VVV", "does not begin with");
  add("encoding", "ASCII", "ASCIIX", ":3: expected ASCII or BINARY, found \"ASCIIX\"");
  add("structured", "UNSTRUCTURED_GRID", "STRUCTURED_GRID", "a STRUCTURED_GRID is not read", true);
  add("rectilinear", "UNSTRUCTURED_GRID", "RECTILINEAR_GRID", "convert it", true);
  add("points_zero", "POINTS 5", "POINTS 0", "no points");
  add("points_negative", "POINTS 5", "POINTS -5", "negative");
  add("points_huge", "POINTS 5", "POINTS 2000000000", "do not fit");
  add("points_beyond_index", "POINTS 5", "POINTS 3000000000", "split the mesh", true);
  add("points_too_many", "POINTS 5", "POINTS 6", ":9: POINTS: expected a number, found \"CELLS\"");
  add("points_too_few", "POINTS 5", "POINTS 4", "\".5\" is no section");
  add("points_type", "POINTS 5 float", "POINTS 5 real", "\"real\" is no type of numbers");
  add("nan", ".5 .5 1", ".5 nan 1", ":8: POINTS: a number is not finite");
  add("second_points", "CELLS 3", "POINTS 1 float 0 0 0\nCELLS 3", "a second POINTS");
  add("cells_too_many", "CELLS 3 13", "CELLS 4 13", "cell 3 does not fit");
  add("cells_too_few", "CELLS 3 13", "CELLS 2 13", "5 numbers are left");
  add("cells_numbers", "CELLS 3 13", "CELLS 3 14", "expected a whole number");
  add("cells_negative", "4 0 1 2 4", "-4 0 1 2 4", "cell 2 does not fit");
  add("cell_size", "4 0 1 2 4", "5 0 1 2 4", "cell 2 does not fit");
  add("cell_dangling", "4 0 1 2 4", "4 0 1 2 5", "cell 2 has node 5, which does not exist");
  add("cell_negative_node", "4 0 1 2 4", "4 0 1 2 -1", "cell 2 has node -1");
  add("types_too_few", "CELL_TYPES 3\n5 5\n10", "CELL_TYPES 2\n5 5", "3 cells but 2 cell types");
  add("type_other_size", "5 5\n10", "5 9\n10", "has 3 nodes instead of 4");
  add("type_unknown", "5 5\n10", "5 5\n42", "type 42", true);
  add("type_lagrange", "5 5\n10", "5 5\n71", "type 71", true);
  add("data_count", "CELL_DATA 3", "CELL_DATA 4", "data for 4 cells where there are 3");
  add("point_data_count", "POINT_DATA 5", "POINT_DATA 4", "data for 4 points");
  add("scalars_without_table", "LOOKUP_TABLE default\n", "", "expected LOOKUP_TABLE");
  add("field_huge", "height 1 5", "height 9223372036854775807 5", "do not fit into any file");
  add("field_negative", "height 1 5", "height -1 5", "negative");
  add("strings", "height 1 5 double", "height 1 5 string", "strings are not read", true);
  add("strange_section", "VECTORS u", "WECTORS u", "\"WECTORS\" is no section");
  list.push_back({"strips", replaced(surface, "POLYGONS", "TRIANGLE_STRIPS"), "strips", true});
  list.push_back({"pentagon",
                  replaced(surface, "POLYGONS 2 8\n3 0 1 2\n3 0 2 3", "POLYGONS 1 6\n5 0 1 2 3 0"),
                  "", false});
  list.back().bytes =
      replaced(replaced(list.back().bytes, "CELL_DATA 3", "CELL_DATA 2"), "5 2 3", "5 2");
  list.back().part_of_message = "cell 1 is of VTK's type 7 with 5 nodes";
  list.back().is_input_error = true;
  list.push_back({"no_dataset", "# vtk DataFile Version 3.0\nt\nASCII\n", "no DATASET"});
  list.push_back({"points_only", text.substr(0, text.find("CELLS")), "no cells"});
  list.push_back({"binary_cut", binary_30().substr(0, 150), "do not fit"});
  list.push_back({"binary_infinite",
                  replaced(binary_30(), big<double>({1.5}), big<double>({INFINITY})),
                  "not finite"});
  list.push_back({"offsets_fall",
                  replaced(binary_51(), big<std::int64_t>({0, 3, 6}), big<std::int64_t>({0, 7, 6})),
                  "offsets do not rise"});
  list.push_back({"offsets_beyond",
                  replaced(binary_51(), big<std::int64_t>({6, 10}), big<std::int64_t>({6, 11})),
                  "offsets do not rise"});
  list.push_back({"connectivity", replaced(binary_51(), "\nCONNECTIVITY", "\nCONNECTIVITI"),
                  "expected CONNECTIVITY"});
  return list;
}

class MalformedVtk : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedVtk, IsRefusedInOneLine) { test::expect_refused("a.vtk", GetParam()); }

INSTANTIATE_TEST_SUITE_P(Files, MalformedVtk, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
