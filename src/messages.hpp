// SPDX-License-Identifier: BSD-3-Clause
// Pieces of messages that several stages share.
#pragma once

#include <string>

#include <fmt/format.h>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

inline std::string place(const Vec3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z());
}

/// @throws InputError  the element has nodes beside its corners
inline void require_first_order(const ElementType& type, Tag element) {
  if (type.order == 1) return;
  throw InputError(
      fmt::format("element {} is a {}: elements of higher order cannot move yet; make the mesh "
                  "linear by meshing its geometry again with gmsh -order 1",
                  element, name(type)));
}

}  // namespace roughmesh::detail
