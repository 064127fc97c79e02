// SPDX-License-Identifier: BSD-3-Clause
// Whether a prepared field has the covariance that was asked for.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/field.hpp"

#include "field_method.hpp"

namespace roughmesh::detail {

/// Points among which pairs are sought: all up to 20,000, else those of 40 neighbourhoods spread
/// over Morton's curve, one of them around its shortest step. Ascending.
std::vector<Index> audited_points(std::span<const Vec3> places, const Distance& distance);

/// All pairs i < j where there are at most 10^4; otherwise up to 10^4 of them, log-stratified in
/// distance from (nearly) the shortest to the largest among the audited points. A function of the
/// places and the distance.
std::vector<PointPair> audited_pairs(const Correlation& correlation);

/// Compares the covariances of the method with its target on the audited pairs and up to 10^4
/// diagonal entries. A covariance that is not a number counts as an infinite error.
Audit audit_covariance(const FieldMethod& method);

}  // namespace roughmesh::detail
