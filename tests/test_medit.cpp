// SPDX-License-Identifier: BSD-3-Clause
// Medit: text and binary of every version and byte order, references, normals and tangents.
#include <bit>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "support/format_files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"
#include "support/quadratic.hpp"

using namespace roughmesh;
using test::read_as;
using test::replaced;

namespace {

const std::string text =
    "# made by hand\r\nMeshVersionFormatted 2\nDimension 3 # in space\n\n"
    "Triangles\n2\n1 2 3 7\n 1 3 4 -2\n"
    "VERTICES\n5\n0 0 0 1\n1.0 0 0 0   1 1#here it is\n  0 0\n0 1.50e0\n0 4\n.5 .5 1 5\n"
    "Corners 2 1 2\nTetrahedra 1\n1 2 3 5 9\nRequiredTriangles 1 2\n"
    "SomethingNew 2\n1 2.5 3 4\nEnd\n";

struct Style {
  int version;
  bool is_big_endian;
};

// Writes binary files with nothing of the library: two triangles, a tetrahedron and an unknown
// section.
class BinaryFile {
 public:
  explicit BinaryFile(Style style) : style_(style) {
    put<std::int32_t>(1);
    put<std::int32_t>(style.version);
    begin(3);
    put<std::int32_t>(3);
    end_section();
  }

  void begin(int code) {
    put<std::int32_t>(code);
    link_ = bytes_.size();
    position(0);
  }
  void end_section() {
    const std::string rest = bytes_;
    const auto stop = static_cast<std::int64_t>(bytes_.size());
    bytes_.resize(link_);
    position(stop);
    bytes_ += rest.substr(bytes_.size());
  }
  void integers(std::initializer_list<std::int64_t> values) {
    for (const std::int64_t value : values)
      if (style_.version < 4)
        put<std::int32_t>(static_cast<std::int32_t>(value));
      else
        put<std::int64_t>(value);
  }
  void real(double value) {
    if (style_.version == 1)
      put<float>(static_cast<float>(value));
    else
      put<double>(value);
  }
  void vertex(const Vec3& x) {
    for (int k = 0; k < 3; ++k) real(x[k]);
    integers({0});
  }
  std::string finished() {
    begin(54);
    return bytes_;
  }

 private:
  template <typename T>
  void put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (style_.is_big_endian != (std::endian::native == std::endian::big))
      std::reverse(raw, raw + sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  void position(std::int64_t value) {
    if (style_.version < 3)
      put<std::int32_t>(static_cast<std::int32_t>(value));
    else
      put<std::int64_t>(value);
  }

  Style style_;
  std::string bytes_;
  std::size_t link_ = 0;
};

const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1.5, 0}, {.5, .5, 1}};

std::string binary(Style style, const std::vector<Vec3>& nodes = positions) {
  BinaryFile file(style);
  file.begin(6);
  file.integers({2, 1, 2, 3, 7, 1, 3, 4, -2});
  file.end_section();
  file.begin(170);
  file.integers({1, 2, 3});
  file.end_section();
  file.begin(4);
  file.integers({5});
  for (const Vec3& x : nodes) file.vertex(x);
  file.end_section();
  file.begin(8);
  file.integers({1, 1, 2, 3, 5, 9});
  file.end_section();
  return file.finished();
}

std::vector<Style> styles() {
  std::vector<Style> list;
  for (int version = 1; version <= 4; ++version)
    for (const bool is_big_endian : {false, true}) list.push_back({version, is_big_endian});
  return list;
}

void expect_two_triangles_and_a_tetrahedron(const Mesh& mesh) {
  EXPECT_EQ(mesh.format, MeshFormat::medit);
  EXPECT_EQ(mesh.nodes, positions);
  ASSERT_EQ(mesh.blocks.size(), 3);
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(mesh.blocks[0].physical_groups, (std::vector<Tag>{7}));
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{0, 2, 3}));
  EXPECT_EQ(mesh.blocks[1].physical_groups, (std::vector<Tag>{-2}));
  EXPECT_EQ(mesh.blocks[2].type, test::tetrahedron_type);
  EXPECT_EQ(mesh.blocks[2].nodes, (std::vector<Index>{0, 1, 2, 4}));
  EXPECT_EQ(mesh.blocks[2].tags, (std::vector<Tag>{3}));
  ASSERT_EQ(mesh.groups.size(), 3);
  EXPECT_EQ(mesh.groups[2].dimension, 3);
  EXPECT_EQ(mesh.groups[2].tag, 9);
}

