// SPDX-License-Identifier: BSD-3-Clause
// Cells of VTK, in its legacy and XML files alike.
// Format: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/index.html, and the
// class pages of vtkCell's heirs for the order of nodes.
#pragma once

#include <filesystem>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

struct VtkCell {
  int number = 0;
  ElementType type;
  std::vector<int> places;  ///< of each of VTK's nodes in Gmsh's order
};

/// The cell with this number; null where roughmesh has no element for it.
const VtkCell* vtk_cell(Tag number);
/// The cell of this type; null where VTK has none with a fixed order of nodes.
const VtkCell* vtk_cell(const ElementType& type);

/// Refuses elements that VTK has no cell for.
/// @throws InputError
void check_for_vtk(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace roughmesh::detail
