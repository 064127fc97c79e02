// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"

#include "parallel.hpp"
#include "warnings.hpp"

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
  std::vector<bool> moves(mesh.nodes.size(), false);
  for (const Index node : surface.nodes) moves[node] = true;
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const auto& [slave, master] : link.nodes)
      if (moves[slave] || moves[master])
        throw InputError(fmt::format(
            "periodic link of entity {} to {}: node {} on it would move; periodic roughness is "
            "not supported yet, choose a group without linked nodes",
            link.entity, link.master_entity, mesh.node_tags[slave]));
}

Report begin_report(const Mesh& mesh, const RoughenOptions& options) {
  Report report;
  report.format = name(mesh.format);
  report.n_nodes = mesh.n_nodes();
  report.n_elements = n_elements(mesh);
  report.request = options;
  report.request.checksum = checksum(mesh);
  if (!options.checksum.empty() && options.checksum != report.request.checksum)
    report.warnings.push_back(fmt::format(
        "INPUT has checksum {}, not {}: it is not the file that --checksum or the job means",
        report.request.checksum, options.checksum));
  return report;
}

std::vector<std::string> cited_works(const FieldSampler& sampler, const Autocorrelation& rho) {
  std::vector<std::string> works = sampler.citations();
  for (std::string& work : rho.citations()) works.push_back(std::move(work));
  works.emplace_back(
      "Max (1999), Weights for computing vertex normals from facet normals, "
      "doi:10.1080/10867651.1999.10487501");
  return works;
}

void describe_surface(Report& report, const Surface& surface) {
  report.surface_groups = surface.groups;
  report.surface_nodes = surface.n_points();
  report.surface_elements = surface.n_elements;
  report.surface_area = surface.area;
  report.mesh_size = surface.mesh_size;
  report.surface_components = surface.n_components;
  report.border_edges = surface.n_border_edges;
  report.sharp_edges = surface.n_sharp_edges;
  report.nonmanifold_edges = surface.n_nonmanifold_edges;
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

std::vector<Vec3> differences(std::span<const Vec3> after, std::span<const Vec3> before) {
  std::vector<Vec3> result(after.begin(), after.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= before[i];
  return result;
}

/// What helps against inverted elements; a finer mesh does not, it makes them smaller.
std::string remedy(const Autocorrelation& rho, const VolumeMover& mover) {
  std::string text = "lower --rms";
  text += rho.slope_variance()
              ? " or use a longer --length"
              : " or take a smoother --acf (slopes of this one grow as the mesh is refined)";
  if (mover.n_wall_nodes() > 0)
    text += "; the rough surface ends on faces that stay, where elements invert first";
  return text + "; --allow-invalid writes it all the same";
}

void refuse_invalid(const RoughMesh& rough, const std::string& remedy, Report& report) {
  if (rough.check.valid()) return;
  const Finding& worst = rough.check.findings.front();
  const std::string found = fmt::format(
      "realization {}: {} inverted elements, the worst is element {} ({}) at ({:.6g}, {:.6g}, "
      "{:.6g}) "
      "with scaled Jacobian {:.3g}",
      rough.realization, rough.check.inverted_elements, worst.element, worst.what, worst.place.x(),
      worst.place.y(), worst.place.z(), worst.value);
  if (!report.request.allow_invalid) throw CheckError(found + "; " + remedy);
  report.warnings.push_back(found + "; written because of --allow-invalid");
}

RealizationReport describe(const RoughMesh& rough, const HeightStatistics& statistics,
                           const ExpectedSq& expected, double rq) {
  RealizationReport result;
  result.index = rough.realization;
  result.statistics = statistics;
  result.sq_expected = rq * expected.mean;
  result.sq_expected_std = rq * expected.standard_deviation;
  result.inverted_elements = rough.check.inverted_elements;
  result.min_quality = rough.check.min_quality;
  return result;
}

std::vector<double> heights_of(const FieldSampler& sampler, const RoughenOptions& options,
                               std::uint64_t realization) {
  std::vector<double> heights = sampler.heights(options.seed, realization);
  for (double& height : heights) height *= options.rms;
  return heights;
}

VolumeMethod volume_method(const RoughenOptions& options) {
  return options.volume == VolumeChoice::move ? VolumeMethod::harmonic : VolumeMethod::none;
}

}  // namespace

Report roughen(const Mesh& mesh, const RoughenOptions& options, const Deliver& deliver) {
  check_options(options);
  const detail::ThreadLimit threads(options.threads);
  Report report = begin_report(mesh, options);
  report.request.threads = threads.n_threads();  // results are the same bits at equal threads only
  Timings& t = report.timings;

  const Surface surface =
      timed(t.surface, [&] { return select_surface(mesh, surface_options(options)); });
  refuse_moving_links(mesh, surface);
  describe_surface(report, surface);
  const FieldModel model = field_model(options, surface.points);
  const Autocorrelation& rho = model.autocorrelation;
  const Distance& distance = model.distance;
  report.lengths = rho.equivalent_lengths();
  report.resolution = timed(t.surface, [&] { return assess_resolution(surface, rho, distance); });
  detail::warn_of_surface(report, surface);
  detail::warn_of_scale(report, mesh, surface);

  const std::span surfaces(&surface, 1);
  const VolumeMover mover =
      timed(t.volume, [&] { return VolumeMover(mesh, surfaces, volume_method(options)); });
  detail::warn_of_walls(report, mover);
  const double quality_before = timed(t.check, [&] { return min_quality(mesh); });

  const FieldSampler sampler = timed(
      t.field, [&] { return FieldSampler(surface.points, rho, distance, field_options(options)); });
  report.field = sampler.summary();
  report.audit = timed(t.audit, [&] { return sampler.audit(); });
  detail::warn_of_field(report);
  const ExpectedSq expected = timed(t.audit, [&] { return expected_sq(surface, rho, distance); });
  report.citations = cited_works(sampler, rho);

  RoughMesh rough{.mesh = mesh,
                  .normals = at_nodes<Vec3>(mesh, surface, surface.normals, Vec3::Zero())};
  for (std::uint64_t k = 0; k < options.realizations; ++k) {
    rough.realization = options.first + k;
    const std::vector<double> heights =
        timed(t.field, [&] { return heights_of(sampler, options, rough.realization); });
    const std::vector<Vec3> displacements = timed(t.displace, [&] {
      return displace_nodes(surfaces, {&heights, 1});
    });
    rough.mesh.nodes = timed(t.volume, [&] { return mover.move(displacements); });
    rough.check = timed(t.check, [&] { return check_mesh(mesh, rough.mesh.nodes); });
    refuse_invalid(rough, remedy(rho, mover), report);
    if (k == 0) detail::warn_of_curved_elements(report, rough.check);

    rough.heights = at_nodes<double>(mesh, surface, heights, 0.0);
    rough.displacements = differences(rough.mesh.nodes, mesh.nodes);
    report.realizations.push_back(
        describe(rough, height_statistics(surface, heights), expected, options.rms));
    report.realizations.back().min_quality_before = quality_before;
    report.realizations.back().volume_method = mover.method();
    timed(t.write, [&] { deliver(rough, report); });
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
