// SPDX-License-Identifier: BSD-3-Clause
// Files of other people through the command: only positions change, other programs read the result,
// and what cannot be done is refused with its reason.
#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/format_files.hpp"
#include "support/process.hpp"

using namespace roughmesh;
using test::Outcome;

namespace {

class RealFiles : public testing::Test {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("ROUGHMESH_DATA");
    if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
    data_ = data;
  }

  std::filesystem::path data(const std::string& file) const { return data_ / file; }

  Outcome roughen(const std::filesystem::path& input, const std::string& arguments) const {
    return test::run_in(
        folder, std::string(ROUGHMESH_APP) + " roughen '" + input.string() + "' " + arguments);
  }

  /// What the command makes of a file.
  Mesh rough(const std::filesystem::path& input, const std::string& output,
             const std::string& arguments) const {
    const Outcome outcome = roughen(input, "-o " + output + " " + arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_mesh(folder / output);
  }

  nlohmann::json report(const std::string& name) const {
    return nlohmann::json::parse(test::read_bytes(folder / (name + ".report.json")));
  }

  /// Exit code 2, one line that holds the reason, and no file.
  void expect_refused(const std::filesystem::path& input, const std::string& arguments,
                      const std::string& reason) const {
    const auto before = folder.names();
    const Outcome outcome = roughen(input, "-o rough.msh " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(folder.names(), before);
  }

  test::TemporaryFolder folder;

 private:
  std::filesystem::path data_;
};

/// Nodes of the elements of one dimension in a group, or in any where `group` is 0.
std::set<Index> nodes_of(const Mesh& mesh, int of_dimension, Tag group) {
  std::set<Index> nodes;
  for (const ElementBlock& block : mesh.blocks) {
    const std::vector<Tag>& groups = block.physical_groups;
    const bool is_in = group == 0 || std::count(groups.begin(), groups.end(), group) > 0;
    if (is_in && dimension(block.type.shape) == of_dimension)
      nodes.insert(block.nodes.begin(), block.nodes.end());
  }
  return nodes;
}

double largest_move(const Mesh& mesh, const Mesh& rough) {
  double largest = 0;
  for (Index i = 0; i < mesh.n_nodes(); ++i)
    largest = std::max(largest, (rough.nodes[i] - mesh.nodes[i]).norm());
  return largest;
}

/// Heights of N correlated normal numbers are below 6 Rq but for one run in 10^8 / N.
void expect_moved(const Mesh& mesh, const Mesh& rough, double rms) {
  const double largest = largest_move(mesh, rough);
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 6 * rms);
}

std::string count_by_meshio(const test::TemporaryFolder& folder, const std::string& file) {
  return test::seen_by_meshio(folder, file,
                              "print(len(m.points), sum(len(c.data) for c in m.cells))\n");
}

std::string counts(const Mesh& mesh) {
  return std::to_string(mesh.n_nodes()) + " " + std::to_string(n_elements(mesh)) + "\n";
}

/// Corners of all elements, in order.
std::vector<Vec3> corners_of(const Mesh& mesh) {
  std::vector<Vec3> corners;
  for (const ElementBlock& block : mesh.blocks)
    for (const Index node : block.nodes) corners.push_back(mesh.nodes[node]);
  return corners;
}

void expect_near(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i] - b[i]).cwiseAbs().maxCoeff());
  EXPECT_LE(largest, tolerance);
}

// Coordinates of the files are at most 8: half a spacing of float32 there.
constexpr double float_error = 8 * 6e-8;

struct BareSurface {
  const char* file;
  double rms, length;  // some hundredths of the mesh size, and three of it
};

void PrintTo(const BareSurface& surface, std::ostream* out) { *out << surface.file; }

class BareSurfaces : public RealFiles, public testing::WithParamInterface<BareSurface> {};

}  // namespace

TEST_P(BareSurfaces, OnlyPositionsChange) {
  const auto& [file, rms, length] = GetParam();
  const std::filesystem::path input = data(std::string("meshes/") + file);
  const Mesh before = read_mesh(input);
  const Mesh after =
      rough(input, file, "--rms " + std::to_string(rms) + " --length " + std::to_string(length));
  test::expect_same_topology(after, before);
  expect_moved(before, after, rms);
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  EXPECT_EQ(count_by_meshio(folder, file), counts(before));
}

INSTANTIATE_TEST_SUITE_P(Data, BareSurfaces,
                         testing::Values(BareSurface{"spot.ply", 0.002, 0.14},
                                         BareSurface{"bob_small.ply", 0.01, 0.5},
                                         BareSurface{"lego.ply", 0.0005, 0.05},
                                         BareSurface{"aorta.stl", 0.01, 0.5}),
                         [](const auto& test) {
                           const std::string file = test.param.file;
                           return file.substr(0, file.find('.'));
                         });

