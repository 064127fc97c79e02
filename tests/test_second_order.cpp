// SPDX-License-Identifier: BSD-3-Clause
// Elements of order 2: facets, boundaries, and how their inner nodes follow.
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/check.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/move_volume.hpp"

#include "element_nodes.hpp"
#include "support/cells.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/only.hpp"
#include "support/planar.hpp"
#include "support/second_order.hpp"

using namespace roughmesh;

namespace {

constexpr std::array volume_shapes = {ElementShape::tetrahedron, ElementShape::hexahedron,
                                      ElementShape::prism, ElementShape::pyramid};
constexpr std::array face_shapes = {ElementShape::triangle, ElementShape::quadrangle};

Mesh single(ElementShape shape, bool complete) {
  return test::second_order(test::single_element(shape, test::ideal_corners(shape)), complete);
}

Vec3 mean(const Mesh& mesh, std::span<const Index> element, std::span<const int> local) {
  Vec3 sum = Vec3::Zero();
  for (const int k : local) sum += mesh.nodes[element[k]];
  return sum / static_cast<double>(local.size());
}

std::vector<Vec3> constant(const Surface& surface, const Vec3& value) {
  return std::vector<Vec3>(surface.nodes.size(), value);
}

bool has_pyramids(const Mesh& mesh) {
  return std::any_of(mesh.blocks.begin(), mesh.blocks.end(), [](const ElementBlock& block) {
    return block.type.shape == ElementShape::pyramid;
  });
}

std::vector<Vec3> shifts(const Mesh& mesh, const std::vector<Vec3>& moved) {
  std::vector<Vec3> result = moved;
  for (std::size_t i = 0; i < moved.size(); ++i) result[i] -= mesh.nodes[i];
  return result;
}

/// Makes what nodes of the surface that are no corners are told the mean of what the corners
/// around them are.
void keep_straight(const Mesh& mesh, const Surface& surface, std::vector<Vec3>& told) {
  std::map<Index, std::size_t> at;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i) at[surface.nodes[i]] = i;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) == surface.dimension && e < block.size(); ++e) {
      const auto nodes = block.element(e);
      if (at.count(nodes[0]) == 0 || at.count(nodes.back()) == 0) continue;
      std::vector<Vec3> of_element;
      of_element.reserve(nodes.size());
      for (const Index node : nodes) of_element.push_back(told[at.at(node)]);
      for (const detail::FollowingNode& following : detail::following_nodes(block.type)) {
        Vec3 sum = Vec3::Zero();
        for (const auto& [other, weight] : following.of_others) sum += weight * of_element[other];
        of_element[following.node] = told[at.at(nodes[following.node])] = sum;
      }
    }
}

/// Boundary elements and cells of a unit box, or of a unit square.
struct Body {
  Mesh mesh;
  std::string group;  // what is moved
};

std::vector<Body> bodies() {
  std::vector<Body> result;
  for (const bool complete : {false, true}) {
    for (const ElementShape shape : volume_shapes)
      result.push_back({test::second_order(test::cell_box(shape, 4), complete), "top"});
    for (const bool quadrangles : {false, true})
      result.push_back({test::second_order(test::ring(32, quadrangles), complete), "interface"});
  }
  return result;
}

}  // namespace

// Facets have the orientation of the element, so that area vectors add up to that of the element;
// if one overlapped another or lay outside, the areas would be more.
TEST(SecondOrder, FacetsFillTheElement) {
  for (const ElementShape shape : face_shapes)
    for (const bool complete : {false, true}) {
      const Mesh mesh = single(shape, complete);
      const auto nodes = mesh.blocks[0].element(0);
      Vec3 sum = Vec3::Zero();
      double area = 0;
      std::set<int> used;
      for (const std::vector<int>& facet : detail::facets(mesh.blocks[0].type)) {
        std::vector<Vec3> corners;
        for (const int k : facet) corners.push_back(mesh.nodes[nodes[k]]);
        used.insert(facet.begin(), facet.end());
        sum += area_vector(corners);
        area += area_vector(corners).norm();
      }
      const Vec3 whole = area_vector(test::ideal_corners(shape));
      EXPECT_NEAR((sum - whole).norm(), 0, 1e-15);
      EXPECT_NEAR(area, whole.norm(), 1e-15);
      EXPECT_EQ(static_cast<int>(used.size()), mesh.blocks[0].type.n_nodes);
    }
}

