// SPDX-License-Identifier: BSD-3-Clause
// What is behind rough surfaces follows them: by moving, or on new elements.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/check.hpp"
#include "roughmesh/move_volume.hpp"
#include "roughmesh/pipeline.hpp"
#include "roughmesh/report.hpp"
#include "roughmesh/walls.hpp"

#include "remesher.hpp"
#include "rough_surface.hpp"
#include "stage_timer.hpp"

namespace roughmesh::detail {

/// The interior of one realization after the other, each checked before it is handed on.
class VolumeStage {
 public:
  /// @param mesh, surfaces, walls, report, timer  outlive it
  /// @throws InputError  a mesh that the chosen way cannot follow
  VolumeStage(const Mesh& mesh, const RoughSurfaces& surfaces, const Walls& walls, Report& report,
              StageTimer& timer);

  struct Result {
    VolumeMethod method = VolumeMethod::none;
    std::vector<Vec3> nodes;  ///< of the input, where those that are still in use went
  };

  /// Fills in mesh, displacements and check of `rough`, the same from call to call: what did not
  /// change since the last one is left there.
  /// @param displacements  of the nodes of the surfaces
  /// @param surface        n_nodes positions: the surfaces where they went, all else where it was
  /// @param remedy         for the message
  /// @throws CheckError    the mesh is not valid, and the user does not allow it
  Result follow(std::span<const Vec3> displacements, const std::vector<Vec3>& surface,
                const std::string& remedy, RoughMesh& rough);

  /// Values at nodes of the input as values at those of the last mesh, `zero` at new ones.
  template <class Value>
  std::vector<Value> on_nodes_of(const Mesh& rough, std::vector<Value> values,
                                 const Value& zero) const {
    if (old_nodes_) {
      for (std::size_t i = 0; i < old_nodes_->size(); ++i) values[i] = values[(*old_nodes_)[i]];
      values.resize(old_nodes_->size());
    }
    values.resize(rough.nodes.size(), zero);
    return values;
  }

 private:
  std::unique_ptr<const VolumeMover> make_mover(const Walls& walls) const;
  std::unique_ptr<const Remesher> make_remesher() const;

  Result move(std::span<const Vec3> displacements, const std::vector<Vec3>& surface,
              std::string remedy, RoughMesh& rough);
  Result remesh(const std::vector<Vec3>& surface, const std::string& remedy, RoughMesh& rough);
  bool remesh_at_last(const std::vector<Vec3>& nodes, std::string& remedy, RoughMesh& rough);
  void take_moved(const MovedVolume& moved, RoughMesh& rough);
  void take_remeshed(const Remesher& remesher, const std::vector<Vec3>& nodes, RoughMesh& rough);
  void report_moved(const MovedVolume& moved, const RoughMesh& rough) const;
  void report_remeshed(const RoughMesh& rough) const;

  const Mesh& mesh_;
  const RoughSurfaces& surfaces_;
  const Walls& walls_;
  Report& report_;
  StageTimer& timer_;
  std::unique_ptr<const VolumeMover> mover_;  // where nodes move
  std::unique_ptr<const Remesher> remesher_;  // where all volumes are meshed anew
  Enclosure enclosure_;
  bool has_own_elements_ = true;                 // the last mesh is not, or not yet, on the input's
  std::optional<std::vector<Index>> old_nodes_;  // RemeshedVolume::old_nodes, if it is such
};

}  // namespace roughmesh::detail
