// SPDX-License-Identifier: BSD-3-Clause
// Nodes of elements of order 2 that are no corners, once the corners are where they belong.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "curved_repair.hpp"
#include "deforming.hpp"
#include "p2_harmonic.hpp"
#include "second_order.hpp"

namespace roughmesh::detail {

/// What is known of the nodes of a mesh.
struct SettledNodes {
  NodeFlags is_settled;  ///< on a surface that moves, or on a wall: told where to be
  NodeFlags is_moved;    ///< on a surface that moves
  /// Not settled, but without an offset, as in walls within which they slide; empty: none.
  NodeFlags keeps_straight = {};
};

/// Near the surfaces, within `layers` elements, nodes on edges, in faces and inside move by what a
/// straight edge would and the harmonic extension of what settled nodes have beyond that
/// (docs/math.md, eq. 62). Beyond, and in pyramids, they follow their neighbours (eq. 38). Curved
/// elements that are inverted then, or nearly so, are mended (eq. 63).
class CurvedElements {
 public:
  /// @param mesh            has to outlive this
  /// @param cell_dimension  of the elements that deform
  /// @param can_repair      they are volumes or in one plane
  CurvedElements(const Mesh& mesh, int cell_dimension, const SettledNodes& known, bool can_repair);

  /// Fills in the positions of all nodes of the mesh that are neither corners nor settled, given
  /// those of the others. What stands behind them stays.
  void place(std::span<Vec3> positions) const;

  /// Beyond, offsets of one node in 10^4 are left: each layer keeps about a quarter.
  static constexpr int layers = 6;

 private:
  const Mesh& mesh_;
  Followers straight_;   // all nodes that are no corners, by these
  Followers following_;  // all that have no unknown
  std::vector<Index> unknown_nodes_;
  std::vector<Index> given_nodes_;
  std::unique_ptr<const QuadraticExtension> extension_;
  std::optional<CurvedRepair> repair_;
};

}  // namespace roughmesh::detail