// Where Gmsh puts the nodes of order 2 tells which edge and face they belong to.
TEST(SecondOrder, NodesStandWhereGmshPutsThem) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  for (const bool complete : {false, true})
    for (const ElementShape shape :
         {ElementShape::triangle, ElementShape::quadrangle, ElementShape::tetrahedron,
          ElementShape::hexahedron, ElementShape::prism, ElementShape::pyramid}) {
      Mesh linear = test::single_element(shape, test::ideal_corners(shape));
      linear.format = MeshFormat::msh2;
      write_mesh(linear, (folder / "in.msh").string());
      test::write_bytes(folder / "a.geo",
                        fmt::format("Mesh.SecondOrderIncomplete = {};\nMerge \"in.msh\";\nSetOrder "
                                    "2;\nSave \"out.msh\";\n",
                                    complete ? 0 : 1));
      ASSERT_EQ(test::run("cd " + folder.path().string() + " && gmsh a.geo - > log 2>&1"), 0);
      const Mesh mesh = read_mesh((folder / "out.msh").string());
      const auto block = std::find_if(
          mesh.blocks.begin(), mesh.blocks.end(),
          [&](const ElementBlock& b) { return b.type.shape == shape && b.size() == 1; });
      ASSERT_NE(block, mesh.blocks.end());
      ASSERT_EQ(block->type, single(shape, complete).blocks[0].type);
      const auto nodes = block->element(0);
      int next = n_corners(shape);
      const auto expect_at = [&](std::span<const int> corners) {
        EXPECT_NEAR((mesh.nodes[nodes[next++]] - mean(mesh, nodes, corners)).norm(), 0, 1e-15)
            << name(block->type) << " node " << next - 1;
      };
      for (const auto& edge : local_edges(shape)) expect_at(edge);
      for (const std::vector<int>& face : local_faces(shape))
        if (complete && face.size() == 4) expect_at(face);
      if (next < block->type.n_nodes) {
        std::vector<int> all(static_cast<std::size_t>(n_corners(shape)));
        std::iota(all.begin(), all.end(), 0);
        expect_at(all);
      }
      EXPECT_EQ(next, block->type.n_nodes);
    }
}

// On each side of a straight element the nodes must be those of a straight face.
TEST(SecondOrder, SidesHaveTheirNodes) {
  for (const ElementShape shape : volume_shapes)
    for (const bool complete : {false, true}) {
      const Mesh mesh = single(shape, complete);
      const auto nodes = mesh.blocks[0].element(0);
      for (const detail::LocalFace& face : detail::element_faces(mesh.blocks[0].type)) {
        const int n = n_corners(face.type.shape);
        ASSERT_EQ(face.type.n_nodes, complete && n == 4 ? 9 : 2 * n);
        for (int k = 0; k < n; ++k)
          EXPECT_NEAR((mesh.nodes[nodes[face.nodes[n + k]]] -
                       mean(mesh, nodes, std::array{face.nodes[k], face.nodes[(k + 1) % n]}))
                          .norm(),
                      0, 1e-15);
        if (face.type.n_nodes == 9) {
          EXPECT_NEAR(
              (mesh.nodes[nodes[face.nodes[8]]] - mean(mesh, nodes, std::span(face.nodes).first(4)))
                  .norm(),
              0, 1e-15);
        }
      }
    }
}

