// SPDX-License-Identifier: BSD-3-Clause
// PLY: whatever the header declares is read, and only numbers of moved nodes and normals change.
#include <array>
#include <bit>
#include <cstdlib>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/ply_files.hpp"
#include "support/refusals.hpp"
#include "support/surface_checks.hpp"

using namespace roughmesh;
using test::Kind;
using test::PlyStyle;
using test::PlyWriter;

namespace {

class Folder {
 public:
  Mesh read(const std::string& bytes) const {
    test::write_trial(folder / "a.ply", bytes);
    return read_mesh(folder / "a.ply");
  }
  std::string written(const Mesh& mesh, const WriteOptions& options = {}) const {
    write_mesh(mesh, folder / "b.ply", options);
    return test::read_bytes(folder / "b.ply");
  }
  test::TemporaryFolder folder;
};

class PlyFile : public testing::TestWithParam<PlyStyle>, public Folder {};
class Ply : public testing::Test, public Folder {};

const char* const small =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

bool has_normals(const PlyStyle& style) { return style.normals; }

}  // namespace

TEST_P(PlyFile, IsReadAsWritten) {
  const Mesh made = test::strip();
  const Mesh mesh = read(PlyWriter(made, GetParam()).bytes());
  EXPECT_EQ(mesh.format, MeshFormat::ply);
  test::expect_same_elements(mesh, made);
  EXPECT_EQ(mesh.node_tags, made.node_tags);
  EXPECT_TRUE(mesh.groups.empty());
}

TEST_P(PlyFile, ComesOutIdenticalWhenNothingMoves) {
  const std::string bytes = PlyWriter(test::strip(), GetParam()).bytes();
  EXPECT_EQ(written(read(bytes)), bytes);
}

// The expected file is the same writer's for the moved mesh; in text the coordinates that stay keep
// their odd digits. Normals are zero here and there: nodes that no moved face has keep theirs.
TEST_P(PlyFile, ChangesInMovedCoordinatesAndTheirNormalsOnly) {
  Mesh made = test::strip();
  PlyWriter writer(made, GetParam());
  Mesh moved = read(writer.bytes());
  const Vec3 there(-0.75, 1.5, -0.5);
  moved.nodes[3] = there;  // of the second triangle: nodes 6, 2, 3
  const std::string after = written(moved);
  made.nodes[3] = there;
  if (!GetParam().binary)
    writer.coordinate_text = [&](std::size_t node, int axis) {
      const bool stays = node != 3 || axis == 2;
      return stays ? fmt::format("{:.9e}", made.nodes[node][axis])
                   : fmt::format("{}", made.nodes[node][axis]);
    };
  if (has_normals(GetParam())) {
    writer.normals.assign(made.nodes.size(), Vec3::Zero());
    for (const Index node : {2, 3, 6})
      writer.normals[static_cast<std::size_t>(node)] = test::normal_at(made, node);
  }
  const std::string expected = writer.bytes();
  if (!has_normals(GetParam())) {
    EXPECT_EQ(after, expected);
  } else if (GetParam().binary) {
    ASSERT_EQ(after.size(), expected.size());
    // At most the last bits of nine numbers differ: two ways of rounding the same normal.
    std::size_t n_different = 0;
    for (std::size_t i = 0; i < after.size(); ++i) n_different += after[i] != expected[i];
    EXPECT_LE(n_different, 9 * 2);
  }
  EXPECT_EQ(read(after).nodes, made.nodes);
  test::expect_same_topology(read(after), moved);
}

TEST_P(PlyFile, SurvivesTruncationAndDamage) {
  const std::string whole = PlyWriter(test::strip(), GetParam()).bytes();
  test::expect_truncations_survived(folder, "a.ply", whole);
  test::expect_damage_survived(folder, "a.ply", whole);
}

// Of a binary file, whatever is cut off is missed.
TEST_P(PlyFile, IsRefusedWhenCut) {
  if (!GetParam().binary) GTEST_SKIP() << "half a number of text may be a number";
  const std::string whole = PlyWriter(test::strip(), GetParam()).bytes();
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_THROW(read(whole.substr(0, n)), FormatError);
}

INSTANTIATE_TEST_SUITE_P(Styles, PlyFile, testing::ValuesIn(test::all_ply_styles()),
                         [](const auto& test) { return name(test.param); });

