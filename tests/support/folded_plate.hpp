// SPDX-License-Identifier: BSD-3-Clause
// A plate with triangles that moved nodes have folded over, in its plane.
#pragma once

#include <vector>

#include "support/meshes.hpp"

namespace roughmesh::test {

struct FoldedPlate {
  Mesh mesh = plate(6);
  std::vector<Vec3> moved = mesh.nodes;
  std::int64_t n_clockwise = 0;  ///< triangles whose corners run clockwise after the motion
};

inline FoldedPlate folded_plate() {
  FoldedPlate folded;
  std::vector<Vec3>& x = folded.moved;
  for (const std::size_t node : {16U, 24U, 31U}) x[node] += Vec3(0.31, 0.05, 0);
  const ElementBlock& block = folded.mesh.blocks[0];
  for (Index e = 0; e < block.size(); ++e) {
    const auto t = block.element(e);
    folded.n_clockwise += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).z() < 0;
  }
  return folded;
}

}  // namespace roughmesh::test