// The boundary of a box: closed, of area 6, with every node of the sides on it.
TEST(SecondOrder, BoundaryOfABoxOfEveryShape) {
  for (const ElementShape shape : volume_shapes)
    for (const bool complete : {false, true}) {
      const Mesh linear = test::without_faces(test::cell_box(shape, 4));
      const Mesh mesh = test::second_order(linear, complete);
      const Surface boundary = select_surface(mesh);
      EXPECT_EQ(boundary.n_elements, select_surface(linear).n_elements);
      EXPECT_GE(boundary.n_faces(), 4 * boundary.n_elements);
      EXPECT_EQ(boundary.n_border_edges, 0);
      EXPECT_EQ(boundary.n_nonmanifold_edges, 0);
      EXPECT_EQ(boundary.n_components, 1);
      EXPECT_NEAR(boundary.area, 6, 1e-13);
      EXPECT_NEAR(enclosed_volume(boundary, boundary.points), 1, 1e-13);
      const auto n_on_sides = std::count_if(
          mesh.nodes.begin(), mesh.nodes.end(),
          [](const Vec3& x) { return x.minCoeff() < 1e-12 || x.maxCoeff() > 1 - 1e-12; });
      EXPECT_EQ(boundary.n_points(), n_on_sides);
      EXPECT_EQ(boundary.mesh_size.min, 0.125);  // half an edge
    }
}

// Eq. 2 and 35 know nothing of elements: with all nodes on a sphere or circle, normals are exact.
TEST(SecondOrder, NormalsOfSphereAndCircleAreExact) {
  for (const bool is_circle : {false, true}) {
    Mesh mesh = test::second_order(
        is_circle ? test::polyline(test::circle_points(test::uneven_angles(20), 1), true)
                  : test::icosphere(2),
        true);
    for (Vec3& x : mesh.nodes) x.normalize();
    const Surface surface = select_surface(mesh);
    EXPECT_EQ(surface.n_elements, is_circle ? 20 : 320);
    EXPECT_EQ(surface.n_faces(), is_circle ? 40 : 1280);
    EXPECT_EQ(surface.n_points(), is_circle ? 40 : 642);
    for (Index i = 0; i < surface.n_points(); ++i)
      EXPECT_NEAR((surface.normals[i] - surface.points[i]).norm(), 0, 1e-13);
  }
}

// Like the linear mesh on the same corners: outward, out of the lower-numbered of two.
TEST(SecondOrder, OrientationIsThatOfTheLinearMesh) {
  for (const ElementShape shape : volume_shapes)
    for (const bool complete : {false, true}) {
      Mesh mesh = test::second_order(test::cell_box(shape, 4), complete);
      for (const Vec3& n : select_surface(mesh, {.groups = {"middle"}}).normals)
        EXPECT_NEAR((n - Vec3::UnitZ()).norm(), 0, 1e-14);
      for (ElementBlock& block : mesh.blocks)
        if (dimension(block.type.shape) == 3) block.entity = 3 - block.entity;
      for (const Vec3& n : select_surface(mesh, {.groups = {"middle"}}).normals)
        EXPECT_NEAR((n + Vec3::UnitZ()).norm(), 0, 1e-14);
    }
}

// The values at the middles are exact for quadratic functions on ideal squares and cubes.
TEST(SecondOrder, MiddlesInterpolateQuadraticFunctions) {
  const auto f = [](const Vec3& x) {
    return 1 + 2 * x.x() - x.y() + 3 * x.z() + x.x() * x.x() - 2 * x.y() * x.y() +
           5 * x.z() * x.z() + 7 * x.x() * x.y() - 4 * x.y() * x.z() + 6 * x.x() * x.z();
  };
  int n_middles = 0;
  for (const ElementShape shape : {ElementShape::quadrangle, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid}) {
    const Mesh mesh = single(shape, true);
    const auto nodes = mesh.blocks[0].element(0);
    for (const detail::FollowingNode& following : detail::following_nodes(mesh.blocks[0].type)) {
      double value = 0, weights = 0;
      for (const auto& [other, weight] : following.of_others) {
        EXPECT_LT(other, following.node);
        value += weight * f(mesh.nodes[nodes[other]]);
        weights += weight;
      }
      EXPECT_EQ(weights, 1);
      if (following.of_others.size() == 2) continue;
      ++n_middles;
      EXPECT_NEAR(value, f(mesh.nodes[nodes[following.node]]), 1e-14);
    }
  }
  EXPECT_EQ(n_middles, 1 + 7 + 3 + 1);
}

