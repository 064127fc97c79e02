// SPDX-License-Identifier: BSD-3-Clause
// Weighted harmonic extension of what nodes of order 2 have beyond straight edges.
#pragma once

#include <span>
#include <vector>

#include "extension_system.hpp"
#include "harmonic.hpp"

namespace roughmesh::detail {

/// An element of a mesh by its place there.
struct ElementOfMesh {
  Index block = 0;
  Index element = 0;

  std::span<const Index> nodes(const Mesh& mesh) const {
    return mesh.blocks[static_cast<std::size_t>(block)].element(element);
  }
  const ElementType& type(const Mesh& mesh) const {
    return mesh.blocks[static_cast<std::size_t>(block)].type;
  }
};

/// Minimizes, for each component of the offset w, which is zero at all corners,
///
///     sum over elements of  1/V * integral |grad w|^2             (docs/math.md, eq. 62)
///
/// with the shape functions of order 2 of each element, on the straight element between its
/// corners in the input.
class QuadraticExtension {
 public:
  /// @param elements  with a quadratic_map; nearly flat ones are left out, and an unknown that has
  ///                  no other stays
  /// @param roles     of nodes that are no corners
  QuadraticExtension(const Mesh& mesh, std::span<const ElementOfMesh> elements,
                     const NodeRoles& roles);

  /// @param given  n_given offsets, finite
  /// @return       n_unknown offsets; the same bits on any number of threads
  /// @throws NumericalError  conjugate gradients did not come near a solution
  std::vector<Vec3> extend(std::span<const Vec3> given) const { return system_.extend(given); }

  const ExtensionSystem::Matrix& stiffness() const { return system_.stiffness(); }

 private:
  ExtensionSystem system_;
};

}  // namespace roughmesh::detail
