// SPDX-License-Identifier: BSD-3-Clause
// Sides of periodic cells stay images of each other; partitions and meshes of gmsh.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"
#include "roughmesh/pipeline.hpp"
#include "roughmesh/walls.hpp"

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/rough_boxes.hpp"

using namespace roughmesh;
using test::add_group;
using test::box;
using test::Height;
using test::hilly;
using test::move;
using test::Moved;
using test::waves;

namespace {

// The box as a periodic cell: links of the sides x = 1 and y = 1 to those at 0, for the corners to
// both.
Mesh periodic_box(int divisions) {
  Mesh mesh = box(divisions);
  std::map<std::array<long, 3>, Index> node_at;
  const auto key = [&](const Vec3& x) {
    return std::array{std::lround(x.x() * divisions), std::lround(x.y() * divisions),
                      std::lround(x.z() * divisions)};
  };
  for (Index node = 0; node < mesh.n_nodes(); ++node) node_at[key(mesh.nodes[node])] = node;
  for (const int axis : {0, 1}) {
    PeriodicLink link{2, 100 + axis, 200 + axis, {}, {}};
    for (const auto& [at, node] : node_at) {
      auto of_master = at;
      if (std::exchange(of_master[static_cast<std::size_t>(axis)], 0) == divisions)
        link.nodes.emplace_back(node, node_at[of_master]);
    }
    mesh.periodic_links.push_back(std::move(link));
  }
  return mesh;
}

// Of period 1 along x and y.
double periodic_waves(const Vec3& x) {
  using std::numbers::pi;
  return std::sin(2 * pi * x.x() + 1) * std::cos(2 * pi * x.y()) + 0.4 * std::cos(4 * pi * x.x());
}

}  // namespace

// Images move by the same vector, on the surface, in the sides, and after the foldover-free map;
// differences of coordinates are those of the input but for one rounding of a number below 2.
TEST(PeriodicWalls, ImagesStayImages) {
  const Mesh mesh = hilly(periodic_box(8));
  for (const double height : {0.03, 0.17}) {
    const Moved moved =
        move(mesh, "top", [&](const Vec3& x) { return height * periodic_waves(x); });
    EXPECT_TRUE(check_mesh(mesh, moved.nodes).valid());
    EXPECT_EQ(moved.method, height > 0.1 ? VolumeMethod::foldover_free : VolumeMethod::harmonic);
    int n_moved = 0;
    for (const PeriodicLink& link : mesh.periodic_links)
      for (const auto& [slave, master] : link.nodes) {
        const Vec3 apart = moved.nodes[slave] - moved.nodes[master];
        const Vec3 before = mesh.nodes[slave] - mesh.nodes[master];
        EXPECT_LE((apart - before).cwiseAbs().maxCoeff(), 0x1p-52);
        n_moved += moved.nodes[slave] != mesh.nodes[slave];
      }
    EXPECT_EQ(n_moved, 2 * 9 * 8);
  }
}

// Without links, but with a period, nodes at equal positions modulo the period are images.
TEST(PeriodicWalls, APeriodJoinsNodesByPosition) {
  Mesh mesh = periodic_box(8);
  const Height height = [](const Vec3& x) { return 0.1 * periodic_waves(x); };
  const Moved linked = move(mesh, "top", height);
  mesh.periodic_links.clear();
  const Moved placed = move(mesh, "top", height, {.period = Vec3(1, 1, 0)});
  EXPECT_EQ(placed.nodes, linked.nodes);
  EXPECT_NE(move(mesh, "top", height).nodes, linked.nodes);
}

// A node linked by a rotation has no displacement that its image could share: both stay.
TEST(PeriodicWalls, NodesLinkedByRotationsStay) {
  Mesh mesh = box(8);
  PeriodicLink link{2, 1, 2, {}, {}};  // the side x = 0 is the side y = 0 turned about the z axis
  for (Index a = 0; a < mesh.n_nodes(); ++a)
    for (Index b = 0; b < mesh.n_nodes(); ++b) {
      const Vec3 &x = mesh.nodes[a], &y = mesh.nodes[b];
      if (x.x() == 0 && y.y() == 0 && x.y() == y.x() && x.z() == y.z() && x.z() < 1)
        link.nodes.emplace_back(a, b);
    }
  ASSERT_EQ(link.nodes.size(), 72U);
  mesh.periodic_links = {link};
  const Moved moved = move(mesh, "top", [](const Vec3& x) { return 0.03 * waves(x); });
  for (const auto& [slave, master] : link.nodes) {
    EXPECT_EQ(moved.nodes[slave], mesh.nodes[slave]);
    EXPECT_EQ(moved.nodes[master], mesh.nodes[master]);
  }
}

