// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"

#include "parallel.hpp"

namespace roughmesh {
namespace {

/// Runs a stage and adds its wall-clock time to `seconds`.
template <class Stage>
auto timed(double& seconds, Stage&& stage) {
  using Clock = std::chrono::steady_clock;
  struct Add {
    double& seconds;
    Clock::time_point start = Clock::now();
    ~Add() { seconds += std::chrono::duration<double>(Clock::now() - start).count(); }
  } const add{seconds};
  return stage();
}

/// A link whose nodes move would need equal heights on both sides.
void refuse_moving_links(const Mesh& mesh, const Surface& surface) {
  const std::set<Index> moving(surface.nodes.begin(), surface.nodes.end());
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const auto& [slave, master] : link.nodes)
      if (moving.contains(slave) || moving.contains(master))
        throw InputError(fmt::format(
            "periodic link of entity {} to {}: node {} on it would move; periodic roughness is "
            "not supported yet, leave out the linked nodes or the $Periodic section",
            link.entity, link.master_entity, mesh.node_tags[slave]));
}

Report begin_report(const Mesh& mesh, const RoughenOptions& options) {
  Report report;
  report.format = name(mesh.format);
  report.n_nodes = mesh.n_nodes();
  report.n_elements = n_elements(mesh);
  report.request = options;
  return report;
}

void describe_surface(Report& report, const Surface& surface) {
  report.surface_groups = surface.groups;
  report.surface_nodes = surface.n_points();
  report.surface_elements = surface.n_faces();
  report.surface_area = surface.area;
  report.mesh_size = surface.mesh_size;
  report.surface_components = surface.n_components;
  report.border_edges = surface.n_border_edges;
  report.sharp_edges = surface.n_sharp_edges;
  report.nonmanifold_edges = surface.n_nonmanifold_edges;
}

void warn_of_surface(Report& report, const Surface& surface) {
  if (surface.n_sharp_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} sharp edges (more than {:g} degrees): their nodes move along averaged normals, which "
        "lowers the roughness there; round the edges for exact statistics",
        surface.n_sharp_edges, report.request.edge_angle));
  if (surface.n_nonmanifold_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} edges join three or more faces: normals along them are a compromise; choose one "
        "--group at a time",
        surface.n_nonmanifold_edges));
  if (surface.n_duplicate_faces > 0)
    report.warnings.push_back(fmt::format(
        "{} faces stand on the nodes of another one and count once", surface.n_duplicate_faces));
}

void warn_of_scale(Report& report, const Mesh& mesh, const Surface& surface,
                   const FieldModel& model) {
  const double rq = report.request.rms;
  for (std::string& warning : resolution_warnings(report.resolution, rq))
    report.warnings.push_back(std::move(warning));
  const double spacing = coordinate_spacing(mesh);
  if (rq < 1000 * spacing)
    report.warnings.push_back(fmt::format(
        "--rms {:g} is only {:.3g} spacings of the numbers the file can hold ({:.3g}): heights "
        "are rounded; use a file with more digits",
        rq, rq / spacing, spacing));
  const double size = std::sqrt(surface.area);
  const double length = model.autocorrelation.length();
  if (length > size)
    report.warnings.push_back(fmt::format(
        "correlation length {:g} is larger than the surface (square root of its area {:.3g}): it "
        "moves nearly as a whole; check the unit",
        length, size));
}

void warn_of_field(Report& report) {
  if (report.audit.covariance_error > report.request.tolerance)
    report.warnings.push_back(
        fmt::format("audited covariance error {:.3g} is above the tolerance {:g}",
                    report.audit.covariance_error, report.request.tolerance));
  if (report.field.variance_change > 1e-3)
    report.warnings.push_back(fmt::format(
        "this autocorrelation is not positive definite for this distance: {} negative "
        "eigenvalues were set to zero, which changes variances by up to {:.3g}; use a shorter "
        "length or --distance euclidean",
        report.field.negative_eigenvalues, report.field.variance_change));
}

void warn_of_walls(Report& report, const VolumeMover& mover) {
  if (mover.n_wall_nodes() > 0)
    report.warnings.push_back(fmt::format(
        "{} nodes of the rough surface lie on faces that are not roughened; they move along the "
        "normals of the rough surface",
        mover.n_wall_nodes()));
}

/// The stages up to the first realization, kept together because each stands on the one before.
struct Prepared {
  Surface surface;
  FieldModel model;
  FieldSampler sampler;
  VolumeMover mover;
  ExpectedSq expected;
  double min_quality = 0;
};

Prepared prepare(const Mesh& mesh, const RoughenOptions& options, Report& report) {
  Timings& t = report.timings;
  Surface surface =
      timed(t.surface, [&] { return select_surface(mesh, surface_options(options)); });
  refuse_moving_links(mesh, surface);
  FieldModel model = field_model(options, surface.points);
  describe_surface(report, surface);
  report.lengths = model.autocorrelation.equivalent_lengths();
  timed(t.surface, [&] {
    report.resolution = assess_resolution(surface, model.autocorrelation, model.distance);
  });
  warn_of_surface(report, surface);
  warn_of_scale(report, mesh, surface, model);

  const VolumeMethod method =
      options.volume == VolumeChoice::move ? VolumeMethod::harmonic : VolumeMethod::none;
  VolumeMover mover = timed(t.volume, [&] { return VolumeMover(mesh, surface, method); });
  warn_of_walls(report, mover);

  FieldSampler sampler = timed(t.field, [&] {
    return FieldSampler(surface.points, model.autocorrelation, model.distance,
                        field_options(options));
  });
  report.field = sampler.summary();
  report.audit = timed(t.audit, [&] { return sampler.audit(); });
  warn_of_field(report);
  report.citations = sampler.citations();
  for (std::string& citation : model.autocorrelation.citations())
    report.citations.push_back(std::move(citation));

  const ExpectedSq expected =
      timed(t.audit, [&] { return expected_sq(surface, model.autocorrelation, model.distance); });
  const double quality = timed(t.check, [&] { return min_quality(mesh); });
  return {std::move(surface), std::move(model), std::move(sampler),
          std::move(mover),   expected,         quality};
}

