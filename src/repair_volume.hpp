// SPDX-License-Identifier: BSD-3-Clause
// Stages that mend what the harmonic extension leaves inverted or badly shaped.
#pragma once

#include <optional>
#include <vector>

#include "roughmesh/check.hpp"
#include "roughmesh/move_volume.hpp"

#include "deforming.hpp"
#include "tied_nodes.hpp"

namespace roughmesh::detail {

/// The stages after the harmonic extension, cheapest first; check_corners decides after each.
class VolumeRepair {
 public:
  /// @param mesh      the input, of volumes or planar; has to outlive this
  /// @param is_free   per node: it may be moved
  /// @param n_splits  how often edges may be split
  /// @param ties      of free nodes; all that move alike are free
  VolumeRepair(const Mesh& mesh, NodeFlags is_free, int n_splits, NodeTies ties = {});

  /// @param positions  of the harmonic extension
  MovedVolume mend(std::vector<Vec3> positions) const;

 private:
  VolumeRepair(const Mesh& mesh, NodeFlags is_free, int n_splits, Index first_new_node,
               NodeTies ties);

  bool needs_nothing(const MeshCheck& check) const;
  MeshCheck untangle_near_poor(std::vector<Vec3>& positions) const;
  NodeFlags free_near_poor(const std::vector<Vec3>& positions, int layers) const;
  std::optional<MovedVolume> split_around(const NodeFlags& marked,
                                          const std::vector<Vec3>& positions) const;
  std::optional<MovedVolume> split_trapped_elements(const std::vector<Vec3>& positions) const;
  std::optional<MovedVolume> split_inverted_elements(const std::vector<Vec3>& positions) const;

  const Mesh& mesh_;
  std::vector<Simplex> simplices_;
  NodeFlags is_free_;
  NodeTies ties_;
  int n_splits_ = 0;
  Index first_new_node_ = 0;  // that no input mesh had
  std::optional<Vec3> plane_normal_;
};

}  // namespace roughmesh::detail
