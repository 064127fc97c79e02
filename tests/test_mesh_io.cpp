// SPDX-License-Identifier: BSD-3-Clause
// MSH and PLY2: what is read is what the file says, and everything but the coordinates of moved
// nodes comes out as it went in.
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "gmsh_element_types.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"

using namespace roughmesh;
using test::MshStyle;

namespace {

std::vector<MshStyle> odd_styles() {
  std::vector<MshStyle> styles = test::all_msh_styles();
  for (const int version : {2, 4}) {
    styles.push_back({.version = version, .end = "\r\n"});
    styles.push_back({.version = version, .space = " \t  ", .end = " \n\n  "});
    styles.push_back({.version = version, .extra_sections = true});
    styles.push_back(
        {.version = version, .end = "\r\n", .extra_sections = true, .partitions = true});
    styles.push_back({.version = version, .binary = true, .extra_sections = true});
    styles.push_back({.version = version, .binary = true, .partitions = true});
    styles.push_back({.version = version, .binary = true, .big_endian = true, .partitions = true});
  }
  styles.push_back({.version = 4, .parametric = true});
  styles.push_back({.version = 4, .binary = true, .parametric = true});
  return styles;
}

void expect_equal(const Mesh& mesh, const Mesh& expected) {
  EXPECT_EQ(mesh.nodes, expected.nodes);
  EXPECT_EQ(mesh.node_tags, expected.node_tags);
  ASSERT_EQ(mesh.blocks.size(), expected.blocks.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    SCOPED_TRACE(b);
    EXPECT_EQ(mesh.blocks[b].type, expected.blocks[b].type);
    EXPECT_EQ(mesh.blocks[b].entity, expected.blocks[b].entity);
    EXPECT_EQ(mesh.blocks[b].physical_groups, expected.blocks[b].physical_groups);
    EXPECT_EQ(mesh.blocks[b].nodes, expected.blocks[b].nodes);
    EXPECT_EQ(mesh.blocks[b].tags, expected.blocks[b].tags);
  }
  ASSERT_EQ(mesh.groups.size(), expected.groups.size());
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    EXPECT_EQ(mesh.groups[g].dimension, expected.groups[g].dimension);
    EXPECT_EQ(mesh.groups[g].tag, expected.groups[g].tag);
    EXPECT_EQ(mesh.groups[g].name, expected.groups[g].name);
  }
  ASSERT_EQ(mesh.periodic_links.size(), expected.periodic_links.size());
  for (std::size_t l = 0; l < mesh.periodic_links.size(); ++l) {
    EXPECT_EQ(mesh.periodic_links[l].dimension, expected.periodic_links[l].dimension);
    EXPECT_EQ(mesh.periodic_links[l].entity, expected.periodic_links[l].entity);
    EXPECT_EQ(mesh.periodic_links[l].master_entity, expected.periodic_links[l].master_entity);
    EXPECT_EQ(mesh.periodic_links[l].affine, expected.periodic_links[l].affine);
    EXPECT_EQ(mesh.periodic_links[l].nodes, expected.periodic_links[l].nodes);
  }
}

// The zoo with coordinates that survive 16 digits, so that text files hold them exactly.
Mesh zoo() {
  Mesh mesh = test::zoo();
  for (Vec3& x : mesh.nodes)
    for (double& c : x) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), "%.16g", c);
      c = std::strtod(text.data(), nullptr);
    }
  return mesh;
}

class MshFile : public testing::TestWithParam<MshStyle> {
 protected:
  test::TemporaryFolder folder;
  Mesh expected = zoo();
};

TEST_P(MshFile, IsReadAsWritten) {
  test::write_bytes(folder / "zoo.msh", test::msh_bytes(expected, GetParam()));
  const Mesh mesh = read_mesh(folder / "zoo.msh");
  EXPECT_EQ(mesh.format, GetParam().version == 2 ? MeshFormat::msh2 : MeshFormat::msh4);
  expect_equal(mesh, expected);
}

