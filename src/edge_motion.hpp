// SPDX-License-Identifier: BSD-3-Clause
// Displacements where a rough surface has sharp edges or meets others.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "roughmesh/displace.hpp"

#include "chains.hpp"
#include "joined_surfaces.hpp"
#include "least_displacement.hpp"
#include "sectors.hpp"
#include "smooth_extension.hpp"

namespace roughmesh::detail {

/// What SurfaceMover prepares once. Vertices with several sectors or with constraints are *bound*:
/// they move by eq. 36 of docs/math.md, and what they slide by is spread by eq. 56.
class EdgeMotion {
 public:
  EdgeMotion(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
             const NodeConstraints& constraints, std::span<const Index> moved);

  MovedSurface move(std::span<const std::vector<double>> heights) const;

  /// Of one surface without edges, from the displacements of its points.
  MovedSurface unfolded(std::span<const Vec3> at_points) const;

 private:
  struct Bound {
    Index vertex = 0;
    std::vector<Index> sectors;  ///< those that move
    LeastDisplacement least;
    bool slides = true;  ///< by a share of its height that faces have to be stretched for
  };
  using Images = std::vector<std::vector<Index>>;

  void find_still(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                  std::span<const Index> fixed, std::span<const Index> moved);
  std::vector<std::vector<Vec3>> across(const NodeConstraints& constraints,
                                        std::span<const Index> moved) const;
  void find_bound(const std::vector<std::vector<Vec3>>& across, const Images& images);
  void find_sliding(std::span<const EdgeOptions> options, const Images& images,
                    std::span<const Index> anchored, std::span<const Index> moved);
  void prepare_chains();
  void prepare_faces(std::span<const EdgeOptions> options);
  std::vector<std::array<Index, 3>> faces_to_stretch(std::span<const std::uint8_t> is_inner) const;

  bool is_bound(Index vertex) const { return bound_of_vertex_[vertex] >= 0; }
  /// Has something of its own there, or stays where several meet.
  bool is_on_edge(Index vertex) const {
    return is_bound(vertex) || (is_still_[vertex] != 0 && sectors_.at(vertex).size() > 1);
  }

  Vec3 bound_displacement(const Bound& bound, std::span<const std::vector<double>> heights) const;
  void slide_along_chains(std::vector<Vec3>& u) const;
  void equal_images(std::vector<Vec3>& u) const;
  void stretch_faces(std::vector<Vec3>& u) const;
  std::vector<SlidingNode> directions_to_keep() const;
  MovedSurface unfold(std::vector<Vec3> u) const;

  JoinedSurfaces joined_;
  Sectors sectors_;
  std::vector<std::uint8_t> is_moving_;  ///< per sector: its mask lets it
  std::vector<std::uint8_t> is_still_;   ///< per vertex: none of its sectors moves, or it is fixed
  std::vector<Index> bound_of_vertex_;   ///< or -1
  std::vector<Bound> bound_;
  Images images_;  ///< bound vertices that move alike
  /// Per vertex: where faces would fold it slides, along what it is bound to.
  std::vector<std::uint8_t> can_slide_;
  Chains chains_;
  std::unique_ptr<const SmoothExtension> faces_;
};

}  // namespace roughmesh::detail