// Corners move as those of the linear mesh do; what stays, stays; the nodes of the surface, all of
// them, go where they are told. Where its edges and faces are told to stay straight, so does every
// inner edge: the node in the middle keeps the middle.
TEST(SecondOrder, InnerNodesFollowTheirEdges) {
  for (const Body& body : bodies()) {
    const Mesh& mesh = body.mesh;
    const Surface surface = select_surface(mesh, {.groups = {body.group}});
    std::vector<Vec3> told;
    for (const Index node : surface.nodes) {
      const Vec3& x = mesh.nodes[node];
      told.push_back(0.02 * Vec3(std::sin(9 * x.y()), std::cos(8 * x.x()), 0));
      if (surface.dimension == 2) told.back().z() = 0.05 * std::sin(5 * x.x() + 7 * x.y());
      // Walls stay as they are, so that the rim has to.
      if (surface.dimension == 2 &&
          (x.head<2>().minCoeff() < 1e-9 || x.head<2>().maxCoeff() > 1 - 1e-9))
        told.back().setZero();
    }
    keep_straight(mesh, surface, told);
    const VolumeMover mover(mesh, test::only(surface));
    EXPECT_TRUE(mover.moves_interior());
    const std::vector<Vec3> moved = mover.move(told).nodes;
    const std::vector<Vec3> u = shifts(mesh, moved);
    std::vector<int> on_surface(mesh.nodes.size(), 0);
    for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
      EXPECT_EQ(moved[surface.nodes[i]], mesh.nodes[surface.nodes[i]] + told[i]);
      on_surface[surface.nodes[i]] = 1;
    }
    const auto stays = [&](const Vec3& x) {
      if (surface.dimension == 1) return x.norm() > 1 - 1e-3 * 20 || x.norm() < 0.25 + 1e-9;
      return x.minCoeff() < 1e-9 || x.maxCoeff() > 1 - 1e-9 || x.z() < 0.5 + 1e-9;
    };
    int n_following = 0;
    for (const ElementBlock& block : mesh.blocks) {
      if (dimension(block.type.shape) != surface.dimension + 1) continue;
      const auto edges = local_edges(block.type.shape);
      for (Index e = 0; e < block.size(); ++e)
        for (std::size_t k = 0; k < edges.size(); ++k) {
          const auto nodes = block.element(e);
          const Index middle = nodes[n_corners(block.type.shape) + static_cast<int>(k)];
          if (on_surface[middle] || stays(mesh.nodes[middle])) continue;
          ++n_following;
          // Offsets of the surface are round-off, of numbers near 1.
          EXPECT_NEAR((u[middle] - (u[nodes[edges[k][0]]] + u[nodes[edges[k][1]]]) / 2).norm(), 0,
                      1e-14);
        }
    }
    EXPECT_GT(n_following, 100);
    if (surface.dimension == 2)
      for (Index node = 0; node < mesh.n_nodes(); ++node)
        if (!on_surface[node] && stays(mesh.nodes[node])) {
          EXPECT_EQ(moved[node], mesh.nodes[node]);
        }
    EXPECT_TRUE(check_mesh(mesh, moved).valid());
    EXPECT_EQ(check_mesh(mesh, moved).n_corners_only > 0, has_pyramids(mesh));
  }
}

TEST(SecondOrder, CornersMoveAsInTheLinearMesh) {
  for (const ElementShape shape : volume_shapes) {
    const Mesh linear = test::cell_box(shape, 4);
    const Mesh mesh = test::second_order(linear, true);
    const auto move = [](const Mesh& m) {
      const Surface top = select_surface(m, {.groups = {"top"}});
      std::vector<Vec3> told;
      for (const Index node : top.nodes)
        told.emplace_back(0, 0, 0.1 * std::sin(5 * m.nodes[node].x() + 7 * m.nodes[node].y()));
      return VolumeMover(m, test::only(top)).move(told).nodes;
    };
    const std::vector<Vec3> a = move(linear), b = move(mesh);
    // Two solves of one system, each to a residual of 1e-12 times a condition below 1e2.
    for (Index node = 0; node < linear.n_nodes(); ++node)
      EXPECT_NEAR((a[node] - b[node]).norm(), 0, 1e-10);
  }
}

