// SPDX-License-Identifier: BSD-3-Clause
// What the gamma function is needed for, where the function itself would overflow.
#pragma once

namespace roughmesh::detail {

/// Gamma(x + 1/2) / Gamma(x) for x > 0, about sqrt(x).
double gamma_ratio(double x);

/// log(Gamma(x) (e / x)^x) for x > 0: Stirling's formula without its large terms.
double log_scaled_gamma(double x);

}  // namespace roughmesh::detail