// Put back where they were, the nodes give the bytes of the input: nothing else had changed.
TEST_F(RealFiles, APlyWithItsNodesPutBackIsItselfByteForByte) {
  const std::filesystem::path input = data("meshes/lego.ply");
  Mesh mesh = rough(input, "lego.ply", "--rms 0.0005 --length 0.05");
  EXPECT_NE(test::read_bytes(folder / "lego.ply"), test::read_bytes(input));
  mesh.nodes = read_mesh(input).nodes;
  write_mesh(mesh, folder / "back.ply");
  EXPECT_EQ(test::read_bytes(folder / "back.ply"), test::read_bytes(input));
}

TEST_F(RealFiles, AnStlIsReadByGmsh) {
  rough(data("meshes/aorta.stl"), "aorta.stl", "--rms 0.01 --length 0.5");
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  ASSERT_EQ(test::run_in(folder, "gmsh -0 aorta.stl -v 2 -o seen.msh").exit_code, 0);
  EXPECT_EQ(n_elements(read_mesh(folder / "seen.msh"), 2),
            n_elements(read_mesh(folder / "aorta.stl"), 2));
}

TEST_F(RealFiles, AOneSidedSurfaceIsRefused) {
  expect_refused(data("meshes/moebius.obj"), "--rms 0.001 --length 1", "one-sided");
}

// Twelve sides of two cubes, one in the other: one becomes rough, those beside it slide in their
// planes, and the rest stays.
TEST_F(RealFiles, OneSideOfNestedCubesBecomesRough) {
  const std::filesystem::path input = data("meshes/nested_cubes.msh");
  expect_refused(input, "--rms 0.01 --length 1", "several groups could become rough");
  const Mesh before = read_mesh(input);
  for (const Tag group : {1, 3, 7, 12}) {
    SCOPED_TRACE(group);
    const Mesh after =
        rough(input, "rough.msh", "--rms 0.005 --length 0.5 --group " + std::to_string(group));
    test::expect_same_topology(after, before);
    expect_moved(before, after, 0.005);
    const std::set<Index> moving = nodes_of(before, 2, group);
    for (const Index node : moving) EXPECT_NE(after.nodes[node], before.nodes[node]) << node;
    for (Tag side = 1; side <= 12; ++side) {
      Eigen::AlignedBox3d box;
      const std::set<Index> nodes = nodes_of(before, 2, side);
      for (const Index node : nodes) box.extend(before.nodes[node]);
      Eigen::Index axis = 0;
      box.sizes().minCoeff(&axis);
      for (const Index node : nodes)
        EXPECT_EQ(after.nodes[node][axis] == before.nodes[node][axis], side != group);
    }
    EXPECT_EQ(report("rough")["realizations"][0]["inverted_elements"], 0);
  }
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  ASSERT_EQ(test::run_in(folder, "gmsh -0 rough.msh -v 2 -format msh41 -o seen.msh").exit_code, 0);
  const Mesh seen = read_mesh(folder / "seen.msh");
  EXPECT_EQ(seen.n_nodes(), before.n_nodes());
  EXPECT_EQ(n_elements(seen), n_elements(before));
  EXPECT_EQ(seen.groups.size(), before.groups.size());
}

TEST_F(RealFiles, ElementsOfThirdOrderAreRefused) {
  for (const char* const group : {"1", "2", "3"})
    expect_refused(data("meshes/periodic-torus-sector.msh"),
                   std::string("--rms 0.001 --length 0.3 --group ") + group, "of order 3");
}

// The two ends of the sector are linked by a rotation: no field is periodic under it, but one that
// fades out before them needs none. Its corners alone are a mesh of first order.
TEST_F(RealFiles, RotationLinksNeedAFade) {
  Mesh mesh = read_mesh(data("meshes/periodic-torus-sector.msh"));
  for (ElementBlock& block : mesh.blocks) {
    const auto n = static_cast<std::size_t>(block.type.n_nodes);
    const auto corners = static_cast<std::size_t>(n_corners(block.type.shape));
    std::vector<Index> nodes;
    for (std::size_t i = 0; i < block.nodes.size(); ++i)
      if (i % n < corners) nodes.push_back(block.nodes[i]);
    block.nodes = std::move(nodes);
    block.type = {block.type.shape, 1, static_cast<int>(corners)};
  }
  write_mesh(mesh, folder / "torus.msh", {.format = MeshFormat::msh4});
  const Mesh torus = read_mesh(folder / "torus.msh");
  expect_refused(folder / "torus.msh", "--rms 0.001 --length 2 --group 3", "no translation");
  const Mesh after = rough(folder / "torus.msh", "rough.msh",
                           "--rms 0.001 --length 2 --group 3 --fade 0.5:1 --fade 0.5:2");
  test::expect_same_topology(after, torus);
  expect_moved(torus, after, 0.001);
  for (const Tag end : {1, 2})
    for (const Index node : nodes_of(torus, 2, end))
      EXPECT_EQ(after.nodes[node], torus.nodes[node]);
}

