// SPDX-License-Identifier: BSD-3-Clause
// Geometry of a selected surface: points, orientation, normals, areas, edges.
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/surface.hpp"

#include "support/cells.hpp"
#include "support/contact.hpp"
#include "support/meshes.hpp"
#include "support/same_surface.hpp"

using namespace roughmesh;

namespace {

constexpr double pi = std::numbers::pi;

double mean_normal_z(const Surface& surface) {
  double sum = 0;
  for (const Vec3& n : surface.normals) sum += n.z();
  return sum / surface.n_points();
}

// Each triangle on three nodes of its own, as in an STL file.
Mesh triangle_soup(const Mesh& mesh) {
  std::vector<Vec3> nodes;
  std::vector<Index> triangles;
  for (const Index node : mesh.blocks[0].nodes) {
    triangles.push_back(static_cast<Index>(nodes.size()));
    nodes.push_back(mesh.nodes[node]);
  }
  return test::surface_mesh(std::move(nodes), std::move(triangles));
}

Mesh moebius_strip(int divisions) {
  std::vector<Vec3> nodes;
  std::vector<Index> faces;
  for (int i = 0; i < divisions; ++i) {
    const double t = 2 * pi * i / divisions;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(t / 2);
      nodes.emplace_back(r * std::cos(t), r * std::sin(t), s * std::sin(t / 2));
    }
  }
  for (int i = 0; i < divisions; ++i) {
    const Index a = 2 * i, b = a + 1;
    Index c = (a + 2) % (2 * divisions), d = (a + 3) % (2 * divisions);
    if (i + 1 == divisions) std::swap(c, d);  // the half turn
    faces.insert(faces.end(), {a, c, d, a, d, b});
  }
  return test::surface_mesh(std::move(nodes), std::move(faces));
}

}  // namespace

// Max's weights reproduce the normal of a sphere through the point and all its neighbours, whatever
// the triangles. Edges of length h carry a round-off of 1e-16 / h, here 1e-15; some six are added.
TEST(Surface, MaxNormalsOfASphereAreExact) {
  Mesh mesh = test::icosphere(3, 2.5);
  Eigen::Affine3d shear = Eigen::Affine3d::Identity();
  shear(0, 1) = 0.4;  // triangles of many shapes, put back on the sphere
  mesh = test::transformed(mesh, shear);
  for (Vec3& x : mesh.nodes) x *= 2.5 / x.norm();
  const Surface surface = select_surface(mesh);
  for (Index i = 0; i < surface.n_points(); ++i)
    EXPECT_NEAR((surface.normals[i] - surface.points[i] / 2.5).norm(), 0, 1e-14);
}

TEST(Surface, NodeAreasAddUpToTheArea) {
  for (const Mesh& mesh : {test::icosphere(2), test::plate(5),
                           test::without_faces(test::cell_box(ElementShape::hexahedron, 4))}) {
    const Surface surface = select_surface(mesh);
    double sum = 0;
    for (const double area : surface.areas) sum += area;
    EXPECT_NEAR(sum, surface.area, 1e-13 * surface.area);  // a few hundred terms of 1e-16
  }
  EXPECT_NEAR(select_surface(test::plate(5, 3.0)).area, 9.0, 1e-13);
  const Surface cube = select_surface(test::without_faces(test::cell_box(ElementShape::prism, 4)));
  EXPECT_NEAR(cube.area, 6.0, 1e-13);
}

// Six triangles meet at an inner node of the plate: 6 * h^2 / 2 / 3; one or two at its corners.
TEST(Surface, NodeAreasOfAPlate) {
  const Surface surface = select_surface(test::plate(4));
  const double square = 1.0 / 16;
  for (Index i = 0; i < surface.n_points(); ++i) {
    const Vec3& x = surface.points[i];
    const bool is_inner = x.x() > 0 && x.x() < 1 && x.y() > 0 && x.y() < 1;
    if (is_inner) {
      EXPECT_NEAR(surface.areas[i], square, 1e-16);
    } else if (x.isZero()) {
      EXPECT_NEAR(surface.areas[i], square / 3, 1e-16);
    }
  }
}