void lift(Mesh& mesh) {
  mesh.nodes[2] = {1, 1.75, 0.25};
  mesh.nodes[3] = {0, 1.625, -0.5};
}

// A square of two triangles with a normal at each node, one of them inward, one of a triangle's
// corner, and a tangent along x.
const std::string with_normals =
    "MeshVersionFormatted 2\nDimension\n3\nNormals 5\n0 0 1\n0 0 1\n0 0 -1\n0 0 2\n0 0 1\n"
    "Vertices 4\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\nTriangles 2\n1 2 3 0\n1 3 4 0\n"
    "Edges 1\n1 2 0\nNormalAtVertices 4\n1 1 2 2 3 3 4 4\nNormalAtTriangleVertices 1\n1 2 5\n"
    "Tangents 2\n1 0 0\n0 1 0\nTangentAtVertices 1\n2 1\nTangentAtEdgeVertices 1\n1 1 2\nEnd\n";

Mesh without_points(Mesh mesh) {
  std::erase_if(mesh.blocks,
                [](const ElementBlock& block) { return block.type.shape == ElementShape::point; });
  return mesh;
}

Mesh quadratic() {
  using enum ElementShape;
  return test::quadratic_elements(
      {{line, 2, 3}, {triangle, 2, 6}, {quadrangle, 2, 9}, {tetrahedron, 2, 10}});
}

}  // namespace

TEST(Medit, IsReadInEveryEncoding) {
  const test::TemporaryFolder folder;
  expect_two_triangles_and_a_tetrahedron(read_as(folder, "a.mesh", text));
  for (const Style& style : styles())
    expect_two_triangles_and_a_tetrahedron(read_as(folder, "a.meshb", binary(style)));
}

TEST(Medit, ComesOutIdenticalWhenNothingMoves) {
  const test::TemporaryFolder folder;
  for (const std::string& bytes : {text, with_normals}) {
    write_mesh(read_as(folder, "a.mesh", bytes), folder / "b.mesh");
    EXPECT_EQ(test::read_bytes(folder / "b.mesh"), bytes);
  }
  for (const Style& style : styles()) {
    write_mesh(read_as(folder, "a.meshb", binary(style)), folder / "b.meshb");
    EXPECT_EQ(test::read_bytes(folder / "b.meshb"), binary(style));
  }
}

// The comment stands between two coordinates of a vertex.
TEST(Medit, ChangesInMovedCoordinatesOnly) {
  test::expect_patched(
      "a.mesh", text,
      replaced(replaced(text, "1#here it is\n  0 0\n", "1.75#here it is\n  0.25 0\n"),
               "1.50e0\n0 4", "1.625\n-0.5 4"),
      lift);
  std::vector<Vec3> moved = positions;
  moved[2] = {1, 1.75, 0.25};
  moved[3] = {0, 1.625, -0.5};
  for (const Style& style : styles())
    test::expect_patched("a.meshb", binary(style), binary(style, moved), lift);
}

TEST(Medit, ReadsPlaneMeshesAndRefusesToLeaveThePlane) {
  const std::string plane =
      "MeshVersionFormatted\n1\nDimension\n2\nVertices\n3\n0 0 1\n1 0 1\n0 1 1\n"
      "Edges\n1\n1 2 4\nTriangles\n1\n1 2 3 5\nEnd\n";
  test::expect_patched("a.mesh", plane, replaced(plane, "1 0 1", "1.5 0 1"),
                       [](Mesh& mesh) { mesh.nodes[1][0] = 1.5; });
  const test::TemporaryFolder folder;
  Mesh mesh = read_as(folder, "a.mesh", plane);
  mesh.nodes[1][2] = 1;
  EXPECT_THROW(write_mesh(mesh, folder / "b.mesh"), InputError);
  EXPECT_EQ(folder.n_files(), 1);
}

