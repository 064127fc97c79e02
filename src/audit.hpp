// SPDX-License-Identifier: BSD-3-Clause
// Whether a prepared field has the covariance that was asked for.
#pragma once

#include <vector>

#include "roughmesh/field.hpp"

#include "field_method.hpp"

namespace roughmesh::detail {

/// All pairs i < j where there are at most 10^4; otherwise up to 10^4 of them, log-stratified in
/// distance from (nearly) the shortest to the largest. A function of the places and the distance.
std::vector<PointPair> audited_pairs(const Correlation& correlation);

/// Compares the covariances of the method with its target on the audited pairs and up to 10^4
/// diagonal entries. A covariance that is not a number counts as an infinite error.
Audit audit_covariance(const FieldMethod& method, const Correlation& correlation);

}  // namespace roughmesh::detail
