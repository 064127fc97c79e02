// SPDX-License-Identifier: BSD-3-Clause
// How far the nearest other place is.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Distance of each place to the nearest place that is not equal to it, images among them;
/// infinite where all are equal.
/// @param places  equal ones follow each other
/// @param period  of the images along each axis; 0: none
std::vector<double> nearest_distances(std::span<const Vec3> places, const Vec3& period);

}  // namespace roughmesh::detail
