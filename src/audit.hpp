// SPDX-License-Identifier: BSD-3-Clause
// Whether a prepared field has the covariance that was asked for.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/field.hpp"

#include "factor.hpp"

namespace roughmesh::detail {

/// All pairs i < j where there are at most 10^4; otherwise up to 10^4 of them, log-stratified in
/// distance from (nearly) the shortest to the largest. A function of the points and the distance.
std::vector<PointPair> audited_pairs(std::span<const Vec3> points, const Distance& distance);

/// Compares the covariances of the factor with rho on the audited pairs and up to 10^4 diagonal
/// entries. A covariance that is not a number counts as an infinite error.
Audit audit_covariance(const Factor& factor, std::span<const Vec3> points,
                       const Autocorrelation& autocorrelation, const Distance& distance);

}  // namespace roughmesh::detail