// A warped quadrangle: each splitting of the unit square with one corner lifted by 1 has triangles
// of areas 1/2 and sqrt(3)/2, or sqrt(2)/2 twice.
TEST(Surface, AreaOfAWarpedQuadrangleIsTheMeanOfItsSplittings) {
  const Mesh mesh =
      test::single_element(ElementShape::quadrangle, {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}});
  const Surface surface = select_surface(mesh);
  const double mean = (0.5 + std::sqrt(3.0) / 2 + std::sqrt(2.0)) / 2;
  EXPECT_NEAR(surface.area, mean, 1e-15);
  for (const double area : surface.areas) EXPECT_NEAR(area, mean / 4, 1e-15);
}

TEST(Surface, MeshSizeIsTheMedianOfAllEdges) {
  const Surface surface = select_surface(test::plate(4));  // 40 straight edges, 16 diagonals
  EXPECT_DOUBLE_EQ(surface.mesh_size.min, 0.25);
  EXPECT_DOUBLE_EQ(surface.mesh_size.median, 0.25);
  EXPECT_DOUBLE_EQ(surface.mesh_size.max, 0.25 * std::sqrt(2.0));
}

TEST(Surface, DoesNotDependOnNumbersOrderOrOrientationOfTheFile) {
  for (const Mesh& mesh : {test::icosphere(2), test::ball_in_box(4)}) {
    const Surface surface = select_surface(mesh, {.groups = {"surface"}});
    Mesh other = test::shuffled(mesh, 1);
    test::turn_some_faces(other, 2);
    test::expect_same_surface(surface, select_surface(other, {.groups = {"surface"}}));
  }
  const Mesh box = test::without_faces(test::cell_box(ElementShape::hexahedron, 4));
  test::expect_same_surface(select_surface(box), select_surface(test::shuffled(box, 3)));
}

TEST(Surface, EveryNodeKnowsItsPoint) {
  const Mesh mesh = test::shuffled(test::ball_in_box(4), 5);
  const Surface surface = select_surface(mesh, {.groups = {"surface"}});
  ASSERT_EQ(surface.nodes.size(), surface.point_of_node.size());
  EXPECT_TRUE(std::is_sorted(surface.nodes.begin(), surface.nodes.end()));
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    EXPECT_EQ(mesh.nodes[surface.nodes[i]], surface.points[surface.point_of_node[i]]);
}

TEST(Surface, FaceTagsStayWithTheirFaces) {
  const Mesh mesh = test::shuffled(test::icosphere(1), 7);
  const Surface surface = select_surface(mesh);
  const ElementBlock& block = mesh.blocks[0];
  for (Index f = 0; f < surface.n_faces(); ++f) {
    const auto at = std::find(block.tags.begin(), block.tags.end(), surface.face_tags[f]);
    const auto element = block.element(static_cast<Index>(at - block.tags.begin()));
    Vec3 in_file = Vec3::Zero(), here = Vec3::Zero();
    for (const Index node : element) in_file += mesh.nodes[node];
    for (const Index point : surface.face(f)) here += surface.points[point];
    EXPECT_NEAR((in_file - here).norm(), 0, 1e-15);
  }
}

// Powers of two change exponents only.
TEST(Surface, ScalingBy1024IsExact) {
  const Mesh mesh = test::icosphere(2);
  const Eigen::Affine3d scale(Eigen::Scaling(1024.0));
  const Surface a = select_surface(mesh), b = select_surface(test::transformed(mesh, scale));
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.face_points, b.face_points);
  for (Index i = 0; i < a.n_points(); ++i) EXPECT_EQ(b.areas[i], 1024.0 * 1024.0 * a.areas[i]);
}

// Translation by 8 rounds coordinates to 1e-15, edges of 0.3 to 3e-15 of their length.
TEST(Surface, MovesWithTheBody) {
  const Mesh mesh = test::icosphere(2);
  const Eigen::AngleAxisd rotation(0.7, Vec3(1, 2, 3).normalized());
  const Eigen::Affine3d map = Eigen::Translation3d(8, -3, 5) * rotation;
  const Surface a = select_surface(mesh), b = select_surface(test::transformed(mesh, map));
  ASSERT_EQ(a.nodes, b.nodes);
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const Index p = a.point_of_node[i], q = b.point_of_node[i];
    EXPECT_NEAR((rotation * a.normals[p] - b.normals[q]).norm(), 0, 1e-13);
    EXPECT_NEAR(a.areas[p], b.areas[q], 1e-13 * a.areas[p]);
  }
  EXPECT_NEAR(enclosed_volume(a, a.points), enclosed_volume(b, b.points), 1e-13);
}

