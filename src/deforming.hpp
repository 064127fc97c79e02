// SPDX-License-Identifier: BSD-3-Clause
// The simplices that stand for the elements of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "harmonic.hpp"

namespace roughmesh::detail {

using NodeFlags = std::vector<std::uint8_t>;  ///< one per node of the mesh

/// Those with a free node. A triangle or tetrahedron stands for itself, every other shape of the
/// dimension for the simplices at its corners.
std::vector<Simplex> deforming_simplices(const Mesh& mesh, int cell_dimension,
                                         const NodeFlags& is_free);

}  // namespace roughmesh::detail
