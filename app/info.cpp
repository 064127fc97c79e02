// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/pipeline.hpp"

#include "commands.hpp"

namespace roughmesh::app {
namespace {

void print_mesh(const Mesh& mesh, const std::string& path) {
  fmt::print("{}  {}, {} nodes, {} elements\n", path, name(mesh.format), mesh.n_nodes(),
             n_elements(mesh));
  std::map<std::string, std::int64_t> counts;
  for (const ElementBlock& block : mesh.blocks) counts[name(block.type)] += block.size();
  for (const auto& [type, count] : counts) fmt::print("  {:<28} {:>12}\n", type, count);
  if (!mesh.periodic_links.empty())
    fmt::print("  {:<28} {:>12}\n", "periodic links", mesh.periodic_links.size());
}

/// Of each group that has any, by dimension and number.
std::map<std::pair<int, Tag>, std::int64_t> elements_of_groups(const Mesh& mesh) {
  std::map<std::pair<int, Tag>, std::int64_t> counts;
  for (const ElementBlock& block : mesh.blocks)
    for (const Tag tag : block.physical_groups)
      counts[{dimension(block.type.shape), tag}] += block.size();
  return counts;
}

const char* measure_of(const Surface& surface) {
  return surface.dimension == 1 ? "length" : "area";
}

/// Area (of lines: length) and edge lengths of a group, or why it has none.
std::string surface_size(const Mesh& mesh, const PhysicalGroup& group) {
  if (group.dimension != 1 && group.dimension != 2) return "";
  if (group.dimension == 1 && dimension(mesh) > 2) return "";
  const std::string choice = group.name.empty() ? std::to_string(group.tag) : group.name;
  try {
    const Surface surface = select_surface(mesh, {.groups = {choice}});
    if (surface.dimension != group.dimension) return "";  // another group of that number is meant
    return fmt::format("  {} {:.6g}  h {:.4g} ({:.4g} to {:.4g})", measure_of(surface),
                       surface.area, surface.mesh_size.median, surface.mesh_size.min,
                       surface.mesh_size.max);
  } catch (const InputError& error) {
    return fmt::format("  {}", error.what());
  }
}

void print_groups(const Mesh& mesh) {
  if (mesh.groups.empty()) return;
  fmt::print("\nphysical groups (dimension, number, name, elements)\n");
  // Each size takes a look at the whole mesh, which thousands of groups would make slow.
  constexpr std::size_t most_sizes = 50;
  auto counts = elements_of_groups(mesh);
  for (std::size_t i = 0; i < mesh.groups.size(); ++i) {
    const PhysicalGroup& group = mesh.groups[i];
    fmt::print("  {}  {:>6}  {:<20} {:>10}{}\n", group.dimension, group.tag,
               group.name.empty() ? "-" : group.name, counts[{group.dimension, group.tag}],
               i < most_sizes ? surface_size(mesh, group) : "");
  }
  if (mesh.groups.size() > most_sizes)
    fmt::print("  sizes of the first {} groups only; --group NAME shows that of another\n",
               most_sizes);
}

void print_surface(const Surface& surface, EdgeRule edges, const std::string& unit) {
  const MeshSize& h = surface.mesh_size;
  const bool is_curve = surface.dimension == 1;
  fmt::print("\n{} {}\n", is_curve ? "curve" : "surface", list_of(surface.groups));
  fmt::print("  {:<34} {} points, {} {}, {} piece{}, {}\n", "size", surface.n_points(),
             surface.n_elements, is_curve ? "lines" : "faces", surface.n_components,
             surface.n_components == 1 ? "" : "s",
             surface.n_border_edges == 0 ? "closed"
                                         : fmt::format("open ({} {})", surface.n_border_edges,
                                                       is_curve ? "end points" : "border edges"));
  fmt::print("  {:<34} {:.6g} {}{}\n", measure_of(surface), surface.area, unit,
             is_curve ? "" : "^2");
  fmt::print(
      "  {:<34} {:.4g} {} (from {:.4g} to {:.4g}){}\n",
      is_curve ? "mesh size h (median line)" : "mesh size h (median edge)", h.median, unit, h.min,
      h.max,
      surface.n_faces() > surface.n_elements ? ", between nodes of elements of order 2" : "");
  fmt::print("  {:<34} {:.4g} {}\n", "shortest correlation length 2.5 h",
             sizes_per_length * h.median, unit);
  if (surface.n_sharp_edges > 0)
    fmt::print("  {:<34} {} (--edges {})\n", is_curve ? "sharp corners" : "sharp edges",
               surface.n_sharp_edges, name(edges));
  if (surface.n_nonmanifold_edges > 0)
    fmt::print("  {:<34} {}\n",
               is_curve ? "points of three or more lines" : "edges of three or more faces",
               surface.n_nonmanifold_edges);
}

/// As a run would take it, with the period of the links of the mesh.
void print_distance(const Roughness& request, const std::string& unit) {
  fmt::print("  {:<34} {}", "distance", name(*request.distance));
  if (!request.period.empty())
    fmt::print(", period {:.6g} {}", fmt::join(request.period, ", "), unit);
  fmt::print("\n");
}

std::string optional_length(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "none";
}

void print_lengths(const Autocorrelation& autocorrelation, const std::string& unit) {
  const EquivalentLengths lengths = autocorrelation.equivalent_lengths();
  fmt::print("\ncorrelation length of {}, in {}\n", name(autocorrelation.family()), unit);
  fmt::print("  {:<34} {}\n", "formula", optional_length(lengths.formula));
  fmt::print("  {:<34} {:.6g}\n", "1/e distance", lengths.one_over_e);
  fmt::print("  {:<34} {}\n", "integral scale", optional_length(lengths.integral));
  fmt::print("  {:<34} {:.6g}\n", "Sal (decay to 0.2)", lengths.sal);
}

void print_resolution(const Resolution& r, bool has_rms, double rms, const std::string& unit) {
  const double rq = has_rms ? rms : 1.0;
  const std::string per = has_rms ? "" : " (times Rq)";
  fmt::print("\nwhat the mesh carries\n");
  fmt::print("  {:<34} {:.3g}, {:.3g}, {:.3g} (rule: at most 0.4)\n", "h / l along each axis",
             r.h_over_l[0], r.h_over_l[1], r.h_over_l[2]);
  fmt::print("  {:<34} {:.2g} %\n", "spectrum above Nyquist pi / h",
             100 * r.spectrum_share_above_nyquist);
  fmt::print("  {:<34} {:.2g} %\n", "interpolation error at mid-edge", 100 * r.interpolation_error);
  fmt::print("  {:<34} {:.3g}{}\n", "expected rms slope on the mesh", rq * r.rms_slope, per);
  fmt::print("  {:<34} {}\n", "rms slope of the field",
             r.field_slope ? fmt::format("{:.3g}{}", rq * *r.field_slope, per) : "none");
  fmt::print("  {:<34} {:.3g} {}{}\n", "largest height to expect", rq * r.expected_max_height, unit,
             per);
}

void print_limits(const Resolution& r, const std::string& unit) {
  fmt::print("  {:<34} {:.4g} {}\n", "smallest radius of curvature", r.min_curvature_radius, unit);
  fmt::print("  {:<34} {:.4g} {}\n", "largest safe Rq by curvature", r.largest_safe_rq, unit);
}

/// What one point tells of the field on all of them, at no cost.
void print_sampling(const FieldOptions& options, const Correlation& correlation) {
  const Index first = 0;
  const FieldSampler sampler(correlation.among({&first, 1}), options);
  const FieldSummary& summary = sampler.summary();
  fmt::print("\nhow it is sampled\n");
  fmt::print("  {:<34} {}\n", "method", name(summary.method));
  if (summary.cholesky) {
    const auto n = static_cast<double>(correlation.n_points());
    fmt::print("  {:<34} {:.3g} GiB\n", "memory of the matrix", n * n * sizeof(double) / (1 << 30));
    return;
  }
  const LatticeSummary& lattice = *summary.lattice;
  if (options.cutoff)
    fmt::print("  {:<34} {:.2g} % (Rq is then {:.4g} of --rms)\n", "variance below the cutoff",
               100 * lattice.lost_variance, std::sqrt(1 - lattice.lost_variance));
  fmt::print("  {:<34} {}\n", "same heights on other meshes",
             lattice.same_on_other_meshes ? "yes" : "no (--cutoff LENGTH makes them)");
}

/// Without a length asked for, the shortest the mesh carries; without heights, heights of 1.
Roughness with_defaults(Roughness options, bool has_rms, const Surface& surface) {
  const bool has_length =
      !options.length.empty() || options.rolloff || options.acf == Family::table;
  if (!has_length) options.length = {sizes_per_length * surface.mesh_size.median};
  if (!has_rms) options.rms = 1;
  return options;
}

}  // namespace

void run_info(const RoughenOptions& options, bool has_rms) {
  if (options.input.empty()) throw InputError("INPUT: missing; give a mesh: roughmesh info MESH");
  const std::string unit = options.unit.empty() ? "mesh units" : options.unit;
  const Roughness& request = options.surfaces.front();
  if (has_rms && !(std::isfinite(request.rms) && request.rms > 0))
    throw InputError(fmt::format("--rms: {:g}; must be a positive number", request.rms));
  check_field_options(options);
  const Mesh mesh = read_input(options);
  print_mesh(mesh, options.input);
  print_groups(mesh);

  Surface surface;
  try {
    surface = select_surface(mesh, surface_options(request));
  } catch (const InputError& error) {
    if (!request.group.empty()) throw;
    fmt::print("\n{}\n", error.what());
    return;
  }
  print_surface(surface, options.surfaces.front().edges, unit);
  const SurfaceModel model = surface_model(mesh, surface, with_defaults(request, has_rms, surface));
  const Resolution resolution = assess_resolution(model.surface, model.correlation);
  print_distance(model.request, unit);
  print_lengths(model.correlation.autocorrelation(), unit);
  print_resolution(resolution, has_rms, request.rms, unit);
  print_limits(resolution, unit);
  print_sampling(field_options(options, model.request), model.correlation);
  const double rq = has_rms ? request.rms : 0.0;
  for (const std::string& warning : resolution_warnings(resolution, rq))
    fmt::print("warning: {}{}\n", request.cutoff ? "before the cutoff: " : "", warning);
  if (!model.refusal.empty()) fmt::print("warning: {}\n", model.refusal);
}

}  // namespace roughmesh::app