TEST_P(MshFile, ComesOutIdenticalWhenNothingMoves) {
  const std::string bytes = test::msh_bytes(expected, GetParam());
  test::write_bytes(folder / "zoo.msh", bytes);
  write_mesh(read_mesh(folder / "zoo.msh"), folder / "out.msh");
  EXPECT_EQ(test::read_bytes(folder / "out.msh"), bytes);
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

// What the file must be is made by the independent writer: in text, coordinates that changed in
// shortest decimals, all others as 16 digits; in binary, the file of the moved mesh.
TEST_P(MshFile, ChangesInMovedCoordinatesOnly) {
  test::write_bytes(folder / "zoo.msh", test::msh_bytes(expected, GetParam()));
  Mesh mesh = read_mesh(folder / "zoo.msh");
  mesh.nodes[0] = {-1.0 / 3, 2e-300, 1e300};
  mesh.nodes[5][1] += 1e-9;
  mesh.nodes[12][0] = 0.0;  // was -0.0
  mesh.nodes.back()[2] = 12345678.9;
  write_mesh(mesh, folder / "out.msh");

  test::MshWriter writer(mesh, GetParam());
  writer.set_coordinate_text([&](std::size_t node, int axis) {
    const double before = expected.nodes[node][axis], after = mesh.nodes[node][axis];
    if (before != after || std::signbit(before) != std::signbit(after)) return shortest(after);
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.16g", before);
    return std::string(text.data());
  });
  EXPECT_EQ(test::read_bytes(folder / "out.msh"), writer.bytes());
  EXPECT_EQ(read_mesh(folder / "out.msh").nodes, mesh.nodes);
}

TEST_P(MshFile, MayBeWrittenOverItself) {
  test::write_bytes(folder / "zoo.msh", test::msh_bytes(expected, GetParam()));
  Mesh mesh = read_mesh(folder / "zoo.msh");
  for (Vec3& x : mesh.nodes) x *= 1.1;
  write_mesh(mesh, folder / "zoo.msh");
  EXPECT_EQ(read_mesh(folder / "zoo.msh").nodes, mesh.nodes);
  EXPECT_EQ(folder.n_files(), 1);
}

INSTANTIATE_TEST_SUITE_P(Styles, MshFile, testing::ValuesIn(odd_styles()), [](const auto& test) {
  return name(test.param) + "_" + std::to_string(test.index);
});

// Elements, groups and coordinates that gmsh and meshio find in files this library has patched.
class OtherPrograms : public testing::TestWithParam<MshStyle> {
 protected:
  // A ball in a box, its sphere blown up a little.
  std::string write_moved() {
    const Mesh ball = test::ball_in_box(4);
    test::write_bytes(folder / "ball.msh", test::msh_bytes(ball, GetParam()));
    moved = read_mesh(folder / "ball.msh");
    for (Vec3& x : moved.nodes)
      if (x.lpNorm<Eigen::Infinity>() < 0.99) x *= 1.01;
    write_mesh(moved, folder / "moved.msh");
    return (folder / "moved.msh").string();
  }

  test::TemporaryFolder folder;
  Mesh moved;
};

std::map<std::pair<int, std::string>, std::int64_t> elements_of_groups(const Mesh& mesh) {
  std::map<std::pair<int, std::string>, std::int64_t> result;
  for (const PhysicalGroup& group : mesh.groups)
    for (const ElementBlock& block : mesh.blocks)
      if (dimension(block.type.shape) == group.dimension &&
          block.physical_groups == std::vector<Tag>{group.tag})
        result[{group.dimension, group.name}] += block.size();
  return result;
}

TEST_P(OtherPrograms, GmshSeesTheSameGroups) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const std::string file = write_moved();
  const std::string resaved = (folder / "resaved.msh").string();
  const std::string log = (folder / "log").string();
  ASSERT_EQ(
      test::run("gmsh -save -format msh41 -o " + resaved + " " + file + " > " + log + " 2>&1"), 0)
      << test::read_bytes(log);
  EXPECT_EQ(test::read_bytes(log).find("Error"), std::string::npos) << test::read_bytes(log);
  const Mesh mesh = read_mesh(resaved);
  EXPECT_EQ(elements_of_groups(mesh), elements_of_groups(moved));
  EXPECT_EQ(elements_of_groups(mesh).size(), 4);
  EXPECT_EQ(mesh.n_nodes(), moved.n_nodes());
}