namespace {

// Sixty degrees around the z axis, between the radii 1 and 2, whose ends "first" and "last" are
// linked by a rotation.
Mesh sector(int divisions) {
  using std::numbers::pi;
  Mesh mesh = box(divisions);
  add_group(mesh, 5, "first", [](const Vec3& x) { return x.x() == 0; });
  add_group(mesh, 6, "last", [](const Vec3& x) { return x.x() == 1; });
  const double c = 0.5, d = std::sqrt(0.75);
  PeriodicLink link{2, 6, 5, {c, d, 0, 0, -d, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {}};
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (mesh.nodes[node].x() == 1) link.nodes.emplace_back(node, node - divisions);
  mesh.periodic_links = {link};
  for (Vec3& x : mesh.nodes) {
    const double angle = -pi / 3 * x.x(), radius = 1 + x.y();
    x = Vec3(radius * std::cos(angle), radius * std::sin(angle), x.z());
  }
  return mesh;
}

// Rough up to both ends, the roughness cannot be; where it fades before, ends stay images.
void expect_sector(const Mesh& mesh, RoughenOptions options, const std::vector<std::string>& fade) {
  const auto run = [&](const Deliver& deliver) { roughen(mesh, options, deliver); };
  EXPECT_THROW(run([](const RoughMesh&, Report&) {}), InputError);
  options.surfaces[0].fade = fade;
  run([&](const RoughMesh& rough, Report&) {
    EXPECT_NE(rough.mesh.nodes, mesh.nodes);
    EXPECT_TRUE(rough.check.valid());
    for (const PeriodicLink& link : mesh.periodic_links) {
      const Eigen::Affine3d to_slave(
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(link.affine.data()));
      for (const auto& [slave, master] : link.nodes)
        EXPECT_NEAR((rough.mesh.nodes[slave] - to_slave * rough.mesh.nodes[master]).norm(), 0,
                    1e-14);
    }
  });
}

}  // namespace

TEST(PeriodicWalls, EndsOfASectorStayImagesWhereTheRoughnessFades) {
  RoughenOptions options;
  options.surfaces[0].group = {"top"};
  options.surfaces[0].rms = 0.05;
  options.surfaces[0].length = {0.4};
  expect_sector(sector(8), options, {"0.3:first", "0.3:last"});
}

// A file of other people, whose elements of order 3 are taken at their corners.
TEST(PeriodicWalls, ASectorOfATorusStaysOne) {
  const char* data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "ROUGHMESH_DATA is not set";
  Mesh mesh = read_mesh(std::filesystem::path(data) / "meshes/periodic-torus-sector.msh");
  for (ElementBlock& block : mesh.blocks) {
    ElementBlock corners = block;
    corners.type = test::first_order(block.type.shape);
    corners.nodes.clear();
    for (Index e = 0; e < block.size(); ++e)
      for (int k = 0; k < corners.type.n_nodes; ++k)
        corners.nodes.push_back(block.element(e)[static_cast<std::size_t>(k)]);
    block = std::move(corners);
  }
  ASSERT_EQ(mesh.periodic_links.size(), 5U);
  RoughenOptions options;
  options.surfaces[0].group = {"3"};
  options.surfaces[0].rms = 0.02;
  options.surfaces[0].length = {1};
  expect_sector(mesh, options, {"0.5:1", "0.5:2"});
}

// ---- Meshes of gmsh ----

namespace {

constexpr const char* slab_script =
    "SetFactory(\"OpenCASCADE\"); h = 0.08; Box(1) = {0, 0, 0, 1, 1, 0.5};\n"
    "Mesh.CharacteristicLengthMin = h; Mesh.CharacteristicLengthMax = h;\n"
    "Physical Surface(\"top\", 1) = {6}; Physical Surface(\"sides\", 2) = {1:4};\n"
    "Physical Surface(\"bottom\", 3) = {5}; Physical Volume(\"slab\", 1) = {1};\n";

Mesh gmsh_slab(const std::string& options, const std::string& more = "") {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "slab.geo", slab_script + more);
  EXPECT_EQ(test::run_in(folder, "gmsh -3 slab.geo -v 1 -o slab.msh " + options).exit_code, 0);
  return read_mesh(folder / "slab.msh");
}

RoughenOptions slab_options(double rms, double length) {
  RoughenOptions options;
  options.surfaces = {Roughness{}};
  options.surfaces[0].group = {"top"};
  options.surfaces[0].rms = rms;
  options.surfaces[0].length = {length};
  return options;
}

}  // namespace

