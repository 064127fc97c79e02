// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces inside each other.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Components of the triangles of a mesh, each closed, in the order of the file.
struct NestedSurfaces {
  struct Component {
    std::vector<std::array<Index, 3>> triangles;  ///< nodes of the mesh
    std::vector<Tag> elements;                    ///< their numbers
    Index around = -1;  ///< the innermost component that encloses this one; -1 for none
  };
  std::vector<Component> components;
};

/// @throws InputError  no triangle; other faces, or of order 2; an edge without exactly two
///                     triangles
NestedSurfaces find_nested_surfaces(const Mesh& mesh);

/// How often closed triangles go round a place (docs/math.md, eq. 64): 0 outside, 1 or -1 inside,
/// as they are oriented.
double winding_number(std::span<const std::array<Index, 3>> triangles, std::span<const Vec3> nodes,
                      const Vec3& place);

}  // namespace roughmesh::detail
