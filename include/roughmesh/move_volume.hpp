// SPDX-License-Identifier: BSD-3-Clause
// Displacement of a surface -> positions of all nodes of the mesh.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/surface.hpp"

namespace roughmesh {

enum class VolumeMethod {
  none,     ///< only the nodes of the surface move
  harmonic  ///< harmonic extension with weight 1/V
};

std::string_view name(VolumeMethod method);

/// Prepared once for a mesh and the surface that moves; the linear system is assembled once.
///
/// The interior follows by the harmonic extension of the displacement, each component solved with
/// the stiffness of linear tetrahedra weighted by 1 / volume (docs/math.md, eq. 16), so that small
/// elements near the surface deform least. Nodes of the domain's boundary and of every unselected
/// surface element stay where they are, as do nodes without volume elements. A mesh without volume
/// elements moves its surface only.
class VolumeMover {
 public:
  /// @param method  of a mesh with volume elements
  /// @throws InputError  an element of order above 1 has a node that would move
  VolumeMover(const Mesh& mesh, const Surface& surface,
              VolumeMethod method = VolumeMethod::harmonic);
  ~VolumeMover();
  VolumeMover(VolumeMover&&) noexcept;
  VolumeMover& operator=(VolumeMover&&) noexcept;

  VolumeMethod method() const;

  /// Surface nodes that also lie on unselected faces, which stay: the rough surface meets a wall
  /// there.
  Index n_wall_nodes() const;

  /// @param displacements  one vector per point of the surface
  /// @return               positions of all nodes of the mesh
  /// @throws NumericalError  conjugate gradients did not converge
  std::vector<Vec3> move(std::span<const Vec3> displacements) const;

  struct Plan;  ///< the assembled system; defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

}  // namespace roughmesh
