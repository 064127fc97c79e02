// SPDX-License-Identifier: BSD-3-Clause
// What a request means on a surface: the correlation between its points.
#pragma once

#include <string>

#include "roughmesh/correlation.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/options.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// Correlation between the points of a surface, by the distance that the request asks for and the
/// autocorrelation that goes with it: of anisotropic lengths, that of the first finite one.
/// @throws InputError  periodic and minimum-image without a period
Correlation field_model(const Roughness& request, const Surface& surface);

/// A surface and the field on it, as a run prepares them.
struct SurfaceModel {
  Surface surface;          ///< with one normal for each point and its periodic images
  Roughness request;        ///< distance and period filled in from the periodic links of the mesh
  Correlation correlation;  ///< between the points of the surface
  std::string refusal;      ///< why a run would refuse it: links that it would tear; else empty
};

/// @param request  rms above 0; the groups were used for `surface`
/// @throws InputError  as field_model; periods that contradict the links; masks that cannot be
SurfaceModel surface_model(const Mesh& mesh, const Surface& surface, const Roughness& request);

}  // namespace roughmesh
