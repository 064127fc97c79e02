// SPDX-License-Identifier: BSD-3-Clause
// Weighted harmonic extension: given displacements at some nodes, the smoothest ones at others.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "conjugate_gradients.hpp"
#include "extension_system.hpp"

namespace roughmesh::detail {

/// Positions of the corners of a tetrahedron in an array of nodes; of a triangle, whose fourth is
/// -1.
using Simplex = std::array<Index, 4>;

/// So flat that round-off decides on which side it is.
bool is_flat(std::span<const Vec3> nodes, const Simplex& simplex);

/// What is known about the displacement of each node. A node is unknown, given or, if neither
/// number is set, stays where it is.
struct NodeRoles {
  /// Per node: number of its unknown, or -1. Nodes that move alike have one number, given or not.
  std::vector<Index> unknown;
  std::vector<Index> given;  ///< per node: number of its given displacement, or -1
  Index n_unknown = 0;
  Index n_given = 0;
  std::vector<SlidingRow> sliding = {};  ///< unknowns that stay in a plane or on a line
};

/// Minimizes, for each component of the displacement u,
///
///     sum over simplices of  1/V * integral |grad u|^2             (docs/math.md, eq. 16)
///
/// under m . u = 0 at nodes that slide (eq. 58), with u linear on each simplex, so that small ones
/// deform least. Simplices are tetrahedra of volume V, or triangles of area V in one plane.
class HarmonicExtension {
 public:
  /// Nearly flat simplices, whose weight would drown all others, are left out; an unknown that
  /// has no other simplex stays.
  HarmonicExtension(std::span<const Vec3> nodes, std::span<const Simplex> simplices,
                    const NodeRoles& roles);

  /// @param given  n_given displacements, finite
  /// @return       n_unknown displacements; the same bits on any number of threads
  /// @throws NumericalError  conjugate gradients did not come near a solution
  std::vector<Vec3> extend(std::span<const Vec3> given) const { return system_.extend(given); }

  const ExtensionSystem::Matrix& stiffness() const { return system_.stiffness(); }

 private:
  ExtensionSystem system_;
};

}  // namespace roughmesh::detail