/// Values at surface points as values at mesh nodes, `zero` elsewhere.
template <class Value>
std::vector<Value> at_nodes(const Mesh& mesh, const Surface& surface,
                            std::span<const Value> at_points, const Value& zero) {
  std::vector<Value> result(mesh.nodes.size(), zero);
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    result[surface.nodes[i]] = at_points[surface.point_of_node[i]];
  return result;
}

void refuse_invalid(const RoughMesh& rough, Report& report) {
  if (rough.check.valid()) return;
  const Finding& worst = rough.check.findings.front();
  const std::string found = fmt::format(
      "realization {}: {} inverted elements, the worst is element {} ({}) at ({:.6g}, {:.6g}, "
      "{:.6g}) with "
      "scaled Jacobian {:.3g}",
      rough.realization, rough.check.inverted_elements, worst.element, worst.what, worst.place.x(),
      worst.place.y(), worst.place.z(), worst.value);
  if (!report.request.allow_invalid)
    throw CheckError(found +
                     "; lower --rms, use a longer --length or a finer mesh there, or pass "
                     "--allow-invalid");
  report.warnings.push_back(found + "; written because of --allow-invalid");
}

RealizationReport describe(const Prepared& prepared, const RoughMesh& rough,
                           std::span<const double> heights, double rq) {
  return {.index = rough.realization,
          .path = "",
          .statistics = height_statistics(prepared.surface, heights),
          .sq_expected = rq * prepared.expected.mean,
          .sq_expected_std = rq * prepared.expected.standard_deviation,
          .inverted_elements = rough.check.inverted_elements,
          .min_quality = rough.check.min_quality,
          .min_quality_before = prepared.min_quality,
          .self_intersections = std::nullopt,
          .volume_method = prepared.mover.method()};
}

RoughMesh realize(const Mesh& mesh, const Prepared& prepared, std::uint64_t index, Report& report) {
  const RoughenOptions& options = report.request;
  const Surface& surface = prepared.surface;
  Timings& t = report.timings;

  std::vector<double> heights =
      timed(t.field, [&] { return prepared.sampler.heights(options.seed, index); });
  for (double& height : heights) height *= options.rms;

  RoughMesh rough{index, mesh, {}, {}, {}, {}};
  timed(t.displace, [&] {
    rough.heights = at_nodes<double>(mesh, surface, heights, 0.0);
    rough.normals = at_nodes<Vec3>(mesh, surface, surface.normals, Vec3::Zero());
  });
  const std::vector<Vec3> displacements =
      timed(t.displace, [&] { return displace(surface, heights); });
  timed(t.volume, [&] { rough.mesh.nodes = prepared.mover.move(displacements); });
  rough.displacements.resize(mesh.nodes.size());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    rough.displacements[i] = rough.mesh.nodes[i] - mesh.nodes[i];

  timed(t.check, [&] { rough.check = check_mesh(mesh, rough.mesh.nodes); });
  refuse_invalid(rough, report);
  report.realizations.push_back(describe(prepared, rough, heights, options.rms));
  return rough;
}

}  // namespace

Report roughen(const Mesh& mesh, const RoughenOptions& options, const Deliver& deliver) {
  check_options(options);
  const detail::ThreadLimit threads(options.threads);
  Report report = begin_report(mesh, options);
  const Prepared prepared = prepare(mesh, options, report);
  for (std::uint64_t k = 0; k < options.realizations; ++k) {
    const RoughMesh rough = realize(mesh, prepared, options.first + k, report);
    timed(report.timings.write, [&] { deliver(rough, report); });
  }
  return report;
}

std::vector<PointField> point_fields(const RoughMesh& rough) {
  const auto flatten = [](const std::vector<Vec3>& vectors) {
    std::vector<double> values;
    values.reserve(3 * vectors.size());
    for (const Vec3& v : vectors) values.insert(values.end(), v.begin(), v.end());
    return values;
  };
  return {{"height", 1, rough.heights},
          {"normal", 3, flatten(rough.normals)},
          {"displacement", 3, flatten(rough.displacements)}};
}

FieldModel field_model(const RoughenOptions& options, std::span<const Vec3> points) {
  Autocorrelation autocorrelation(autocorrelation_options(options));
  if (options.distance == DistanceKind::great_circle)
    return {std::move(autocorrelation), Distance::great_circle(points)};
  if (options.length.size() < 2) return {std::move(autocorrelation), Distance::euclidean()};

  const double turn = options.angle / 180.0 * std::numbers::pi;
  Anisotropy anisotropy;
  anisotropy.lengths = {options.length[0], options.length[1], options.length.back()};
  anisotropy.axes = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  return {std::move(autocorrelation), Distance::stretched(anisotropy)};
}

}  // namespace roughmesh
