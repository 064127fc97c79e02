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

/// @throws InputError  the element is of order 3 or more
inline void require_movable_order(const ElementType& type, Tag element) {
  if (type.order <= 2) return;
  throw InputError(
      fmt::format("element {} is a {}: only elements of order 1 and 2 can move; mesh the geometry "
                  "again with gmsh -order 1 or -order 2",
                  element, name(type)));
}

}  // namespace roughmesh::detail