TEST_P(OtherPrograms, MeshioSeesTheSameGroups) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  if (GetParam().big_endian) GTEST_SKIP() << "meshio reads the native byte order only";
  const std::string file = write_moved();
  const std::string script =
      "import meshio, sys\n"
      "m = meshio.read(sys.argv[1])\n"
      "n = {}\n"
      "for cells, tags in zip(m.cells, m.cell_data['gmsh:physical']):\n"
      "    dim = 3 if cells.type == 'tetra' else 2\n"
      "    for t in tags:\n"
      "        key = [k for k, v in m.field_data.items() if v[0] == abs(t) and v[1] == dim][0]\n"
      "        n[key] = n.get(key, 0) + 1\n"
      "print(' '.join(f'{k}={n[k]}' for k in sorted(n)), len(m.points), m.points.max())\n";
  test::write_bytes(folder / "count.py", script);
  const std::string printed = (folder / "printed").string();
  ASSERT_EQ(test::run("/usr/bin/python3 " + (folder / "count.py").string() + " " + file + " > " +
                      printed + " 2>&1"),
            0)
      << test::read_bytes(printed);
  // 4^3 cells of six tetrahedra, 2^3 of them inside; two triangles for each square of the sides.
  EXPECT_NE(test::read_bytes(printed).find("inside=48 outer=192 outside=336 surface=48 125 1.0"),
            std::string::npos)
      << test::read_bytes(printed);
}

INSTANTIATE_TEST_SUITE_P(Styles, OtherPrograms, testing::ValuesIn(test::all_msh_styles()),
                         [](const auto& test) { return name(test.param); });

Mesh read_text(const test::TemporaryFolder& folder, const std::string& name,
               const std::string& bytes) {
  test::write_bytes(folder / name, bytes);
  return read_mesh(folder / name);
}

}  // namespace

TEST(ReadMsh, TakesNodeNumbersUpToTheLargestInteger) {
  const test::TemporaryFolder folder;
  Mesh expected = test::plate(2);
  const Tag largest = std::numeric_limits<Tag>::max();
  for (std::size_t i = 0; i < expected.nodes.size(); ++i)
    expected.node_tags[i] = largest - static_cast<Tag>(i * i) * 1000000000000;
  expected.node_tags[4] = 0;
  for (const bool binary : {false, true}) {
    const MshStyle style{.version = 4, .binary = binary};
    expect_equal(read_text(folder, "sparse.msh", test::msh_bytes(expected, style)), expected);
  }
}

TEST(ReadMsh, TakesSectionsInAnyOrderThatMakesSense) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(folder, "a.msh",
                              "$Comments\nfirst\n$EndComments\n$MeshFormat\n4.1 0 "
                              "8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n2 1 0 3\n"
                              "1\n2\n3\n+0 0 0\n1 0 0.\n0 1e0 1e-400\n$EndNodes\n$Elements\n1 1 1 "
                              "1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
                              "$Entities\n0 0 1 0\n1 0 0 0 inf 1e999 x 2 -5 3 0\n$EndEntities\n"
                              "$PhysicalNames\n1\n2 5 \"a b\"\n$EndPhysicalNames\n");
  EXPECT_EQ(mesh.blocks[0].physical_groups, (std::vector<Tag>{3, 5}));
  EXPECT_EQ(mesh.groups[1].name, "a b");
  EXPECT_EQ(mesh.nodes[2], Vec3(0, 1, 0));
}

// Gmsh saves links to nodes that it does not save when only some groups are saved.
TEST(ReadMsh, LeavesOutPeriodicPairsOfNodesThatAreNotThere) {
  const test::TemporaryFolder folder;
  Mesh expected = zoo();
  std::string bytes = test::msh_bytes(expected, {.version = 4});
  bytes.replace(bytes.find("$Periodic"), std::string::npos,
                "$Periodic\n1\n1 1 2\n0\n2\n3 7\n3 77\n$EndPeriodic\n");
  const Mesh mesh = read_text(folder, "a.msh", bytes);
  ASSERT_EQ(mesh.periodic_links.size(), 1);
  EXPECT_EQ(mesh.periodic_links[0].nodes, (std::vector<std::pair<Index, Index>>{{1, 0}}));
}

