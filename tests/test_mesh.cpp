// SPDX-License-Identifier: BSD-3-Clause
// The tables of element shapes, and the meshes the other tests stand on.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/mesh.hpp"

#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

// Corners of one element of each shape with positive volume, in Gmsh's order.
std::vector<Vec3> reference_corners(ElementShape shape) {
  switch (shape) {
    case ElementShape::tetrahedron:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case ElementShape::hexahedron:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
              {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    case ElementShape::prism:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    case ElementShape::pyramid:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
    default:
      return {};
  }
}

double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6;
}

}  // namespace

// Divergence theorem: with outward faces, the cones from the origin add up to the volume.
TEST(Mesh, LocalFacesPointOutOfTheElement) {
  const std::array<std::pair<ElementShape, double>, 4> volumes = {
      {{ElementShape::tetrahedron, 1.0 / 6},
       {ElementShape::hexahedron, 1.0},
       {ElementShape::prism, 0.5},
       {ElementShape::pyramid, 1.0 / 3}}};
  for (const auto& [shape, volume] : volumes) {
    const std::vector<Vec3> corners = reference_corners(shape);
    ASSERT_EQ(static_cast<int>(corners.size()), n_corners(shape));
    double sum = 0;
    for (const std::vector<int>& face : local_faces(shape))
      for (std::size_t k = 2; k < face.size(); ++k)
        sum +=
            signed_volume(Vec3::Zero(), corners[face[0]], corners[face[k - 1]], corners[face[k]]);
    EXPECT_NEAR(sum, volume, 1e-15) << name({shape, 1, n_corners(shape)});
  }
}

TEST(Mesh, BallInBoxFillsTheBoxWithPositiveTetrahedra) {
  const Mesh mesh = test::ball_in_box(8);
  double sum = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) < 3) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto t = block.element(e);
      const double volume =
          signed_volume(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]);
      EXPECT_GT(volume, 0);
      sum += volume;
    }
  }
  EXPECT_NEAR(sum, 8.0, 1e-12);
  EXPECT_EQ(dimension(mesh), 3);
  EXPECT_EQ(n_elements(mesh, 3), 6 * 8 * 8 * 8);
}