TEST(Surface, ClosedPiecesLookOutward) {
  Mesh mesh = test::icosphere(1);
  for (Index e = 0; e < mesh.blocks[0].size(); ++e) test::turn_element(mesh.blocks[0], e);
  const Surface surface = select_surface(mesh);
  EXPECT_GT(enclosed_volume(surface, surface.points), 0);
  for (Index i = 0; i < surface.n_points(); ++i)
    EXPECT_GT(surface.normals[i].dot(surface.points[i]), 0.9);
  const Surface flipped = select_surface(mesh, {.flip = true});
  EXPECT_LT(enclosed_volume(flipped, flipped.points), 0);
  for (Index i = 0; i < surface.n_points(); ++i) EXPECT_EQ(flipped.normals[i], -surface.normals[i]);
}

TEST(Surface, AFreePieceKeepsTheOrientationOfMostOfItsArea) {
  const Mesh mesh = test::plate(4);
  for (Index e = 0; e < mesh.blocks[0].size(); ++e) {
    Mesh other = mesh;
    test::turn_element(other.blocks[0], e);
    test::expect_same_surface(select_surface(mesh), select_surface(other));
  }
  EXPECT_EQ(mean_normal_z(select_surface(mesh, {.flip = true})), -1);
  // One large square outweighs three triangles.
  Mesh uneven = test::surface_mesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1.1, 0, 0}, {1.1, 1, 0}, {1.1, 0.5, 0}},
      {1, 6, 4, 1, 2, 6, 2, 5, 6});
  uneven.blocks.push_back(test::make_block(test::quadrangle_type, 1, {1}, {0, 1, 2, 3}, 11));
  EXPECT_EQ(mean_normal_z(select_surface(uneven)), 1);
}

TEST(Surface, OfTwoHalvesTheFirstFaceInTheFileDecides) {
  Mesh mesh = test::plate(3);  // sides of 1/3, so that areas are rounded
  for (Index e = 0; e < 9; ++e) test::turn_element(mesh.blocks[0], 2 * e);
  EXPECT_EQ(mean_normal_z(select_surface(mesh)), -1);
  for (Index e = 0; e < 18; ++e) test::turn_element(mesh.blocks[0], e);
  EXPECT_EQ(mean_normal_z(select_surface(mesh)), 1);
}

TEST(Surface, AnOpenPieceLooksOutOfItsVolume) {
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid}) {
    const Mesh mesh = test::cell_box(shape, 4);
    const Surface top = select_surface(mesh, {.groups = {"top"}});
    EXPECT_EQ(mean_normal_z(top), 1);
    Mesh other = mesh;
    for (Index e = 0; e < other.blocks[1].size(); ++e) {  // more and more, in the end all of them
      test::turn_element(other.blocks[1], e);
      test::expect_same_surface(top, select_surface(other, {.groups = {"top"}}));
    }
  }
}

TEST(Surface, BetweenTwoVolumesItLooksOutOfTheLowerNumber) {
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron,
                                   ElementShape::prism, ElementShape::pyramid}) {
    Mesh mesh = test::cell_box(shape, 4);
    for (const bool turn_first : {false, true}) {
      if (turn_first) test::turn_element(mesh.blocks[0], 0);
      mesh.blocks[2].entity = 1;
      mesh.blocks[3].entity = 2;
      EXPECT_EQ(mean_normal_z(select_surface(mesh, {.groups = {"middle"}})), 1);
      mesh.blocks[2].entity = 3;
      EXPECT_EQ(mean_normal_z(select_surface(mesh, {.groups = {"middle"}})), -1);
    }
  }
}

TEST(Surface, AOneSidedSurfaceIsRefused) {
  try {
    select_surface(moebius_strip(12));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("one-sided"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("near element"), std::string::npos);
  }
}

// Three plates that meet in one line like a T: no two of them belong together.
TEST(Surface, AJunctionOfThreePlatesIsAccepted) {
  const int n = 3;
  std::vector<Vec3> nodes;
  std::vector<Index> faces;
  for (const double angle : {0.0, pi / 2, pi}) {
    const Mesh plate = test::plate(n);
    const auto first = static_cast<Index>(nodes.size());
    for (const Vec3& x : plate.nodes) nodes.push_back(Eigen::AngleAxisd(angle, Vec3::UnitY()) * x);
    for (const Index node : plate.blocks[0].nodes) faces.push_back(first + node);
  }
  const Surface surface = select_surface(test::surface_mesh(nodes, faces));
  EXPECT_EQ(surface.n_nonmanifold_edges, n);
  EXPECT_EQ(surface.n_border_edges, 3 * 3 * n);
  EXPECT_EQ(surface.n_components, 1);
  EXPECT_EQ(surface.n_points(), 3 * (n + 1) * n + n + 1);
}

