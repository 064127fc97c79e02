// SPDX-License-Identifier: BSD-3-Clause
// What roughness a mesh can carry, known before anything is computed.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "roughmesh/correlation.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// Mesh sizes that a correlation length needs at least: Loth et al. (2020).
inline constexpr double sizes_per_length = 2.5;

/// How well the linear interpolant on the mesh follows a field of unit rms height, and how large
/// the heights may be. Formulas: docs/math.md, section "Resolution".
struct Resolution {
  double mesh_size = 0;              ///< h, the median edge
  double largest_edge = 0;           ///< where the mesh is coarsest
  std::array<double, 3> lengths{};   ///< correlation length along each axis; equal when isotropic
  std::array<double, 3> h_over_l{};  ///< the rule of the method's source: at most 1 / 2.5

  /// Share of the variance above the Nyquist wavenumber pi / h, two-dimensional, on the worst axis.
  double spectrum_share_above_nyquist = 0;
  double interpolation_error = 0;     ///< rms at mid-edge over Rq, on the worst axis
  double rms_slope = 0;               ///< of the linear interpolant on this mesh, over Rq
  std::optional<double> field_slope;  ///< of the field itself, over Rq, where it exists

  double expected_max_height = 0;   ///< largest |height| of one realization to expect, over Rq
  double min_curvature_radius = 0;  ///< smallest local radius of curvature; infinite when flat
  double largest_safe_rq = 0;       ///< min_curvature_radius / expected_max_height
};

/// Everything in the result is per unit of Rq or independent of it.
/// @throws InputError  the correlation is not one of the points of this surface
Resolution assess_resolution(const Surface& surface, const Correlation& correlation);

/// One line for each limit that rms roughness `rq` on this surface passes: coarse mesh, rough
/// spectrum, heights beyond the radius of curvature, slopes above 1. Empty when all is well. The
/// limits are those of docs/math.md, section "Resolution".
std::vector<std::string> resolution_warnings(const Resolution& resolution, double rq);

/// Those of them that come from the heights and not from a coarse mesh.
std::vector<std::string> height_warnings(const Resolution& resolution, double rq);

}  // namespace roughmesh