namespace {

float float_at(const std::string& bytes, std::size_t offset) {
  float value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

// A normal of unit length has components below 1, so that float32 holds them to 2^-25; the sums of
// some ten terms of either order of operations agree to 1e-14.
TEST_F(Ply, NormalsAreThoseOfTheMovedSurface) {
  const Mesh sphere = test::icosphere(2);
  PlyWriter writer(sphere, {.binary = true, .normals = true});
  Mesh mesh = read(writer.bytes());
  for (Vec3& x : mesh.nodes) x = Vec3(1.5 * x[0], x[1] + 0.2 * x[0] * x[2], 0.5 * x[2]);
  const std::string after = written(mesh);
  Mesh stored = mesh;
  for (Vec3& x : stored.nodes) x = test::as_float(x);
  const std::size_t start = after.find("end_header\n") + 11;
  for (Index i = 0; i < mesh.n_nodes(); ++i) {
    const Vec3 expected = test::normal_at(stored, i);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(float_at(after, start + static_cast<std::size_t>(i) * 24 + 12 + 4 * k),
                  expected[static_cast<Eigen::Index>(k)], std::ldexp(1.0, -25) + 1e-14);
  }
}

TEST_F(Ply, NormalsSurviveTheSmallestAndLargestMeshes) {
  for (const double scale : {1e-150, 1e150}) {
    const Mesh plate = test::plate(1);
    Mesh mesh = read(PlyWriter(plate, {.real = "double", .normals = true}).bytes());
    for (Vec3& x : mesh.nodes) x *= scale;
    const std::string after = written(mesh);
    const std::string first = after.substr(after.find("end_header\n") + 11);
    EXPECT_EQ(first.substr(first.find('\n') - 7, 7), " 0 0 1 ") << scale;
  }
}

TEST_F(Ply, TakesFacesBeforeVerticesAndEdges) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n"
      "element edge 2\nproperty int vertex1\nproperty uchar sharp\nproperty int vertex2\n"
      "element vertex 3\nproperty float z\nproperty float x\nproperty float y\nend_header\n"
      "3 0 1 2\n0 9 1\n1 9 2\n0 0 0\n0 1 0\n0 0 1";
  const Mesh mesh = read(bytes);
  ASSERT_EQ(mesh.blocks.size(), 2);
  EXPECT_EQ(mesh.nodes[1], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.blocks[1].type, test::line_type);
  EXPECT_EQ(mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 1, 2}));
  EXPECT_EQ(mesh.blocks[1].tags, (std::vector<Tag>{2, 3}));
  Mesh moved = mesh;
  moved.nodes[2] = {0, 1, 0.5};
  EXPECT_EQ(written(moved), test::replaced(bytes, "\n0 0 1", "\n0.5 0 1"));
}

TEST_F(Ply, CoordinateSpacingIsThatOfTheFile) {
  for (const auto& [real, digits] : {std::pair{"float", 23}, std::pair{"double", 52}}) {
    const Mesh plate = test::plate(1, 5.0);  // 5 lies in the binade [4, 8)
    EXPECT_EQ(coordinate_spacing(read(PlyWriter(plate, {.binary = true, .real = real}).bytes())),
              std::ldexp(4.0, -digits));
  }
}

TEST_F(Ply, IsWrittenAnewWithGroupsLinesAndFields) {
  Mesh made = test::strip();
  made.nodes[4] = {0.1, 1.0 / 3, -1e-300};  // needs all digits
  made.blocks[0].physical_groups = {7};
  made.blocks[1].physical_groups = {-2};
  made.blocks.push_back(test::make_block(test::line_type, 0, {7}, {0, 1}, 4));
  made.groups = {{1, 7, "rim"}, {2, -2, "left side"}, {2, 7, ""}, {2, 9, "nobody's"}};
  WriteOptions options;
  options.fields = {{"x", 1, {1, 2, 3, 4, 5, 6, 7, 8}},
                    {"normal", 3, std::vector<double>(24, 0.5)}};
  for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
    options.encoding = encoding;
    const std::string bytes = written(made, options);
    EXPECT_NE(bytes.find("property double x_\nproperty double nx\n"), std::string::npos) << bytes;
    test::expect_same_topology(read(bytes), made);
    EXPECT_EQ(read(bytes).nodes, made.nodes);
    EXPECT_EQ(written(read(bytes)), bytes);
  }
  EXPECT_EQ(conversion_losses(made, folder / "b.ply"), std::vector<std::string>());
}

