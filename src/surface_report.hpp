// SPDX-License-Identifier: BSD-3-Clause
// What the report says of a surface: what it is, the Sq to be expected on it, and what came of it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/correlation.hpp"
#include "roughmesh/report.hpp"
#include "roughmesh/statistics.hpp"
#include "roughmesh/surface.hpp"

#include "rough_surface.hpp"

namespace roughmesh::detail {

/// Size and shape of the surface, lengths and resolution of its roughness; no field yet.
SurfaceReport describe_surface(const Surface& surface, const SurfacePlan& plan,
                               const Correlation& correlation);

/// What Sq of one surface must be, in units of Rq, over all of it and over what its masks leave
/// whole.
struct SqTarget {
  ExpectedSq whole;
  std::vector<double> unfaded_areas;  ///< empty where nothing is masked, or everything
  std::optional<ExpectedSq> unfaded;
};

/// @param covariance  of two points of the surface; empty: the correlation
SqTarget expect_sq(const Surface& surface, const SurfacePlan& plan, const Correlation& correlation,
                   const std::function<double(Index, Index)>& covariance);

SurfaceStatistics measure(const Surface& surface, double rq, const SqTarget& target,
                          std::span<const double> heights);

}  // namespace roughmesh::detail