// Numbers of nodes from the list of element types in Gmsh's manual.
TEST(GmshElementTypes, HaveTheNodesOfTheManual) {
  const std::map<int, int> n_nodes = {
      {1, 2},    {2, 3},     {3, 4},     {4, 4},     {5, 8},     {6, 6},     {7, 5},     {8, 3},
      {9, 6},    {10, 9},    {11, 10},   {12, 27},   {13, 18},   {14, 14},   {15, 1},    {16, 8},
      {17, 20},  {18, 15},   {19, 13},   {20, 9},    {21, 10},   {22, 12},   {23, 15},   {24, 15},
      {25, 21},  {26, 4},    {27, 5},    {28, 6},    {29, 20},   {30, 35},   {31, 56},   {32, 22},
      {33, 28},  {36, 16},   {37, 25},   {38, 36},   {39, 12},   {40, 16},   {41, 20},   {42, 28},
      {43, 36},  {44, 45},   {45, 55},   {46, 66},   {47, 49},   {48, 64},   {49, 81},   {50, 100},
      {51, 121}, {52, 18},   {53, 21},   {54, 24},   {55, 27},   {56, 30},   {57, 24},   {58, 28},
      {59, 32},  {60, 36},   {61, 40},   {62, 7},    {63, 8},    {64, 9},    {65, 10},   {66, 11},
      {71, 84},  {72, 120},  {73, 165},  {74, 220},  {75, 286},  {79, 34},   {80, 40},   {81, 46},
      {82, 52},  {83, 58},   {90, 40},   {91, 75},   {92, 64},   {93, 125},  {94, 216},  {95, 343},
      {96, 512}, {97, 729},  {98, 1000}, {99, 32},   {100, 44},  {101, 56},  {102, 68},  {103, 80},
      {104, 92}, {105, 104}, {106, 126}, {107, 196}, {108, 288}, {109, 405}, {110, 550}, {111, 24},
      {112, 33}, {113, 42},  {114, 51},  {115, 60},  {116, 69},  {117, 78},  {118, 30},  {119, 55},
      {120, 91}, {121, 140}, {122, 204}, {123, 285}, {124, 385}, {125, 21},  {126, 29},  {127, 37},
      {128, 45}, {129, 53},  {130, 61},  {131, 69},  {137, 16}};
  for (Tag number = -2; number < 300; ++number) {
    const ElementType* const type = detail::element_type_from_gmsh(number);
    const auto expected = n_nodes.find(static_cast<int>(number));
    ASSERT_EQ(type != nullptr, expected != n_nodes.end()) << number;
    if (type != nullptr) {
      EXPECT_EQ(type->n_nodes, expected->second) << number;
      EXPECT_EQ(detail::element_type_from_gmsh(detail::gmsh_number(*type))->n_nodes, type->n_nodes);
    }
  }
}

TEST(WriteMesh, WritesAMeshMadeInMemoryAsMsh) {
  const test::TemporaryFolder folder;
  for (const Mesh& made : {test::ball_in_box(4), test::icosphere(1), test::zoo()}) {
    write_mesh(made, folder / "made.msh");
    const Mesh mesh = read_mesh(folder / "made.msh");
    EXPECT_EQ(mesh.format, MeshFormat::msh4);
    expect_equal(mesh, made);
  }
}

// MSH 4.1 cannot say that an entity's elements are in different groups.
TEST(WriteMesh, KeepsGroupsOfBlocksThatShareAnEntity) {
  const test::TemporaryFolder folder;
  Mesh made = test::plate(1);
  made.blocks = {test::make_block(test::triangle_type, 1, {1}, {0, 1, 3}, 1),
                 test::make_block(test::triangle_type, 1, {2}, {0, 3, 2}, 2),
                 test::make_block(test::triangle_type, 0, {}, {0, 3, 2}, 3)};
  made.groups = {{2, 1, "left"}, {2, 2, "right"}};
  write_mesh(made, folder / "made.msh");
  std::map<Tag, std::vector<Tag>> groups;
  for (const ElementBlock& block : read_mesh(folder / "made.msh").blocks)
    groups[block.tags[0]] = block.physical_groups;
  EXPECT_EQ(groups, (std::map<Tag, std::vector<Tag>>{{1, {1}}, {2, {2}}, {3, {}}}));
}

TEST(WriteMesh, IsReadByGmshWhenMadeInMemory) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  const Mesh made = test::ball_in_box(4);
  write_mesh(made, folder / "made.msh");
  const std::string resaved = (folder / "resaved.msh").string();
  ASSERT_EQ(test::run("gmsh -save -format msh41 -o " + resaved + " " +
                      (folder / "made.msh").string() + " > /dev/null 2>&1"),
            0);
  EXPECT_EQ(elements_of_groups(read_mesh(resaved)), elements_of_groups(made));
}

