// SPDX-License-Identifier: BSD-3-Clause
// Fills the space between triangles with tetrahedra, through the gmsh program (HXT). The triangles
// stay as they are, bit for bit.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

#include "size_lattice.hpp"

namespace roughmesh::detail {

/// The program, as --gmsh and --timeout name it.
struct GmshProgram {
  std::string path = "gmsh";
  double timeout = 600;  ///< seconds of wall-clock time, > 0

  bool exists() const;  ///< a file that can be run is at the path, or in PATH where it is a name
};

/// A connected set of triangles with the same volumes on its two sides.
struct Sheet {
  std::vector<std::array<Index, 3>> triangles;  ///< positions in FillTask::nodes
  std::vector<Tag> elements;  ///< for messages: of each triangle, the number of the element
};

/// A volume by the sheets (positions in FillTask::sheets) around it, and those inside it that
/// elements must not cross.
struct VolumeToFill {
  std::vector<Index> boundary;
  std::vector<Index> inside = {};
};

struct FillTask {
  std::vector<Vec3> nodes;  ///< each is a corner of a triangle
  std::vector<Sheet> sheets;
  std::vector<VolumeToFill> volumes;
  SizeLattice sizes;  ///< to aim at
};

using Tetrahedron = std::array<Index, 4>;

struct FilledVolumes {
  std::vector<Vec3> new_nodes;  ///< their numbers follow those of FillTask::nodes
  /// Of each volume, with positive volumes. What their faces leave open is exactly its boundary.
  std::vector<std::vector<Tetrahedron>> tetrahedra;
};

/// Nothing reaches gmsh that it could crash on. Equal input gives equal output, bit for bit, where
/// one gmsh runs on one machine (docs/geometry.md, "Equal meshes").
///
/// @throws InputError      a coordinate that is not finite, a node without its own place, a
///                         triangle listed twice, an open boundary; no gmsh; its time is over
/// @throws CheckError      triangles that intersect
/// @throws NumericalError  gmsh failed or crashed, or what it made does not fit the triangles
FilledVolumes fill_volumes(const FillTask& task, const GmshProgram& gmsh);

}  // namespace roughmesh::detail