// Rq/h = 0.7 and l = 1.77 h.
TEST(PeriodicWalls, TenRoughSlabsAreValidWithPlaneWalls) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh = gmsh_slab("-format msh41");
  RoughenOptions options = slab_options(0.7 * 0.08, 1.77 * 0.08);
  const Enclosure enclosure(mesh);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    options.surfaces[0].seed = seed;
    const Report report = roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
      EXPECT_TRUE(rough.surface_check.valid());
      EXPECT_TRUE(rough.check.valid());
      EXPECT_LE(enclosure.volume_error(rough.mesh, rough.mesh.nodes), 1e-12);
      for (Index node = 0; node < mesh.n_nodes(); ++node) {
        const Vec3& x = mesh.nodes[node];
        for (const int axis : {0, 1})
          if (x[axis] == 0 || x[axis] == 1) {
            EXPECT_EQ(rough.mesh.nodes[node][axis], x[axis]);
          }
        if (x.z() == 0) {
          EXPECT_EQ(rough.mesh.nodes[node], x);
        }
      }
    });
    for (const std::string& warning : report.warnings)
      EXPECT_EQ(warning.find("cannot slide"), warning.npos) << warning;
  }
}

// Partitions, with faces between them and ghosts, change no coordinate: the same mesh becomes the
// same rough mesh.
TEST(PeriodicWalls, PartitionsChangeNothing) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const auto rough_nodes = [](const Mesh& mesh, const char* group) {
    RoughenOptions options = slab_options(0.04, 0.15);
    options.surfaces[0].group = {group};
    std::vector<Vec3> nodes;
    roughen(mesh, options, [&](const RoughMesh& rough, Report&) { nodes = rough.mesh.nodes; });
    return nodes;
  };
  const Mesh whole = gmsh_slab("-format msh41");
  for (const char* format : {"msh41", "msh22"})
    for (const char* ghosts : {"", " -part_ghosts"}) {
      SCOPED_TRACE(std::string(format) + ghosts);
      const Mesh parts = gmsh_slab(std::string("-part 3 -format ") + format + ghosts);
      ASSERT_EQ(parts.n_nodes(), whole.n_nodes());
      EXPECT_EQ(n_elements(parts, 3), n_elements(whole, 3));
      for (const char* group : {"top", "all"}) {
        std::map<std::array<double, 3>, Vec3> rough_of;
        const std::vector<Vec3> expected = rough_nodes(whole, group);
        for (Index node = 0; node < whole.n_nodes(); ++node) {
          const Vec3& x = whole.nodes[node];
          rough_of[{x.x(), x.y(), x.z()}] = expected[node];
        }
        const std::vector<Vec3> nodes = rough_nodes(parts, group);
        for (Index node = 0; node < parts.n_nodes(); ++node) {
          const Vec3& x = parts.nodes[node];
          EXPECT_NEAR((nodes[node] - rough_of[{x.x(), x.y(), x.z()}]).norm(), 0, 1e-10);
        }
      }
    }
}

// The links of gmsh, with the transformations that it writes: slaves are where these put them.
TEST(PeriodicWalls, ImagesOfAGmshCellStayImages) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const Mesh mesh = gmsh_slab("-format msh41",
                              "Periodic Surface {2} = {1} Translate {1, 0, 0};\n"
                              "Periodic Surface {4} = {3} Translate {0, 1, 0};\n");
  ASSERT_GT(mesh.periodic_links.size(), 1U);
  RoughenOptions options = slab_options(0.056, 0.2);
  options.realizations = 3;
  roughen(mesh, options, [&](const RoughMesh& rough, Report&) {
    EXPECT_TRUE(rough.check.valid());
    for (const PeriodicLink& link : mesh.periodic_links)
      for (const auto& [slave, master] : link.nodes)
        EXPECT_LE(((rough.mesh.nodes[slave] - rough.mesh.nodes[master]) -
                   (mesh.nodes[slave] - mesh.nodes[master]))
                      .cwiseAbs()
                      .maxCoeff(),
                  0x1p-52);
  });
}
