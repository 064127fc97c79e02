// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/report.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "options_json.hpp"

namespace roughmesh {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity and no NaN; what does not exist is null.
ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

template <class T>
ordered_json optional(const std::optional<T>& value) {
  if constexpr (std::is_same_v<T, double>) return value ? number(*value) : ordered_json();
  return value ? ordered_json(*value) : ordered_json();
}

template <std::size_t N>
ordered_json list(const std::array<double, N>& values) {
  ordered_json result = ordered_json::array();
  for (const double value : values) result.push_back(number(value));
  return result;
}

ordered_json input_json(const Report& r) {
  return {{"path", r.request.input},
          {"format", r.format},
          {"nodes", r.n_nodes},
          {"elements", r.n_elements}};
}

ordered_json surface_json(const SurfaceReport& r) {
  return {{"groups", r.groups},
          {"dimension", r.dimension},
          {"nodes", r.nodes},
          {"elements", r.elements},
          {"masked_nodes", r.masked_nodes},
          {"area", number(r.area)},
          {"mesh_size",
           {{"min", number(r.mesh_size.min)},
            {"median", number(r.mesh_size.median)},
            {"max", number(r.mesh_size.max)}}},
          {"components", r.components},
          {"border_edges", r.border_edges},
          {"sharp_edges", r.sharp_edges},
          {"nonmanifold_edges", r.nonmanifold_edges}};
}

ordered_json resolution_json(const Resolution& r) {
  return {{"lengths", list(r.lengths)},
          {"h_over_l", list(r.h_over_l)},
          {"spectrum_share_above_nyquist", number(r.spectrum_share_above_nyquist)},
          {"interpolation_error", number(r.interpolation_error)},
          {"rms_slope", number(r.rms_slope)},
          {"field_slope", optional(r.field_slope)},
          {"expected_max_height", number(r.expected_max_height)},
          {"min_curvature_radius", number(r.min_curvature_radius)},
          {"largest_safe_rq", number(r.largest_safe_rq)}};
}

ordered_json cholesky_json(const CholeskySummary& r) {
  return {{"factorization", name(r.factorization)},
          {"rank", r.rank},
          {"negative_eigenvalues", r.negative_eigenvalues},
          {"smallest_eigenvalue", optional(r.smallest_eigenvalue)},
          {"smallest_correlation", number(r.smallest_correlation)},
          {"variance_change", number(r.variance_change)}};
}

ordered_json lattice_json(const LatticeSummary& r) {
  ordered_json terms = ordered_json::array();
  for (const GaussianTerm& term : r.terms)
    terms.push_back({{"scale", number(term.scale)}, {"weight", number(term.weight)}});
  return {{"terms", std::move(terms)},
          {"nugget", number(r.nugget)},
          {"lost_variance", number(r.lost_variance)},
          {"same_on_other_meshes", r.same_on_other_meshes}};
}

ordered_json field_json(const SurfaceReport& r, double tolerance) {
  ordered_json object = {{"method", name(r.field.method)},
                         {"tolerance", tolerance},
                         {"covariance_error", number(r.audit.covariance_error)},
                         {"audited_pairs", r.audit.n_pairs},
                         {"equivalent_lengths",
                          {{"formula", optional(r.lengths.formula)},
                           {"one_over_e", number(r.lengths.one_over_e)},
                           {"integral", optional(r.lengths.integral)},
                           {"sal", number(r.lengths.sal)}}}};
  if (r.field.cholesky) object.update(cholesky_json(*r.field.cholesky));
  if (r.field.lattice) object.update(lattice_json(*r.field.lattice));
  object["fit_residual"] = optional(r.fit_residual);
  object["minimum_image_difference"] = optional(r.field.minimum_image_difference);
  return object;
}

ordered_json statistics_json(const SurfaceStatistics& r) {
  const auto unfaded = [&](double UnfadedSq::*member) {
    return r.unfaded ? number((*r.unfaded).*member) : ordered_json();
  };
  return {{"sq", number(r.heights.sq)},
          {"sq_expected", number(r.sq_expected)},
          {"sq_expected_std", number(r.sq_expected_std)},
          {"sq_unfaded", unfaded(&UnfadedSq::sq)},
          {"sq_unfaded_expected", unfaded(&UnfadedSq::expected)},
          {"sq_unfaded_expected_std", unfaded(&UnfadedSq::expected_std)},
          {"ssk", number(r.heights.ssk)},
          {"sku", number(r.heights.sku)},
          {"sz", number(r.heights.sz)},
          {"mean", number(r.heights.mean)}};
}

ordered_json realization_json(const RealizationReport& r) {
  ordered_json object = {{"index", r.index}, {"path", r.path}};
  object.update(statistics_json(r.surfaces.front()));
  object.update({{"inverted_elements", r.inverted_elements},
                 {"min_quality", number(r.min_quality)},
                 {"min_quality_before", number(r.min_quality_before)},
                 {"self_intersections", r.self_intersections},
                 {"slid_nodes", r.slid_nodes},
                 {"volume_method", name(r.volume_method)}});
  if (r.surfaces.size() < 2) return object;
  for (const SurfaceStatistics& surface : r.surfaces)
    object["surfaces"].push_back(statistics_json(surface));
  return object;
}

// The keys that describe one surface; those of the first stand at the top of a report.
ordered_json whole_surface_json(const SurfaceReport& r, double tolerance) {
  return {{"surface", surface_json(r)},
          {"resolution", resolution_json(r.resolution)},
          {"field", field_json(r, tolerance)}};
}

ordered_json timings_json(const Timings& timings) {
  ordered_json object;
  for_each_timing(timings, [&](std::string_view name, double seconds) { object[name] = seconds; });
  return object;
}

}  // namespace

std::string to_json(const Report& report) {
  ordered_json object;
  object["roughmesh"] = version();
  object["input"] = input_json(report);
  object["request"] = detail::options_to_json(report.request);
  const double tolerance = report.request.tolerance;
  object.update(whole_surface_json(report.surfaces.front(), tolerance));
  if (report.surfaces.size() > 1)
    for (const SurfaceReport& surface : report.surfaces)
      object["surfaces"].push_back(whole_surface_json(surface, tolerance));
  object["realizations"] = ordered_json::array();
  for (const RealizationReport& realization : report.realizations)
    object["realizations"].push_back(realization_json(realization));
  object["warnings"] = report.warnings;
  object["timings"] = timings_json(report.timings);
  object["citations"] = report.citations;
  return object.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string version() { return ROUGHMESH_VERSION; }

}  // namespace roughmesh
