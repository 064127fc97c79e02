// SPDX-License-Identifier: BSD-3-Clause
// When two surfaces count as the same.
#pragma once

#include <gtest/gtest.h>

#include "roughmesh/surface.hpp"

namespace roughmesh::test {

/// Everything that must not depend on the numbers and the order in the file.
inline void expect_same_surface(const Surface& a, const Surface& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.areas, b.areas);
  EXPECT_EQ(a.face_offsets, b.face_offsets);
  EXPECT_EQ(a.face_points, b.face_points);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.mesh_size.min, b.mesh_size.min);
  EXPECT_EQ(a.mesh_size.median, b.mesh_size.median);
  EXPECT_EQ(a.mesh_size.max, b.mesh_size.max);
}

}  // namespace roughmesh::test