// Turned by 90 degrees about the x axis, the plane's normal z becomes -y and its tangent y becomes
// z, while x stays. Normals become unit vectors on the side on which they were.
TEST(Medit, ComputesNormalsAndTurnsTangentsOfMovedFaces) {
  const test::TemporaryFolder folder;
  Mesh mesh = read_as(folder, "a.mesh", with_normals);
  mesh.nodes[2] = {1, 0, 1};
  mesh.nodes[3] = {0, 0, 1};
  write_mesh(mesh, folder / "b.mesh");
  const std::string bytes = test::read_bytes(folder / "b.mesh");
  EXPECT_NE(bytes.find("Normals 5\n0 -1 0\n0 -1 0\n0 1 0\n0 -1 0\n"), std::string::npos) << bytes;
  const auto vector = [&](std::string_view section, int i) {
    std::istringstream stream(bytes.substr(bytes.find(section)));
    std::string word;
    stream >> word >> word;
    Vec3 x;
    for (int k = 0; k <= i; ++k) stream >> x[0] >> x[1] >> x[2];
    return x;
  };
  constexpr double eps = 4e-16;  // a quaternion and a product of unit vectors
  EXPECT_LT((vector("Normals 5", 4) - Vec3(0, -1, 0)).norm(), eps);
  EXPECT_LT((vector("Tangents 2", 0) - Vec3(1, 0, 0)).norm(), eps);
  EXPECT_LT((vector("Tangents 2", 1) - Vec3(0, 0, 1)).norm(), eps);
  EXPECT_EQ(read_mesh(folder / "b.mesh").nodes, mesh.nodes);
}

TEST(Medit, RefusesToGiveNodesThatShareANormalDifferentOnes) {
  const test::TemporaryFolder folder;
  Mesh mesh =
      read_as(folder, "a.mesh", replaced(with_normals, "1 1 2 2 3 3 4 4", "1 1 2 1 3 1 4 1"));
  write_mesh(mesh, folder / "b.mesh");
  mesh.nodes[3][2] = 0.5;
  EXPECT_THROW(write_mesh(mesh, folder / "b.mesh"), InputError);
}

TEST(Medit, HoldsEveryElementWhenWrittenAnew) {
  const test::TemporaryFolder folder;
  Mesh zoo = without_points(test::zoo());
  std::erase_if(zoo.blocks, [](const ElementBlock& b) { return b.type.order > 1; });
  Mesh large = test::plate(1);
  large.blocks[0].physical_groups = {3'000'000'000};
  for (const Encoding encoding : {Encoding::text, Encoding::binary})
    for (const Mesh& mesh : {zoo, large, quadratic()}) {
      write_mesh(mesh, folder / "a.mesh", {.encoding = encoding});
      const Mesh read = read_mesh(folder / "a.mesh");
      EXPECT_EQ(read.nodes, mesh.nodes);
      EXPECT_EQ(test::elements_by_position(read), test::elements_by_position(mesh));
    }
}

TEST(Medit, TellsWhatItDoesNotHold) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::zoo();
  EXPECT_EQ(
      conversion_losses(mesh, folder / "a.mesh"),
      (std::vector<std::string>{"names of 4 physical groups", "2 periodic links",
                                "numbers of nodes and elements", "1 elements of dimension 0"}));
  std::erase_if(mesh.blocks,
                [](const ElementBlock& b) { return b.type.shape != ElementShape::point; });
  EXPECT_THROW(write_mesh(mesh, folder / "a.mesh"), InputError);
  EXPECT_THROW(
      write_mesh(test::quadratic_elements({{ElementShape::prism, 2, 18}}), folder / "a.mesh"),
      InputError);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST(Medit, IsReadByGmshWhenWrittenAnew) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  for (const Mesh& mesh : {test::ball_in_box(4)}) {
    write_mesh(mesh, folder / "a.mesh");
    EXPECT_EQ(test::elements_by_position(test::seen_by_gmsh(folder, "a.mesh"), false),
              test::elements_by_position(mesh, false));
  }
}