// 100,000 triangles on one edge, like the pages of a book: time that grows with their square would
// be noticed.
TEST(Surface, AFanOfManyFacesOnOneEdge) {
  const int n = 100'000;
  std::vector<Vec3> nodes = {{0, 0, 0}, {0, 0, 1}};
  std::vector<Index> faces;
  for (int i = 0; i < n; ++i) {
    const double angle = i * pi / 2 / n;
    nodes.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    faces.insert(faces.end(), {0, 1, i + 2});
  }
  const Surface surface = select_surface(test::surface_mesh(std::move(nodes), std::move(faces)));
  EXPECT_EQ(surface.n_nonmanifold_edges, 1);
  EXPECT_EQ(surface.n_border_edges, 2 * n);
  EXPECT_EQ(surface.n_components, 1);
  EXPECT_NEAR(surface.area, n / 2, 1e-6);  // each sum of n roundings of 1e-11 at most
}

// Two cubes that share one edge: four faces meet there, and yet each cube is closed.
TEST(Surface, ClosedBodiesThatTouchInAnEdgeLookOutwardEach) {
  Mesh mesh =
      test::single_element(ElementShape::hexahedron, test::ideal_corners(ElementShape::hexahedron));
  for (const Vec3& x : test::ideal_corners(ElementShape::hexahedron))
    mesh.nodes.push_back(x + Vec3(1, 1, 0));
  mesh.blocks[0] = test::make_block(test::first_order(ElementShape::hexahedron), 1, {},
                                    {0, 1, 2, 3, 4, 5, 6, 7, 2, 9, 10, 11, 6, 13, 14, 15}, 1);
  test::number_nodes(mesh);
  const Surface surface = select_surface(mesh);
  EXPECT_EQ(surface.n_nonmanifold_edges, 1);
  EXPECT_EQ(surface.n_components, 1);
  EXPECT_NEAR(enclosed_volume(surface, surface.points), 2, 1e-14);
}

TEST(Surface, TheWallOfACavityIsAPieceOfItsOwn) {
  Mesh mesh = test::without_faces(test::ball_in_box(4));
  mesh.blocks.erase(mesh.blocks.begin());  // the ball
  const Surface surface = select_surface(mesh);
  EXPECT_EQ(surface.n_components, 2);
  EXPECT_EQ(surface.n_border_edges, 0);
  for (Index i = 0; i < surface.n_points(); ++i)
    EXPECT_GT(surface.normals[i].dot(surface.points[i]), 0);
}

TEST(Surface, NodesAtEqualPositionsAreOnePoint) {
  const Mesh mesh = test::icosphere(2);
  const Surface whole = select_surface(mesh), soup = select_surface(triangle_soup(mesh));
  test::expect_same_surface(whole, soup);
  EXPECT_EQ(soup.nodes.size(), 3 * mesh.blocks[0].tags.size());
  EXPECT_EQ(soup.n_border_edges, 0);
  EXPECT_EQ(soup.n_components, 1);
}

// Two bodies in contact in the plane z = 1/2, each with 25 nodes of its own there.
TEST(Surface, OneSideOfAContactHasItsOwnNodesOnly) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  const Index n = mesh.n_nodes();
  test::detach(mesh, 3, 0);
  const Surface lower = select_surface(mesh, {.groups = {"middle"}});
  EXPECT_EQ(lower.n_points(), 25);
  EXPECT_EQ(lower.n_coincident_nodes, 25);
  ASSERT_EQ(lower.nodes.size(), 25U);
  EXPECT_LT(lower.nodes.back(), n);
  EXPECT_EQ(mean_normal_z(lower), 1);

  const Surface upper = select_surface(mesh, {.groups = {"far side"}});
  EXPECT_EQ(upper.points, lower.points);
  EXPECT_EQ(upper.n_coincident_nodes, 25);
  EXPECT_GE(upper.nodes.front(), n);
  EXPECT_EQ(mean_normal_z(upper), -1);
}