TEST_F(Ply, HoldsTheSurfaceOfAVolumeMesh) {
  const Mesh made = test::ball_in_box(4);
  const Mesh mesh = read(written(made));
  EXPECT_EQ(n_elements(mesh), n_elements(made, 2));
  EXPECT_LT(mesh.n_nodes(), made.n_nodes());  // the node in the middle is of no surface
  for (std::size_t b = 0; b < 2; ++b)
    for (Index i = 0; i < mesh.blocks[b].size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(mesh.blocks[b].element(i)[k])],
                  made.nodes[static_cast<std::size_t>(made.blocks[b].element(i)[k])]);
  EXPECT_EQ(conversion_losses(made, folder / "b.ply").front(),
            fmt::format("{} volume elements", n_elements(made, 3)));
}

TEST_F(Ply, RefusesMeshesThatItCannotHold) {
  Mesh volume = test::ball_in_box(4);
  volume.blocks.erase(volume.blocks.begin(), volume.blocks.begin() + 2);
  const auto message = [&](const Mesh& mesh) {
    return test::message_of([&] { write_mesh(mesh, folder / "b.ply"); });
  };
  EXPECT_NE(message(volume).find("no surface elements"), std::string::npos);
  Mesh curved = test::strip();
  curved.blocks[0] = test::make_block({ElementShape::triangle, 2, 6}, 0, {}, {0, 1, 2, 3, 4, 5}, 1);
  EXPECT_NE(message(curved).find("triangle of order 2"), std::string::npos);
  Mesh far = test::strip();
  far.blocks[0].physical_groups = {5'000'000'000};
  EXPECT_NE(message(far).find("5000000000"), std::string::npos);
  EXPECT_EQ(folder.n_files(), 0);
}

TEST_F(Ply, IsReadByMeshioWhenWrittenAnew) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const Mesh made = test::strip();  // without groups: meshio 5.3 stumbles over numbers of faces
  for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
    written(made, {.encoding = encoding});
    const std::string script =
        "import meshio; m = meshio.read('" + (folder / "b.ply").string() +
        "'); assert m.points.shape == (8, 3) and m.points[4][2] == 0.125; "
        "c = {b.type: b.data.tolist() for b in m.cells}; "
        "assert c == {'triangle': [[0, 1, 2], [6, 2, 3]], 'quad': [[1, 4, 5, 2]]}, c";
    EXPECT_EQ(test::run("/usr/bin/python3 -c \"" + script + "\""), 0);
  }
}

TEST_F(Ply, RealFilesComeOutIdenticalAndMove) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  for (const auto& [file, n_nodes, n_faces] :
       {std::tuple{"spot.ply", 2930, 5856}, std::tuple{"bob_small.ply", 250, 500},
        std::tuple{"lego.ply", 1649, 3072}}) {
    const std::string bytes = test::read_bytes(std::filesystem::path(data) / "meshes" / file);
    Mesh mesh = read(bytes);
    EXPECT_EQ(mesh.n_nodes(), n_nodes);
    EXPECT_EQ(n_elements(mesh, 2), n_faces);
    EXPECT_EQ(written(mesh), bytes);
    for (Vec3& x : mesh.nodes) x = 1.25 * x + Vec3(0, 0, 1);
    const Mesh again = read(written(mesh));
    test::expect_same_topology(again, mesh);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      EXPECT_EQ(again.nodes[i], test::as_float(mesh.nodes[i]));
  }
}