TEST_F(RealFiles, AStepFileBecomesARoughVolumeMesh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh =
      rough(data("cad/block.stp"), "block.msh", "--mesh-size 10 --rms 0.001 --length 5");
  EXPECT_EQ(dimension(mesh), 3);
  ASSERT_EQ(mesh.groups.size(), 1U);
  EXPECT_EQ(mesh.groups[0].name, "Block");
  const nlohmann::json said = report("block");
  EXPECT_EQ(said["input"]["nodes"], mesh.n_nodes());
  EXPECT_EQ(said["realizations"][0]["inverted_elements"], 0);
  ASSERT_EQ(test::run_in(folder, "gmsh -0 block.msh -v 2 -o seen.msh").exit_code, 0);
  EXPECT_EQ(n_elements(read_mesh(folder / "seen.msh"), 3), n_elements(mesh, 3));
}

// ---- Conversion

namespace {

const std::string spot_job = "--rms 0.002 --length 0.14 ";

std::string lost(const nlohmann::json& report) {
  for (const std::string warning : report["warnings"])
    if (const auto at = warning.find("left out: "); at != std::string::npos)
      return warning.substr(at + 10);
  return {};
}

}  // namespace

// The PLY holds float32, and so does STL; all others hold what was computed.
TEST_F(RealFiles, HeightsAreTheSameInEveryFormat) {
  const std::filesystem::path input = data("meshes/spot.ply");
  const Mesh reference = rough(input, "a.msh", spot_job);
  EXPECT_EQ(lost(report("a")), "comments and data of the input file");
  expect_near(corners_of(rough(input, "a.ply", spot_job)), corners_of(reference), float_error);
  for (const char* const output :
       {"a.obj", "a.off", "a.vtk", "b.msh --format msh2 --binary", "c.msh --format msh2 --ascii",
        "d.msh --format msh4 --ascii", "e.msh --format msh4 --binary", "f.vtk --binary"}) {
    SCOPED_TRACE(output);
    const std::string file(output, std::string(output).find('.') + 4);
    ASSERT_EQ(roughen(input, "-o " + (output + (" " + spot_job))).exit_code, 0);
    EXPECT_EQ(corners_of(read_mesh(folder / file)), corners_of(reference));
  }
}

TEST_F(RealFiles, AnStlHoldsTheSameTrianglesInFloat32) {
  const std::filesystem::path input = data("meshes/spot.ply");
  const Mesh reference = rough(input, "a.msh", spot_job);
  const Mesh stl = rough(input, "b.stl", spot_job);
  expect_near(corners_of(stl), corners_of(reference), float_error);
  EXPECT_EQ(stl.n_nodes(), reference.n_nodes());
  EXPECT_EQ(lost(report("b")),
            "digits of positions beyond float32, comments and data of the input file");
}

TEST_F(RealFiles, AVtuHoldsTheSamePositionsAndTheHeights) {
  if (!test::has_meshio()) GTEST_SKIP() << "no meshio";
  const std::filesystem::path input = data("meshes/spot.ply");
  // Along one normal a displacement is as long as its height; at a sharp edge it would be longer.
  const std::string job = spot_job + " --edges average";
  const Mesh reference = rough(input, "a.msh", job);
  ASSERT_EQ(roughen(input, "-o b.vtu " + job).exit_code, 0);
  const std::string seen = test::seen_by_meshio(
      folder, "b.vtu",
      "import numpy\nr = meshio.read('a.msh')\nd = m.point_data\n"
      "print(abs(m.points - r.points).max() == 0, (m.cells[0].data == r.cells[0].data).all(),\n"
      "      abs(abs(d['height']) - numpy.linalg.norm(d['displacement'], axis=1)).max() < "
      "1e-15)\n");
  EXPECT_EQ(seen.substr(seen.find_last_of('\n', seen.size() - 2) + 1), "True True True\n");
}

TEST_F(RealFiles, WhatAnotherFormatCannotHoldIsNamed) {
  const std::filesystem::path input = data("meshes/nested_cubes.msh");
  const std::string job = "--rms 0.005 --length 0.5 --group 1 ";
  rough(input, "a.stl", job);
  EXPECT_EQ(lost(report("a")),
            "520 volume elements, 14 physical groups, digits of positions beyond float32, comments "
            "and data of the input file");
  const Mesh ply = rough(input, "b.ply", job);
  EXPECT_EQ(n_elements(ply), 240);
  EXPECT_EQ(ply.groups.size(), 12U);
  EXPECT_NE(lost(report("b")).find("520 volume elements"), std::string::npos);
}