TEST(WriteMesh, NamesTheExtensionsThatArePossible) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(folder, "a.ply2", "3 1\n0 0 0 1 0 0 0 1 0\n3 0 1 2");
  try {
    write_mesh(mesh, folder / "a.doc");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("use one of "), std::string::npos) << error.what();
  }
  EXPECT_EQ(folder.n_files(), 1);
}

TEST(WriteMesh, TakesTheExtensionTheFileHad) {
  const test::TemporaryFolder folder;
  const Mesh mesh = read_text(folder, "a.Gmsh22", test::msh_bytes(zoo(), {.version = 2}));
  write_mesh(mesh, folder / "b.gmsh22");
  EXPECT_EQ(test::read_bytes(folder / "b.gmsh22"), test::read_bytes(folder / "a.Gmsh22"));
}

TEST(WriteMesh, RefusesPositionsThatAreNotFinite) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::plate(1);
  mesh.nodes[2][1] = std::nan("");
  EXPECT_THROW(write_mesh(mesh, folder / "a.msh"), InputError);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST(Ply2, IsReadAndPatched) {
  const test::TemporaryFolder folder;
  const Mesh mesh =
      read_text(folder, "a.ply2",
                "5\n2\n0 0 0\n 1.50 0  0 \n1 1 0\r\n0 1.0 0\n 2 2 2\n3  0 1 2\n4 0 1 2 3\n");
  EXPECT_EQ(mesh.format, MeshFormat::ply2);
  EXPECT_EQ(mesh.nodes[1], Vec3(1.5, 0, 0));
  ASSERT_EQ(mesh.blocks.size(), 2);
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.blocks[1].tags, std::vector<Tag>{2});
  Mesh moved = mesh;
  moved.nodes[1][1] = 0.25;
  moved.nodes[4] = {3, 2, 2};
  write_mesh(moved, folder / "b.ply2");
  EXPECT_EQ(test::read_bytes(folder / "b.ply2"),
            "5\n2\n0 0 0\n 1.50 0.25  0 \n1 1 0\r\n0 1.0 0\n 3 2 2\n3  0 1 2\n4 0 1 2 3\n");
}

TEST(CoordinateSpacing, IsThatOfTheLargestCoordinate) {
  Mesh mesh = test::icosphere(0, 1.0);
  mesh.nodes[0] = {0, -5, 0};  // binade [4, 8)
  EXPECT_EQ(coordinate_spacing(mesh), std::ldexp(4.0, -52));
  for (Vec3& x : mesh.nodes) x.setZero();
  EXPECT_EQ(coordinate_spacing(mesh), std::numeric_limits<double>::denorm_min());
}

// 5 lies in the binade [4, 8); a field of 16 characters holds -5 with 13 digits behind the point.
TEST(CoordinateSpacing, IsThatOfTheFileToBeWritten) {
  const test::TemporaryFolder folder;
  Mesh mesh = test::icosphere(0, 1.0);
  mesh.nodes[0] = {0, -5, 0};
  const double of_float = std::ldexp(4.0, -23), of_double = std::ldexp(4.0, -52);
  EXPECT_EQ(coordinate_spacing(mesh, "a.msh"), of_double);
  EXPECT_EQ(coordinate_spacing(mesh, "a.stl", {.encoding = Encoding::binary}), of_float);
  EXPECT_EQ(coordinate_spacing(mesh, "a.stl", {.encoding = Encoding::text}), of_double);
  EXPECT_DOUBLE_EQ(coordinate_spacing(mesh, "a.bdf"), 1e-13);
  write_mesh(mesh, folder / "a.stl", {.encoding = Encoding::binary});
  const Mesh read = read_mesh(folder / "a.stl");
  EXPECT_EQ(coordinate_spacing(read, "b.stl"), of_float);
  EXPECT_EQ(coordinate_spacing(read, "b.msh"), of_double);
}

