// SPDX-License-Identifier: BSD-3-Clause
// Normals and tangents at nodes that a file states: what they become when nodes move.
#pragma once

#include <cstdint>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "mesh_source.hpp"

namespace roughmesh::detail {

struct MovedVector {
  std::uint64_t offset = 0;
  Vec3 value;
};

/// Values of the vectors of MeshSource::vectors around which a face has changed, in the order of
/// the file. A normal becomes the unit normal of the faces at its node by Max's weights
/// (docs/math.md, eq. 2), on the side on which it was; a tangent, or a normal of one face at the
/// node, is turned by the least rotation that takes that unit normal from before to after. Vectors
/// at nodes without faces, or where the faces cancel, stay.
/// @throws InputError  a vector of the file serves several nodes that now need different ones
std::vector<MovedVector> moved_vectors(const Mesh& mesh);

}  // namespace roughmesh::detail