// Constants are solutions of eq. 16 and 37, and all weights of eq. 38 add up to 1.
TEST(SecondOrder, ConstantsAreReproduced) {
  for (const bool complete : {false, true})
    for (const ElementShape shape : volume_shapes) {
      const Mesh mesh = test::second_order(test::without_faces(test::cell_box(shape, 4)), complete);
      const Surface boundary = select_surface(mesh);
      const Vec3 shift(0.3, -0.2, 0.1);
      const std::vector<Vec3> moved =
          VolumeMover(mesh, test::only(boundary)).move(constant(boundary, shift)).nodes;
      for (Index node = 0; node < mesh.n_nodes(); ++node)
        EXPECT_NEAR((moved[node] - mesh.nodes[node] - shift).norm(), 0, 1e-10);
    }
}

TEST(SecondOrder, ASphereInABoxFromGmsh) {
  if (!test::has_gmsh()) GTEST_SKIP() << "no gmsh";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.geo",
                    "SetFactory(\"OpenCASCADE\");\nBox(1) = {-1, -1, -1, 2, 2, 2};\n"
                    "Sphere(2) = {0, 0, 0, 0.5};\nBooleanFragments{ Volume{1}; Delete; }{ "
                    "Volume{2}; Delete; }\nMesh.MeshSizeMax = 0.25;\nPhysical Surface(\"ball\") = "
                    "{7};\nPhysical Volume(\"all\") = {2, 3};\n");
  ASSERT_EQ(test::run("cd " + folder.path().string() +
                      " && timeout 60 gmsh -3 -order 2 -o a.msh a.geo > log 2>&1"),
            0);
  const Mesh mesh = read_mesh((folder / "a.msh").string());
  const Surface ball = select_surface(mesh, {.groups = {"ball"}});
  EXPECT_EQ(ball.n_border_edges, 0);
  EXPECT_EQ(ball.n_faces(), 4 * ball.n_elements);
  // All nodes are on the sphere (Gmsh: to 1e-7 or so), so that the normals are exact.
  for (Index i = 0; i < ball.n_points(); ++i)
    EXPECT_NEAR((ball.normals[i] - ball.points[i] / 0.5).norm(), 0, 1e-4);
  std::vector<double> heights;
  for (const Vec3& x : ball.points) heights.push_back(0.02 * std::sin(9 * x.x() + 7 * x.y()));
  const VolumeMover mover(mesh, test::only(ball));
  EXPECT_EQ(mover.wall_nodes().size(), 0U);
  const std::vector<Vec3> moved = mover.move(displace_nodes(test::only(ball), {&heights, 1})).nodes;
  const MeshCheck check = check_mesh(mesh, moved);
  EXPECT_TRUE(check.valid());
  EXPECT_EQ(check.n_corners_only, 0);
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (mesh.nodes[node].lpNorm<Eigen::Infinity>() > 1 - 1e-9) {
      EXPECT_EQ(moved[node], mesh.nodes[node]);
    }
}

// Meshes of finite element programs in third order: what would move says which order it has.
TEST(SecondOrder, RealMeshesOfHigherOrderAreRefusedByOrder) {
  const char* const data = std::getenv("ROUGHMESH_DATA");
  if (data == nullptr) GTEST_SKIP() << "no ROUGHMESH_DATA";
  for (const std::string file : {"nested_cubes.msh", "periodic-torus-sector.msh"}) {
    const Mesh mesh = read_mesh(std::string(data) + "/meshes/" + file);
    int order = 1;
    for (const ElementBlock& block : mesh.blocks) order = std::max(order, block.type.order);
    const std::string message =
        test::message_of([&] { select_surface(mesh, {.groups = {"all"}}); });
    if (order <= 2) {
      EXPECT_EQ(message, "no error") << file;
      continue;
    }
    EXPECT_NE(message.find(fmt::format("of order {}", order)), std::string::npos)
        << file << message;
    EXPECT_NE(message.find("-order 1 or -order 2"), std::string::npos) << file;
  }
}
