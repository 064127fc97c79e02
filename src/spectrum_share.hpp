// SPDX-License-Identifier: BSD-3-Clause
// Share of the variance above a wavenumber (docs/math.md, eq. 14).
#pragma once

#include "roughmesh/autocorrelation.hpp"

namespace roughmesh::detail {

/// @param shape      nu, H, p or a of the family
/// @param x          wavenumber times correlation length of the formula, >= 0
/// @param dimension  1 or 2
double spectrum_share_above(Family family, double shape, double x, int dimension);

}  // namespace roughmesh::detail