TEST(RealFiles, ComeOutIdentical) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  const test::TemporaryFolder folder;
  struct Expected {
    const char* name;
    Index n_nodes;
    std::int64_t n_faces;
  };
  for (const Expected& expected : {Expected{"loth-sphere.ply2", 4294, 8584},
                                   {"aorta.stl", -1, 12455},
                                   {"nested_cubes.msh", 138, -1},
                                   {"periodic-torus-sector.msh", 1210, -1}}) {
    SCOPED_TRACE(expected.name);
    const std::filesystem::path path = std::filesystem::path(data) / "meshes" / expected.name;
    const Mesh mesh = read_mesh(path);
    if (expected.n_nodes > 0) {
      EXPECT_EQ(mesh.n_nodes(), expected.n_nodes);
    }
    if (expected.n_faces > 0) {
      EXPECT_EQ(n_elements(mesh, 2), expected.n_faces);
    }
    const std::filesystem::path copy = folder / expected.name;
    write_mesh(mesh, copy);
    EXPECT_EQ(test::read_bytes(copy), test::read_bytes(path));
  }
}

namespace {

// One change to each part of a mesh but its positions.
std::vector<std::function<void(Mesh&)>> changes_of_topology() {
  return {[](Mesh& mesh) { std::swap(mesh.blocks.back().nodes[0], mesh.blocks.back().nodes[1]); },
          [](Mesh& mesh) { mesh.blocks[0].tags[0] += 1000; },
          [](Mesh& mesh) { mesh.blocks[0].physical_groups = {77}; },
          [](Mesh& mesh) { mesh.blocks[0].entity += 50; },
          [](Mesh& mesh) { mesh.blocks.pop_back(); },
          [](Mesh& mesh) { mesh.groups[0].name += "x"; },
          [](Mesh& mesh) { mesh.node_tags.back() += 1000; },
          [](Mesh& mesh) { mesh.periodic_links[0].nodes.pop_back(); },
          [](Mesh& mesh) {
            mesh.nodes.emplace_back(1, 2, 3);
            mesh.node_tags.push_back(4000);
          }};
}

std::string refusal(const Mesh& mesh, const std::filesystem::path& path) {
  try {
    write_mesh(mesh, path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "written";
}

}  // namespace

// What is written anew is what the same mesh made in memory gives.
TEST(WriteMesh, WritesAnewWhatWasChangedSinceItWasRead) {
  const test::TemporaryFolder folder;
  for (const int version : {2, 4}) {
    const Mesh read = read_text(folder, "a.msh", test::msh_bytes(zoo(), {.version = version}));
    for (const auto& change : changes_of_topology()) {
      Mesh changed = read;
      change(changed);
      write_mesh(changed, folder / "changed.msh");
      changed.source.reset();
      write_mesh(changed, folder / "made.msh", {.format = changed.format});
      EXPECT_EQ(test::read_bytes(folder / "changed.msh"), test::read_bytes(folder / "made.msh"));
    }
  }
}

TEST(WriteMesh, LosesNoElementAddedSinceItWasRead) {
  const test::TemporaryFolder folder;
  Mesh mesh = read_text(folder, "a.msh", test::msh_bytes(test::plate(2), {.version = 2}));
  mesh.blocks.push_back(test::make_block(test::triangle_type, 2, {9}, {0, 1, 8}, 500));
  write_mesh(mesh, folder / "b.msh");
  EXPECT_EQ(n_elements(read_mesh(folder / "b.msh")), n_elements(test::plate(2)) + 1);
  mesh.blocks.back().nodes[0] = 9;  // one beyond the last node
  EXPECT_NE(refusal(mesh, folder / "c.msh").find("nodes that do not exist"), std::string::npos);
  EXPECT_EQ(folder.n_files(), 2);
}

TEST(WriteMesh, WritesOtherFormatsOnlyWherePositionsAloneChanged) {
  const test::TemporaryFolder folder;
  Mesh mesh = read_text(folder, "a.ply2", "3 1\n0 0 0 1 0 0 0 1 0\n3 0 1 2");
  mesh.blocks[0].nodes = {0, 2, 1};
  EXPECT_NE(refusal(mesh, folder / "b.ply2")
                .find("extension \".ply2\" is not written from this mesh, of which more than "
                      "positions was changed; use one of "),
            std::string::npos);
  EXPECT_EQ(refusal(mesh, folder / "b.msh"), "written");
  EXPECT_EQ(read_mesh(folder / "b.msh").blocks[0].nodes, mesh.blocks[0].nodes);
}
