// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/move_volume.hpp"

#include "parallel.hpp"
#include "rough_surface.hpp"
#include "warnings.hpp"

namespace roughmesh {
namespace {

/// Adds the wall-clock time of its life to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

/// Of one of the members.
std::string_view name_of(const double& seconds, const Timings& timings) {
  std::string_view found;
  for_each_timing(timings, [&](std::string_view name, const double& each) {
    if (&each == &seconds) found = name;
  });
  return found;
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

using detail::FieldPlan;
using detail::RoughSurfaces;
using detail::SurfacePlan;

SurfaceReport describe_surface(const Surface& surface, const SurfacePlan& plan) {
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
  return report;
}

/// What Sq of one surface must be, over all of it and over what its masks leave whole.
struct SqTarget {
  ExpectedSq whole;
  std::vector<double> unfaded_areas;  ///< empty where nothing is masked, or everything
  std::optional<ExpectedSq> unfaded;
};

void add_once(std::vector<std::string>& works, std::vector<std::string> more) {
  for (std::string& work : more)
    if (std::find(works.begin(), works.end(), work) == works.end())
      works.push_back(std::move(work));
}

std::vector<std::string> cited_works(std::span<const FieldSampler> samplers,
                                     std::span<const FieldPlan> fields) {
  std::vector<std::string> works;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    add_once(works, samplers[f].citations());
    add_once(works, fields[f].correlation.autocorrelation().citations());
  }
  add_once(works, {"Max (1999), Weights for computing vertex normals from facet normals, "
                   "doi:10.1080/10867651.1999.10487501"});
  return works;
}

/// Covariance between the points of a surface, where it is not the correlation: what clipped
/// eigenvalues leave, or what is asked for under a cutoff.
std::function<double(Index, Index)> covariance_of(const FieldSampler& sampler,
                                                  const SurfacePlan& plan, const FieldPlan& field) {
  const auto& cholesky = sampler.summary().cholesky;
  const bool is_clipped = cholesky && cholesky->factorization == Factorization::eigenvalue;
  if (!is_clipped && !plan.request.cutoff) return {};
  const std::vector<Index> sampled = masters(field.partners);
  std::vector<Index> position_of(field.partners.master.size());
  for (std::size_t k = 0; k < sampled.size(); ++k) position_of[sampled[k]] = static_cast<Index>(k);
  std::vector<Index> position;
  position.reserve(plan.field_point.size());
  for (const Index point : plan.field_point)
    position.push_back(position_of[field.partners.master[point]]);
  return [&sampler, is_clipped, position = std::move(position)](Index i, Index j) {
    return is_clipped ? sampler.covariance(position[i], position[j])
                      : sampler.target(position[i], position[j]);
  };
}

SqTarget expect(const Surface& surface, const SurfacePlan& plan, const Correlation& correlation,
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

/// Values at the points of the surfaces as values at mesh nodes, `zero` elsewhere; where surfaces
/// meet, those of the last. `values_of(s)` are those of surface s.
template <class Value, class Values>
std::vector<Value> at_nodes(const Mesh& mesh, std::span<const Surface> surfaces, Values&& values_of,
                            const Value& zero) {
  std::vector<Value> result(mesh.nodes.size(), zero);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t i = 0; i < surfaces[s].nodes.size(); ++i)
      result[surfaces[s].nodes[i]] = values_of(s)[surfaces[s].point_of_node[i]];
  return result;
}

std::vector<Vec3> differences(std::span<const Vec3> after, std::span<const Vec3> before) {
  std::vector<Vec3> result(after.begin(), after.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= before[i];
  return result;
}

/// What helps against inverted elements and surfaces that meet themselves; a finer mesh does not,
/// it makes elements smaller.
/// @param lower  what to do with --rms
std::string remedy(std::span<const FieldPlan> fields, Index n_wall_nodes,
                   const std::string& lower = "lower --rms") {
  const bool is_smooth = std::all_of(fields.begin(), fields.end(), [](const FieldPlan& field) {
    return field.correlation.autocorrelation().slope_variance().has_value();
  });
  std::string text = lower;
  text += is_smooth ? " or use a longer --length"
                    : " or take a smoother --acf (slopes of this one grow as the mesh is refined)";
  if (n_wall_nodes > 0)
    text += "; the rough surface ends on faces that stay, where elements invert first: --fade";
  return text + "; --allow-invalid writes it all the same";
}

void refuse_invalid(const RoughMesh& rough, const std::string& remedy, Report& report) {
  if (rough.check.valid()) return;
  const Finding& worst = rough.check.findings.front();
  std::string found = fmt::format(
      "realization {}: {} inverted elements, the worst is element {} ({}) at ({:.6g}, {:.6g}, "
      "{:.6g}) "
      "with scaled Jacobian {:.3g}",
      rough.realization, rough.check.inverted_elements, worst.element, worst.what, worst.place.x(),
      worst.place.y(), worst.place.z(), worst.value);
  if (rough.check.inverted_elements == 0)
    found = fmt::format("realization {}: {}: a relative difference of {:.1e}", rough.realization,
                        worst.what, worst.value);
  if (!report.request.allow_invalid) throw CheckError(found + "; " + remedy);
  report.warnings.push_back(found + "; written because of --allow-invalid");
}

void refuse_surface(const SurfaceCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report) {
  if (check.valid()) return;
  const std::string found =
      fmt::format("realization {}: {}", realization, detail::describe_defects(check));
  if (!report.request.allow_invalid) throw CheckError(found + "; " + remedy);
  report.warnings.push_back(found + "; written because of --allow-invalid");
}

VolumeMethod last_method(const RoughenOptions& options) {
  return options.volume == VolumeChoice::move ? VolumeMethod::split : VolumeMethod::none;
}

/// The stages of one run, in order; each fills in its part of the report.
class Run {
 public:
  Run(const Mesh& mesh, const RoughenOptions& options, Report report, const Watch& watch)
      : mesh_(mesh), options_(options), report_(std::move(report)), watch_(watch) {}

  Report make(const Deliver& deliver) {
    select();
    const VolumeMover mover = timed(
        times().volume, [&] { return VolumeMover(mesh_, rough_.surfaces, last_method(options_)); });
    prepare_surface_mover();
    n_wall_nodes_ = detail::n_moving(rough_, mesh_, mover.wall_nodes());
    detail::warn_of_walls(report_, n_wall_nodes_);
    quality_before_ = timed(times().check, [&] { return min_quality(mesh_); });
    enclosure_ = timed(times().check, [&] { return Enclosure(mesh_); });
    prepare_surface_check();
    prepare_fields();
    RoughMesh rough{.mesh = mesh_};
    rough.normals = at_nodes<Vec3>(
        mesh_,
        rough_.surfaces, [&](std::size_t s) -> const auto& { return rough_.surfaces[s].normals; },
        Vec3::Zero());
    for (std::uint64_t k = 0; k < options_.realizations; ++k) {
      realization_ = rough.realization = options_.first + k;
      realize(mover, rough);
      timed(times().write, [&] { deliver(rough, report_); });
    }
    return std::move(report_);
  }

 private:
  Timings& times() { return report_.timings; }

  /// Runs a stage: tells that it begins, and adds its time to that of its name.
  template <class Stage>
  std::invoke_result_t<Stage> timed(double& seconds, Stage&& stage) {
    if (watch_) watch_({name_of(seconds, times()), realization_});
    const Stopwatch stopwatch(seconds);
    return stage();
  }

  void select() {
    rough_ =
        timed(times().surface, [&] { return detail::prepare_surfaces(mesh_, options_.surfaces); });
    for (std::size_t s = 0; s < rough_.surfaces.size(); ++s) {
      const Surface& surface = rough_.surfaces[s];
      report_.request.surfaces[s] = rough_.plans[s].request;
      const Correlation correlation = detail::correlation_of(rough_.plans[s], rough_.fields);
      SurfaceReport& described =
          report_.surfaces.emplace_back(describe_surface(surface, rough_.plans[s]));
      described.lengths = correlation.autocorrelation().equivalent_lengths();
      described.fit_residual = correlation.autocorrelation().fit_residual();
      described.resolution =
          timed(times().surface, [&] { return assess_resolution(surface, correlation); });
      detail::warn_of_surface(report_, surface, rough_.plans[s].request);
      detail::warn_of_period(report_, surface, rough_.plans[s].request);
      detail::warn_of_taper(report_, surface, rough_.plans[s].taper);
      detail::warn_of_scale(report_, described, rough_.plans[s].request);
    }
  }

  void prepare_surface_check() {
    timed(times().check, [&] {
      checker_.emplace(mesh_, rough_.surfaces);
      for (std::size_t s = 0; s < rough_.surfaces.size(); ++s) {
        const double height =
            report_.surfaces[s].resolution.expected_max_height * rough_.plans[s].request.rms;
        if (const auto wall = checker_->thinnest_wall(rough_.surfaces[s], height))
          detail::warn_of_thin_wall(report_, rough_.surfaces[s], rough_.plans[s].request, *wall);
      }
    });
  }

  void prepare_fields() {
    std::vector<Audit> audits;
    for (std::size_t f = 0; f < rough_.fields.size(); ++f) {
      const FieldPlan& plan = rough_.fields[f];
      FieldOptions sampling = field_options(options_, request_of(f));
      sampling.dimension = plan.dimension;
      samplers_.push_back(timed(times().field, [&] {
        return FieldSampler(plan.correlation.among(masters(plan.partners)), sampling);
      }));
      audits.push_back(timed(times().audit, [&] { return samplers_.back().audit(); }));
    }
    for (std::size_t s = 0; s < rough_.surfaces.size(); ++s) {
      const std::size_t field = rough_.plans[s].field;
      report_.surfaces[s].field = samplers_[field].summary();
      report_.surfaces[s].audit = audits[field];
      const SurfacePlan& plan = rough_.plans[s];
      targets_.push_back(timed(times().audit, [&] {
        return expect(rough_.surfaces[s], plan, detail::correlation_of(plan, rough_.fields),
                      covariance_of(samplers_[field], plan, rough_.fields[field]));
      }));
      const SqTarget& target = targets_.back();
      if (std::any_of(plan.weights.begin(), plan.weights.end(), [](double w) { return w == 1; }))
        detail::warn_of_constant_heights(report_, rough_.surfaces[s].groups,
                                         target.unfaded.value_or(target.whole).mean);
    }
    detail::warn_of_fields(report_);
    report_.citations = cited_works(samplers_, rough_.fields);
  }

  void prepare_surface_mover() {
    timed(times().displace, [&] {
      surface_mover_.emplace(
          rough_.surfaces, detail::edge_options(rough_),
          NodeConstraints{.fixed = detail::fixed_nodes(rough_, mesh_), .sliding = {}});
    });
  }

  /// Heights of every surface for one realization.
  std::vector<std::vector<double>> draw(std::uint64_t realization) const {
    std::vector<std::vector<double>> fields, heights;
    for (std::size_t f = 0; f < samplers_.size(); ++f)
      fields.push_back(
          expand(rough_.fields[f].partners, samplers_[f].heights(request_of(f).seed, realization)));
    for (const SurfacePlan& plan : rough_.plans)
      heights.push_back(detail::heights_of(plan, fields[plan.field]));
    return heights;
  }

  /// Of the first surface that shows the field.
  const Roughness& request_of(std::size_t field) const {
    return std::find_if(rough_.plans.begin(), rough_.plans.end(),
                        [&](const SurfacePlan& plan) { return plan.field == field; })
        ->request;
  }

  /// The surface alone, before anything follows it.
  SurfaceCheck check_surfaces(const std::vector<Vec3>& displacements) const {
    std::vector<Vec3> moved = mesh_.nodes;
    const std::vector<Index>& nodes = surface_mover_->nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i) moved[nodes[i]] += displacements[i];
    return checker_->check(moved);
  }

  void realize(const VolumeMover& mover, RoughMesh& rough) {
    const auto heights = timed(times().field, [&] { return draw(rough.realization); });
    const std::vector<Vec3> displacements =
        timed(times().displace, [&] { return surface_mover_->move(heights); });
    rough.surface_check = timed(times().check, [&] { return check_surfaces(displacements); });
    if (report_.realizations.empty())
      detail::warn_of_input_intersections(report_, rough.surface_check);
    refuse_surface(rough.surface_check, rough.realization,
                   remedy(rough_.fields, n_wall_nodes_,
                          detail::lower_rms(rough.surface_check, report_.request)),
                   report_);
    const MovedVolume moved = timed(times().volume, [&] { return mover.move(displacements); });
    const Mesh& smooth = moved.split ? *moved.split : mesh_;
    if (moved.split || is_split_) rough.mesh = smooth;  // else only its nodes differ
    is_split_ = moved.split != nullptr;
    rough.mesh.nodes = moved.nodes;
    rough.check =
        timed(times().check, [&] { return check_mesh(smooth, moved.nodes, *enclosure_); });
    refuse_invalid(rough, remedy(rough_.fields, n_wall_nodes_), report_);
    if (report_.realizations.empty()) detail::warn_of_curved_elements(report_, rough.check);
    rough.heights = at_nodes<double>(
        mesh_, rough_.surfaces, [&](std::size_t s) -> const auto& { return heights[s]; }, 0.0);
    rough.displacements = differences(rough.mesh.nodes, smooth.nodes);
    rough.heights.resize(rough.mesh.nodes.size(), 0);
    rough.normals.resize(rough.mesh.nodes.size(), Vec3::Zero());
    if (moved.method > VolumeMethod::harmonic)
      add_once(report_.citations,
               {"Garanzha et al. (2021), Foldover-free maps in 50 lines of code, "
                "doi:10.1145/3450626.3459847"});
    if (moved.split) detail::warn_of_split(report_, rough.realization, mesh_, *moved.split);
    report_.realizations.push_back(describe(rough, moved.method, heights));
  }

  RealizationReport describe(const RoughMesh& rough, VolumeMethod volume_method,
                             const std::vector<std::vector<double>>& heights) const {
    RealizationReport result;
    result.index = rough.realization;
    for (std::size_t s = 0; s < heights.size(); ++s)
      result.surfaces.push_back(
          measure(rough_.surfaces[s], rough_.plans[s].request.rms, targets_[s], heights[s]));
    result.inverted_elements = rough.check.inverted_elements;
    result.min_quality = rough.check.min_quality;
    result.min_quality_before = quality_before_;
    result.volume_method = volume_method;
    result.self_intersections = rough.surface_check.self_intersections;
    return result;
  }

  const Mesh& mesh_;
  const RoughenOptions& options_;
  Report report_;
  RoughSurfaces rough_;
  std::vector<SqTarget> targets_;       // one for each surface
  std::vector<FieldSampler> samplers_;  // one for each field
  std::optional<SurfaceMover> surface_mover_;
  std::optional<SurfaceChecker> checker_;
  Index n_wall_nodes_ = 0;  // that move
  double quality_before_ = 0;
  bool is_split_ = false;  // the mesh handed over last has elements of its own
  std::optional<Enclosure> enclosure_;
  const Watch& watch_;
  std::optional<std::uint64_t> realization_;  // being made
};

}  // namespace

Report roughen(const Mesh& mesh, const RoughenOptions& options, const Deliver& deliver,
               const Watch& watch) {
  check_options(options);
  const detail::ThreadLimit threads(options.threads);
  Report report = begin_report(mesh, options);
  report.request.threads = threads.n_threads();  // results are the same bits at equal threads only
  return Run(mesh, options, std::move(report), watch).make(deliver);
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

}  // namespace roughmesh
