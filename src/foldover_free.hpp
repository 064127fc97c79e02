// SPDX-License-Identifier: BSD-3-Clause
// Untangling: positions for which no simplex is inverted, whatever it starts from.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "deforming.hpp"
#include "tied_nodes.hpp"

namespace roughmesh::detail {

/// Bounds the work, so that it also ends where no solution exists.
struct UntangleOptions {
  int most_rounds = 8;
  int most_in_vain = 2;       ///< rounds after which no fewer simplices are inverted
  int most_iterations = 120;  ///< of L-BFGS in a round
};

/// Tetrahedra, triangles of one plane, or triangles of a surface.
struct Simplices {
  std::span<const Vec3> rest;  ///< nodes of the input mesh
  std::span<const Simplex> all;
  std::optional<Vec3> plane_normal = {};  ///< of triangles of one plane
  /// From this node on nodes are new, and the rest shape of a tetrahedron with one is the regular
  /// one with the mean of its edges.
  Index first_new_node = std::numeric_limits<Index>::max();
  NodeTies ties = {};  ///< of free nodes; those that move alike are free together
};

/// Moves the free nodes to the least distortion of the simplices around them, relative to the rest
/// shape (docs/math.md, eq. 50 to 52). A triangle of a surface is inverted where it has turned by
/// 90 degrees or more from its rest shape (eq. 68). Flat rest shapes are left out. The same bits on
/// any number of threads.
/// @param is_free    per node
/// @param positions  per node; those of nodes that are not free, or in no simplex, keep every bit
/// @return           no simplex with a free node is inverted
bool untangle(const Simplices& simplices, const NodeFlags& is_free, std::vector<Vec3>& positions,
              const UntangleOptions& options = {});

}  // namespace roughmesh::detail
