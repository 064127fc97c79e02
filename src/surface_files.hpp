// SPDX-License-Identifier: BSD-3-Clause
// What the formats of bare surfaces share: checks of faces, and which part of a mesh goes into
// such a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "scanner.hpp"

namespace roughmesh::detail {

/// @throws FormatError  neither 3 nor 4
void check_face_size(const Scanner& scanner, Tag n_corners);

/// A node number that counts from 0. @throws FormatError  no such node
Index checked_node(const Scanner& scanner, Tag number, Index n_nodes);

/// The part of a mesh that a file of elements of dimension `least_dimension` to 2 holds. Nodes that
/// only other elements use are left out.
struct SurfacePart {
  SurfacePart(const Mesh& mesh, int least_dimension);

  std::vector<Index> nodes;    ///< positions in Mesh::nodes, ascending
  std::vector<Index> numbers;  ///< for each node of the mesh its place in `nodes`, or -1
  std::vector<const ElementBlock*> blocks;  ///< not empty, in the order of the mesh
};

std::int64_t n_elements(const SurfacePart& part, int dimension);

/// @throws InputError  no surface elements, or elements of that part that are of higher order
void check_surface_part(const Mesh& mesh, const std::filesystem::path& path, int least_dimension);

}  // namespace roughmesh::detail