TEST(Medit, ReadsWhatGmshWrites) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::ball_in_box(4);
  write_mesh(mesh, folder / "a.msh");
  ASSERT_EQ(test::run_in(folder, "gmsh -save -format mesh -o a.mesh a.msh").exit_code, 0);
  EXPECT_EQ(test::elements_by_position(read_mesh(folder / "a.mesh"), false),
            test::elements_by_position(mesh, false));
}

// gmsh takes them under the keywords of order 2, and writes them under those of order 1.
TEST(Medit, OrdersNodesOfSecondOrderElementsAsGmshDoes) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::quadratic_elements({{ElementShape::line, 2, 3},
                                              {ElementShape::triangle, 2, 6},
                                              {ElementShape::tetrahedron, 2, 10}});
  write_mesh(mesh, folder / "a.mesh");
  EXPECT_EQ(test::elements_by_position(test::seen_by_gmsh(folder, "a.mesh"), false),
            test::elements_by_position(mesh, false));
  write_mesh(mesh, folder / "a.msh");
  ASSERT_EQ(
      test::run_in(folder, "gmsh -save -format mesh -setnumber Mesh.SaveAll 1 -o b.mesh a.msh")
          .exit_code,
      0);
  EXPECT_EQ(test::elements_by_position(read_mesh(folder / "b.mesh"), false),
            test::elements_by_position(mesh, false));
}

TEST(Medit, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  for (const auto& [file, encoding] :
       {std::pair{"a.mesh", Encoding::text}, {"a.meshb", Encoding::binary}}) {
    write_mesh(test::ball_in_box(4), folder / file, {.encoding = encoding});
    EXPECT_EQ(
        test::seen_by_meshio(folder, file,
                             "print(len(m.points), [(c.type, len(c.data)) for c in m.cells],"
                             " sum(x.sum() for x in m.cell_data['medit:ref']))\n"),
        // 48 + 192 triangles, 6 (8 + 56) tetrahedra, in groups 1 and 2 of each dimension
        fmt::format("125 [('triangle', 240), ('tetra', 384)] {}\n", 48 + 2 * 192 + 48 + 2 * 336));
  }
}

TEST(Medit, ReadsWhatMeshioWrites) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const test::TemporaryFolder folder;
  const Mesh mesh = test::ball_in_box(4);
  write_mesh(mesh, folder / "a.mesh");
  for (const char* file : {"b.mesh", "b.meshb"}) {
    test::seen_by_meshio(folder, "a.mesh", fmt::format("m.write('{}')\n", file));
    EXPECT_EQ(test::elements_by_position(read_mesh(folder / file)),
              test::elements_by_position(mesh));
  }
}

// Every file says where it ends, so no part of one is taken for a whole.
TEST(Medit, IsRefusedWhereverItIsCut) {
  EXPECT_EQ(test::n_read_when_cut("a.mesh", text), 1);  // the last line without its end
  EXPECT_EQ(test::n_read_when_cut("a.mesh", with_normals), 1);
  for (const Style& style : {Style{1, false}, Style{3, true}}) {
    EXPECT_EQ(test::n_read_when_cut("a.meshb", binary(style)), 0);
  }
}

