// SPDX-License-Identifier: BSD-3-Clause
// Walls: faces beside rough surfaces that keep their shape while their nodes slide along them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/displace.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

struct WallOptions {
  bool can_slide = true;  ///< false: every node of a wall stays
  /// n_nodes flags: nodes of rough surfaces that move; empty: all of them do. Walls slide only
  /// where they meet one that does.
  std::vector<std::uint8_t> moving = {};
  /// Nodes of sliding walls that differ by a period along these axes move alike, as linked ones do;
  /// 0: not periodic along the axis.
  std::optional<Vec3> period = {};
};

/// What nodes on walls can do. A wall is a face that no rough surface has: an element of their
/// dimension, or a side of exactly one element of the dimension above. Walls that are connected and
/// in one plane (docs/math.md, eq. 58) are one; it slides if a node of a rough surface on it moves,
/// and crosses it at 19.5 degrees or more.
struct Walls {
  std::vector<std::uint8_t> is_wall;  ///< n_nodes flags: on a wall
  std::vector<std::uint8_t> stays;    ///< n_nodes flags: cannot move; not for rough nodes
  /// Nodes of sliding walls, ascending, those of rough surfaces included: one entry for each plane,
  /// their normals orthonormal. Nodes where these leave nothing are among those that stay.
  std::vector<SlidingNode> sliding;
  /// Per node the first of those that move alike, because links of the mesh translate one to the
  /// other, or the period does; itself for any other node. Empty: every node for itself.
  std::vector<Index> images;
  /// Nodes of rough surfaces that move although they lie on a wall that stays, ascending.
  std::vector<Index> torn;
};

/// Elements between the partitions of a mesh are no walls, and links other than translations hold
/// their nodes.
/// @param surfaces  one or more of this mesh, of one dimension, without a common face
/// @throws InputError  a face is in two surfaces; no surface
Walls find_walls(const Mesh& mesh, std::span<const Surface> surfaces,
                 const WallOptions& options = {});

/// Of the walls, what concerns nodes of the surfaces.
std::vector<SlidingNode> sliding_on_surfaces(const Walls& walls, std::span<const Surface> surfaces);

}  // namespace roughmesh
