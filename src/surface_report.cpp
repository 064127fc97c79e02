// SPDX-License-Identifier: BSD-3-Clause
#include "surface_report.hpp"

#include <algorithm>
#include <utility>

#include "roughmesh/resolution.hpp"

namespace roughmesh::detail {

SurfaceReport describe_surface(const Surface& surface, const SurfacePlan& plan,
                               const Correlation& correlation) {
  SurfaceReport report;
  report.dimension = surface.dimension;
  report.groups = surface.groups;
  report.nodes = surface.n_points();
  report.elements = surface.n_elements;
  report.masked_nodes = std::count_if(plan.weights.begin(), plan.weights.end(),
                                      [](double weight) { return weight < 1; });
  report.area = surface.area;
  report.mesh_size = surface.mesh_size;
  report.components = surface.n_components;
  report.border_edges = surface.n_border_edges;
  report.sharp_edges = surface.n_sharp_edges;
  report.nonmanifold_edges = surface.n_nonmanifold_edges;
  report.lengths = correlation.autocorrelation().equivalent_lengths();
  report.fit_residual = correlation.autocorrelation().fit_residual();
  report.resolution = assess_resolution(surface, correlation);
  return report;
}

SqTarget expect_sq(const Surface& surface, const SurfacePlan& plan, const Correlation& correlation,
                   const std::function<double(Index, Index)>& covariance) {
  SqOptions options{.weights = plan.weights, .areas = {}, .covariance = covariance};
  SqTarget target{expected_sq(surface, correlation, options), {}, std::nullopt};
  std::vector<double> areas = full_weight_areas(surface, plan.weights);
  const auto n_whole = std::count_if(areas.begin(), areas.end(), [](double a) { return a > 0; });
  if (n_whole == 0 || n_whole == surface.n_points()) return target;
  options.areas = areas;
  target.unfaded = expected_sq(surface, correlation, options);
  target.unfaded_areas = std::move(areas);
  return target;
}

SurfaceStatistics measure(const Surface& surface, double rq, const SqTarget& target,
                          std::span<const double> heights) {
  SurfaceStatistics result{height_statistics(surface, heights), rq * target.whole.mean,
                           rq * target.whole.standard_deviation, std::nullopt};
  if (target.unfaded)
    result.unfaded = UnfadedSq{height_statistics(surface, heights, target.unfaded_areas).sq,
                               rq * target.unfaded->mean, rq * target.unfaded->standard_deviation};
  return result;
}

}  // namespace roughmesh::detail