namespace {

std::vector<test::Refusal> refusals() {
  std::vector<test::Refusal> cases;
  const auto add = [&](const std::string& name, const std::string& what, const std::string& by,
                       const std::string& message, Kind kind = Kind::format_error) {
    cases.push_back({name, "a.ply", test::replaced(small, what, by), kind, message});
  };
  add("no_ply", "ply\n", "plx\n", ":1: does not begin with \"ply\"");
  add("format_unknown", "ascii", "utf8", ":2: header: \"utf8\" is no PLY format");
  add("format_version", "ascii 1.0", "ascii 2.0", "version \"2.0\"");
  add("format_missing", "format ascii 1.0\n", "", "declares no format");
  add("header_without_end", "end_header\n", "", ":9: header: \"0\" is no word");
  add("header_word", "element face", "elements face", ":7: header: \"elements\" is no word");
  add("property_first", "element vertex 3\n", "", ":3: header: a property stands before");
  add("property_type", "float x", "real x", "\"real\" is no type");
  add("property_list_of_real_length", "list uchar", "list float", "it must be whole");
  add("count_not_whole", "vertex 3", "vertex 3.5", ":3: header: expected a whole number");
  add("count_negative", "vertex 3", "vertex -3", "cannot be negative");
  add("count_huge", "vertex 3", "vertex 300000000", "do not fit");
  add("count_beyond_index", "vertex 3", "vertex 3000000000", "split the mesh", Kind::input_error);
  add("count_zero", "vertex 3", "vertex 0", "no vertices");
  add("faces_huge", "face 1", "face 1000000", "do not fit");
  add("faces_too_many", "face 1", "face 2", ":14: face: the file ends here");
  add("faces_too_few", "3 0 1 2\n", "3 0 1 2\n3 0 1 2\n", ":14: face: something stands behind");
  add("no_faces", "element face 1", "element face 0", "stands behind");
  add("coordinate_missing", "property float y\n", "", "no property y");
  add("coordinate_of_whole_type", "float y", "int y", "no property y of type float or double");
  add("coordinate_nan", "1 0 0", "1 nan 0", ":11: vertex: a number is not finite");
  add("coordinate_word", "1 0 0", "1 zero 0", "found \"zero\"");
  add("indices_missing", "vertex_indices", "corners", "no list vertex_indices");
  add("indices_real", "uchar int", "uchar float", "no list vertex_indices");
  add("corner_dangling", "3 0 1 2", "3 0 1 3", ":13: face: node 3 does not exist");
  add("corner_negative", "3 0 1 2", "3 0 -1 2", "node -1 does not exist");
  add("face_pentagon", "3 0 1 2", "5 0 1 2 0 1", "a face with 5 corners");
  add("face_with_two_corners", "3 0 1 2", "2 0 1", "a face with 2 corners");
  add("element_without_properties", "element face", "element nothing 5\nelement face",
      "nothing: the header gives it no properties");
  add("strips", "element face 1", "element tristrips 1", "save it with faces", Kind::input_error);
  cases.push_back({"points_only", "a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n0 0 0\n",
                   Kind::input_error, "no faces"});
  cases.push_back(
      {"header_cut", "a.ply", std::string(small).substr(0, 60), Kind::format_error, ""});
  const std::string binary = PlyWriter(test::strip(), {.binary = true}).bytes();
  const std::size_t start = binary.find("end_header\n") + 11;
  std::string bytes = binary;
  bytes.replace(start + 12, 4, std::string("\0\0\x80\x7f", 4));
  cases.push_back({"binary_infinite", "a.ply", bytes, Kind::format_error,
                   fmt::format("byte {}: vertex: a coordinate is not finite", start + 12)});
  cases.push_back({"binary_longer", "a.ply", binary + "x", Kind::format_error, "a count is wrong"});
  bytes = binary;
  bytes[start + 8 * 12 + 1] = '\x7f';
  cases.push_back({"binary_dangling", "a.ply", bytes, Kind::format_error, "node 127"});
  return cases;
}

class MalformedPly : public testing::TestWithParam<test::Refusal> {};

TEST_P(MalformedPly, IsRefusedInOneLine) {
  test::expect_refusal(test::TemporaryFolder(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, MalformedPly, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

}  // namespace

TEST_F(Ply, TakesTheFileThatTheCasesAreMadeFrom) { EXPECT_EQ(n_elements(read(small)), 1); }

// Elements and lists that a hostile header declares take no more than linear time.
TEST_F(Ply, TakesLinearTimeForManySmallParts) {
  std::string header = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 100'000; ++i) header += fmt::format("element e{} 0\nproperty int a\n", i);
  const std::string bytes = header + std::string(small).substr(21);
  EXPECT_EQ(read(bytes).n_nodes(), 3);
}
