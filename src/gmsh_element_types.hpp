// SPDX-License-Identifier: BSD-3-Clause
// Gmsh's numbers of element types.
#pragma once

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The type with this number in an MSH file, of order 1 to 10; null where the number means none,
/// or something without a fixed number of nodes (polygons, elements cut by level sets).
const ElementType* element_type_from_gmsh(Tag number);

/// The number of a type; 0 where Gmsh has none.
int gmsh_number(const ElementType& type);

}  // namespace roughmesh::detail
