// SPDX-License-Identifier: BSD-3-Clause
// Which curves of a solid are sharp edges, and what rounding them takes away.
#pragma once

#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// What a fillet of some radius does to solids.
struct Rounding {
  std::vector<Tag> curves;   ///< entities of sharp edges, ascending
  double radius = 0;         ///< of the fillets
  double volume_change = 0;  ///< to be expected, of first order in radius / length (eq. 66)
  double volume_turned = 0;  ///< the same with what convex and concave edges change added up
};

/// Finds the curves on which the outward normals of two faces enclose more than an angle.
/// @param mesh   surfaces and curves of the solids, each with its entity; closed
/// @param angle  in radians
/// @throws InputError  open surfaces; solids that touch
Rounding plan_rounding(const Mesh& mesh, double radius, double angle);

/// Did the fillets change the volume of the solids as they should? OpenCASCADE gives wrong solids
/// without a word where a radius is too large.
bool is_plausible(const Rounding& rounding, double volume_before, double volume_after);

}  // namespace roughmesh::detail