TEST(Surface, BothSidesOfACrackAreOnePointEach) {
  Mesh mesh = test::cell_box(ElementShape::tetrahedron, 4);
  test::detach(mesh, 3, 0);
  const Surface surface = select_surface(mesh, {.groups = {"middle", "far side"}});
  EXPECT_EQ(surface.n_points(), 25);
  EXPECT_EQ(surface.nodes.size(), 50U);
  EXPECT_EQ(surface.n_coincident_nodes, 0);
  EXPECT_EQ(surface.n_duplicate_faces, 2 * 16);
  EXPECT_EQ(mean_normal_z(surface), 1);
}

TEST(Surface, EdgesOfACubeAreSharp) {
  const int n = 4;
  for (const ElementShape shape : {ElementShape::tetrahedron, ElementShape::hexahedron}) {
    const Mesh cube = test::without_faces(test::cell_box(shape, n));
    EXPECT_EQ(select_surface(cube).n_sharp_edges, 12 * n);
    EXPECT_EQ(select_surface(cube, {.sharp_angle = 91 * pi / 180}).n_sharp_edges, 0);
  }
  EXPECT_EQ(select_surface(test::icosphere(2)).n_sharp_edges, 0);
  EXPECT_THROW(select_surface(test::plate(1), {.sharp_angle = -1}), InputError);
  EXPECT_THROW(select_surface(test::plate(1), {.sharp_angle = std::nan("")}), InputError);
}

// By symmetry the normal is that of the side, the sum of two or the sum of three.
TEST(Surface, NormalsOfACubeOfQuadrangles) {
  const Surface cube =
      select_surface(test::without_faces(test::cell_box(ElementShape::hexahedron, 4)));
  for (Index i = 0; i < cube.n_points(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      if (cube.points[i][axis] == 0) sum[axis] = -1;
      if (cube.points[i][axis] == 1) sum[axis] = 1;
    }
    EXPECT_NEAR((cube.normals[i] - sum.normalized()).norm(), 0, 1e-15);
  }
}

TEST(Surface, CollapsedAndDoubleFacesAreTakenOut) {
  Mesh mesh = test::plate(2);
  auto& block = mesh.blocks[0];
  block.nodes.insert(block.nodes.end(), {0, 0, 1, /* and again */ 1, 4, 0});
  block.tags.insert(block.tags.end(), {101, 102});
  // A quadrangle with two equal corners is a triangle; one folded onto itself has no area.
  mesh.nodes.emplace_back(2, 0, 0);
  mesh.blocks.push_back(
      test::make_block(test::quadrangle_type, 1, {1}, {2, 9, 5, 5, 2, 4, 2, 5}, 201));
  test::number_nodes(mesh);
  const Surface surface = select_surface(mesh);
  EXPECT_EQ(surface.n_faces(), 8 + 1);
  EXPECT_EQ(surface.n_duplicate_faces, 1);
  EXPECT_NEAR(surface.area, 1.0 + 0.25, 1e-15);
  EXPECT_EQ(std::count(surface.face_tags.begin(), surface.face_tags.end(), 101), 0);
}

// A node whose flat triangles all stand on one line has no direction of its own.
TEST(Surface, APointWithoutNormalIsRefused) {
  const Mesh flat =
      test::surface_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
                         {0, 1, 2, 3, 4, 0, 4, 5, 2});
  try {
    select_surface(flat);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("node 2 at (1, 0, 0)"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(select_surface(test::surface_mesh({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {0, 1, 2})),
               InputError);
  const double nan = std::nan("");
  EXPECT_THROW(select_surface(test::surface_mesh({{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2})),
               InputError);
}

TEST(Surface, EnclosedVolumeOfASphere) {
  const Surface surface = select_surface(test::icosphere(3));
  const double volume = enclosed_volume(surface, surface.points);
  EXPECT_LT(volume, 4 * pi / 3);
  EXPECT_NEAR(volume, 4 * pi / 3, 0.02 * 4 * pi / 3);  // h^2 of an inscribed polyhedron, h = 0.15
  std::vector<Vec3> far(surface.points);
  for (Vec3& x : far) x += Vec3(100, 200, 300);
  EXPECT_NEAR(enclosed_volume(surface, far), volume, 1e-12);
  EXPECT_THROW(enclosed_volume(surface, {}), InputError);
  EXPECT_THROW(moved_points(surface, {}), InputError);
}

TEST(Surface, AreaVectorIsTheRightHandNormal) {
  const std::vector<Vec3> square = test::ideal_corners(ElementShape::quadrangle);
  EXPECT_EQ(area_vector(square), Vec3(0, 0, 1));
  EXPECT_EQ(area_vector(std::span(square).first(3)), Vec3(0, 0, 0.5));
}