TEST(Medit, SurvivesDamagedBytes) {
  for (const std::string& bytes : {text, with_normals})
    test::expect_survives_damage("a.mesh", bytes);
  for (const Style& style : styles()) test::expect_survives_damage("a.meshb", binary(style), 50);
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> list;
  const auto add = [&](const std::string& name, std::string_view what, std::string_view by,
                       const std::string& message, bool is_input_error = false) {
    list.push_back({name, replaced(text, what, by), message, is_input_error});
  };
  add("no_version", "MeshVersionFormatted", "MeshVersion", "does not begin with");
  add("version", "Formatted 2", "Formatted 5", "version 5", true);
  add("dimension", "Dimension 3", "Dimension 4", "Dimension 4 is neither 2 nor 3");
  add("no_dimension", "Dimension 3", "", "Dimension 0 is neither");
  add("plane", "Dimension 3", "Dimension 2", "Vertices: numbers are left behind the last row");
  add("row_long", "1 2 3 5 9", "1 2 3 5 4 3 9", "Tetrahedra: numbers are left behind the last row");
  add("no_vertices", "VERTICES", "Weights", "no section Vertices");
  add("vertices_zero", "VERTICES\n5", "VERTICES\n0", "no vertices");
  add("vertices_negative", "VERTICES\n5", "VERTICES\n-5", "cannot be negative");
  add("vertices_huge", "VERTICES\n5", "VERTICES\n2000000000", "do not fit");
  add("vertices_beyond_index", "VERTICES\n5", "VERTICES\n3000000000", "split the mesh", true);
  add("vertices_too_many", "VERTICES\n5", "VERTICES\n6",
      ":17: Vertices: expected a number, found \"Corners\"");
  add("nan", ".5 .5 1", ".5 nan 1", ":16: Vertices: a number is not finite");
  add("word", ".5 .5 1", ".5 x5 1", "found \"x5\"");
  add("triangles_too_many", "Triangles\n2", "Triangles\n3", "expected a whole number");
  add("triangles_huge", "Triangles\n2", "Triangles\n999999", "do not fit");
  add("dangling", "1 2 3 5 9", "1 2 3 6 9",
      ":19: Tetrahedra: vertex 6 does not exist: they are numbered 1 to 5");
  add("zero_node", "1 2 3 5 9", "0 2 3 5 9", "vertex 0 does not exist");
  add("no_elements", "Triangles\n2\n1 2 3 7\n 1 3 4 -2\n", "", "", false);
  list.back().bytes = replaced(list.back().bytes, "Tetrahedra 1\n1 2 3 5 9\n", "");
  list.back().part_of_message = "no elements";
  add("second_section", "Corners 2 1 2", "Triangles 1 1 2 3 0", "a second section Triangles");
  add("no_end", "End\n", "", "without End");
  add("hexahedra_of_order_2", "SomethingNew", "HexahedraQ2", "section HexahedraQ2 is not read",
      true);
  add("ordering", "SomethingNew", "TrianglesP2Ordering", "Ordering is not read", true);
  list.push_back({"normal_dangling", replaced(with_normals, "3 3 4 4", "3 3 4 6"),
                  "NormalAtVertices: vector 6 does not exist"});
  list.push_back({"corner_dangling", replaced(with_normals, "1\n1 2 5", "1\n1 4 5"),
                  "corner 4 does not exist"});
  const std::string good = binary({3, false});
  list.push_back(
      {"binary_version",
       replaced(good, std::string("\1\0\0\0\3\0\0\0", 8), std::string("\1\0\0\0\x9\0\0\0", 8)),
       "version 9", true});
  list.push_back({"binary_dangling",
                  replaced(good, std::string("\3\0\0\0\5\0\0\0\x9\0\0\0", 12),
                           std::string("\3\0\0\0\6\0\0\0\x9\0\0\0", 12)),
                  "vertex 6 does not exist"});
  list.push_back(
      {"binary_link_back",
       replaced(good, std::string("\6\0\0\0\x48\0\0\0", 8), std::string("\6\0\0\0\1\0\0\0", 8)),
       "byte 24: the section with code 6 ends at byte 1"});
  list.push_back({"binary_infinite", binary({3, false}, {{INFINITY, 0, 0}, {}, {}, {}, {}}),
                  "Vertices: a number is not finite"});
  list.push_back({"binary_count",
                  replaced(good, std::string("\2\0\0\0\1\0\0\0\2\0\0\0", 12),
                           std::string("\2\0\0\x10\1\0\0\0\2\0\0\0", 12)),
                  "do not fit"});
  return list;
}

class MalformedMedit : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedMedit, IsRefusedInOneLine) { test::expect_refused("a.mesh", GetParam()); }

INSTANTIATE_TEST_SUITE_P(Files, MalformedMedit, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
