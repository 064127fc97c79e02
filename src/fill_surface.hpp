// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces without volumes are filled with tetrahedra, and a box around them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "box_surface.hpp"
#include "fill_volumes.hpp"
#include "nested_surfaces.hpp"
#include "remesh_volume.hpp"

namespace roughmesh::detail {

/// Every surface is filled up to those that it encloses: one entity and one physical group for each
/// of these volumes, `inside`, or `inside_1`, `inside_2`, ... in the order of the surfaces in the
/// file. With a box also what is between it and the outermost surfaces, `outside`, and its own
/// sides, `box`. Faces without a group get the group `surface`. Edges grow with the distance from
/// the surface (docs/math.md, eq. 65).
class SurfaceFiller {
 public:
  /// @param mesh  of faces, without volumes; has to outlive this
  /// @param box   its sides over those of the bounding box of the mesh, around its middle; above 1
  /// @throws InputError  what find_nested_surfaces throws
  SurfaceFiller(const Mesh& mesh, std::optional<double> box, GmshProgram gmsh);
  SurfaceFiller(Mesh&& mesh, std::optional<double> box, GmshProgram gmsh) = delete;

  /// @param positions  of all nodes
  /// @throws CheckError  the surface reaches the box
  /// @throws             what fill_volumes throws
  RemeshedVolume fill(std::span<const Vec3> positions) const;

 private:
  void add_box(double factor);
  void add_components(std::span<const Index> number, FillTask& task) const;
  void add_box_sheet(FillTask& task) const;
  FillTask make_task(std::span<const Vec3> positions) const;
  Mesh with_groups(std::span<const Vec3> positions, const FilledVolumes& filled) const;

  const Mesh& mesh_;
  GmshProgram gmsh_;
  NestedSurfaces nested_;
  std::vector<Index> used_nodes_;  // of triangles, ascending
  std::vector<double> sizes_;      // of edges at each of these, in the input
  std::optional<BoxSurface> box_;
};

}  // namespace roughmesh::detail
