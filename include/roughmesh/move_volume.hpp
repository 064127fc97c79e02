// SPDX-License-Identifier: BSD-3-Clause
// Displacement of surfaces -> positions of all nodes of the mesh.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "roughmesh/surface.hpp"
#include "roughmesh/walls.hpp"

namespace roughmesh {

enum class VolumeMethod {
  none,           ///< only the nodes of the surface move
  harmonic,       ///< harmonic extension with weight 1/V (1/area of the faces of a planar mesh)
  foldover_free,  ///< where that inverts or spoils elements: the foldover-free map around these
  split,          ///< where elements have no node to move: edges split there, then the map again
  remesh          ///< volumes beside the surfaces meshed anew; by the pipeline, not by VolumeMover
};

/// "none", "harmonic", "foldover-free", "split", "remesh"
std::string_view name(VolumeMethod method);

/// Where the nodes of a mesh end up.
struct MovedVolume {
  std::vector<Vec3> nodes;                   ///< positions of all nodes of the mesh
  VolumeMethod method = VolumeMethod::none;  ///< the one that gave them
  /// By `split` only: the mesh that was given with more elements, on its nodes and, after them, new
  /// ones; `nodes` are positions of its nodes.
  std::shared_ptr<const Mesh> split = nullptr;
};

/// Prepared once for a mesh and the surfaces that move; the linear system is assembled once.
///
/// Elements of the dimension above that of the surfaces follow: volumes behind faces, the faces of
/// a planar mesh beside lines. Their inner corners move by the harmonic extension of the
/// displacement, each component solved with the stiffness of linear simplices weighted by 1 /
/// volume (docs/math.md, eq. 16), so that small elements near the surface deform least. Where
/// that inverts elements or leaves them poor, nodes around are moved by the foldover-free map (eq.
/// 50 to 52); where an inverted element has no node that may move, edges are split. Other inner
/// nodes of elements of order 2 move as on straight edges and by what the surface has beyond that,
/// spread over the elements near it (eq. 62), but not into walls; curved elements that are inverted
/// then are mended (eq. 63). Nodes of walls slide in their planes or stay, as find_walls says,
/// nodes that move alike do so, and what walls that stay separate from the surfaces stays. A mesh
/// without such elements moves its surfaces only.
class VolumeMover {
 public:
  /// @param mesh      has to outlive the mover
  /// @param surfaces  one or more of this mesh, of one dimension, without a common face
  /// @param last      the last method to try on a mesh with elements that can follow
  /// @throws InputError  no surface, surfaces of two dimensions, a face in two of them; an element
  ///                     of order above 2 has a node that would move
  VolumeMover(const Mesh& mesh, std::span<const Surface> surfaces,
              VolumeMethod last = VolumeMethod::split);
  /// @param walls  of these surfaces; without, all walls stay
  VolumeMover(const Mesh& mesh, std::span<const Surface> surfaces, const Walls& walls,
              VolumeMethod last = VolumeMethod::split);
  VolumeMover(Mesh&& mesh, std::span<const Surface> surfaces,
              VolumeMethod last = VolumeMethod::split) = delete;
  VolumeMover(Mesh&& mesh, std::span<const Surface> surfaces, const Walls& walls,
              VolumeMethod last = VolumeMethod::split) = delete;
  ~VolumeMover();
  VolumeMover(VolumeMover&&) noexcept;
  VolumeMover& operator=(VolumeMover&&) noexcept;

  /// Whether there are elements that can follow.
  bool moves_interior() const;

  /// Nodes of the surfaces that also lie on a wall, ascending.
  const std::vector<Index>& wall_nodes() const;

  /// @param displacements  one vector per node of moved_nodes(surfaces), in its order
  /// @throws NumericalError  conjugate gradients did not come near a solution
  MovedVolume move(std::span<const Vec3> displacements) const;

  struct Plan;  ///< the assembled system; defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

}  // namespace roughmesh
