// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/pipeline.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"
#include "roughmesh/walls.hpp"

#include "field_ensemble.hpp"
#include "new_tags.hpp"
#include "parallel.hpp"
#include "refusals.hpp"
#include "rough_surface.hpp"
#include "stage_timer.hpp"
#include "surface_report.hpp"
#include "volume_stage.hpp"
#include "warnings.hpp"

namespace roughmesh {
namespace {

using detail::FieldEnsemble;
using detail::RoughSurfaces;
using detail::SqTarget;
using detail::SurfacePlan;

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

/// Nodes of walls that follow the surfaces; empty where there are none.
std::vector<std::uint8_t> following_nodes(const Walls& walls, std::span<const Surface> surfaces) {
  if (walls.sliding.empty()) return {};
  std::vector<std::uint8_t> flags(walls.is_wall.size(), 0);
  for (const SlidingNode& each : walls.sliding) flags[each.node] = 1;
  for (const Surface& surface : surfaces)
    for (const Index node : surface.nodes) flags[node] = 0;
  return flags;
}

std::vector<SurfaceReport> describe(const RoughSurfaces& rough) {
  std::vector<SurfaceReport> reports;
  for (std::size_t s = 0; s < rough.surfaces.size(); ++s)
    reports.push_back(detail::describe_surface(
        rough.surfaces[s], rough.plans[s], detail::correlation_of(rough.plans[s], rough.fields)));
  return reports;
}

std::vector<SqTarget> expect_sq(const RoughSurfaces& rough, const FieldEnsemble& fields) {
  std::vector<SqTarget> targets;
  for (std::size_t s = 0; s < rough.surfaces.size(); ++s) {
    const SurfacePlan& plan = rough.plans[s];
    targets.push_back(detail::expect_sq(rough.surfaces[s], plan,
                                        detail::correlation_of(plan, rough.fields),
                                        fields.covariance(plan)));
  }
  return targets;
}

/// The stages of one run, prepared in the order of the members, then one realization after the
/// other; each fills in its part of the report.
class Run {
 public:
  Run(const Mesh& mesh, const RoughenOptions& options, const Watch& watch, Report& report)
      : mesh_(mesh),
        report_(report),
        timer_(report.timings, watch),
        surfaces_(timer_.time(&Timings::surface, [&] { return select(options); })),
        walls_(timer_.time(&Timings::volume, [&] { return make_walls(); })),
        volume_(mesh, surfaces_, walls_, report, timer_),
        surface_mover_(timer_.time(&Timings::displace, [&] { return make_surface_mover(); })),
        quality_before_(timer_.time(&Timings::check, [&] { return min_quality(mesh); })),
        fields_(surfaces_, options, timer_),
        targets_(timer_.time(&Timings::audit, [&] { return expect_sq(surfaces_, fields_); })),
        checker_(timer_.time(&Timings::check, [&] { return make_checker(); })),
        walls_checker_(timer_.time(&Timings::check, [&] { return make_walls_checker(); })) {
    report_fields();
  }

  /// What is returned is lent until the next call.
  const RoughMesh& realize(std::uint64_t realization) {
    timer_.begin_realization(realization);
    rough_.realization = realization;
    const auto heights = timer_.time(&Timings::field, [&] { return fields_.heights(realization); });
    const MovedSurface moved =
        timer_.time(&Timings::displace, [&] { return surface_mover_.move(heights); });
    detail::warn_of_slides(report_, realization, moved);
    const std::vector<Vec3> nodes = moved_surface(moved.displacements);
    accept_surface(nodes);
    const detail::VolumeStage::Result followed =
        volume_.follow(moved.displacements, nodes, remedy("lower --rms"), rough_);
    accept_walls(followed.nodes);
    fill_fields(heights);
    report_.realizations.push_back(describe_realization(followed.method, heights));
    report_.realizations.back().slid_nodes = moved.n_slid;
    return rough_;
  }

  detail::StageTimer& timer() { return timer_; }

 private:
  RoughSurfaces select(const RoughenOptions& options) {
    RoughSurfaces rough = detail::prepare_surfaces(mesh_, options.surfaces);
    report_.surfaces = describe(rough);
    for (std::size_t s = 0; s < rough.surfaces.size(); ++s) {
      const Surface& surface = rough.surfaces[s];
      const Roughness& request = report_.request.surfaces[s] = rough.plans[s].request;
      detail::warn_of_surface(report_, surface, request);
      detail::warn_of_period(report_, surface, request);
      detail::warn_of_taper(report_, surface, rough.plans[s].taper);
      detail::warn_of_scale(report_, report_.surfaces[s], request);
    }
    return rough;
  }

  /// Something behind them follows.
  bool walls_can_slide() const {
    return report_.request.volume == VolumeChoice::move && has_volumes();
  }

  bool has_volumes() const {
    return n_elements(mesh_, surfaces_.surfaces.front().dimension + 1) > 0;
  }

  Walls make_walls() const {
    return find_walls(mesh_, surfaces_.surfaces,
                      {.can_slide = walls_can_slide(),
                       .moving = detail::moving_nodes(surfaces_, mesh_),
                       .period = detail::period_of(surfaces_)});
  }

  /// On walls that stay, and on lines and points of the mesh.
  std::vector<Index> anchored_nodes() const {
    std::vector<std::uint8_t> flags(mesh_.nodes.size(), 0);
    for (const Index node : walls_.torn) flags[node] = 1;
    for (const ElementBlock& block : mesh_.blocks)
      if (dimension(block.type.shape) < surfaces_.surfaces.front().dimension)
        for (const Index node : block.nodes) flags[node] = 1;
    std::vector<Index> nodes = moved_nodes(surfaces_.surfaces);
    std::erase_if(nodes, [&](Index node) { return flags[node] == 0; });
    return nodes;
  }

  SurfaceMover make_surface_mover() const {
    return {surfaces_.surfaces, detail::edge_options(surfaces_),
            NodeConstraints{.fixed = detail::fixed_nodes(surfaces_, mesh_),
                            .sliding = sliding_on_surfaces(walls_, surfaces_.surfaces),
                            .anchored = anchored_nodes()}};
  }

  detail::TornWalls torn_walls() const {
    return {static_cast<Index>(walls_.torn.size()),
            report_.request.volume == VolumeChoice::remesh && has_volumes()};
  }

  SurfaceChecker make_checker() const {
    detail::warn_of_walls(report_, torn_walls().n_nodes, walls_can_slide());
    SurfaceChecker checker(mesh_, surfaces_.surfaces, following_nodes(walls_, surfaces_.surfaces));
    for (std::size_t s = 0; s < surfaces_.surfaces.size(); ++s) {
      const Roughness& request = surfaces_.plans[s].request;
      const double height = report_.surfaces[s].resolution.expected_max_height * request.rms;
      if (const auto wall = checker.thinnest_wall(surfaces_.surfaces[s], height))
        detail::warn_of_thin_wall(report_, surfaces_.surfaces[s], request, *wall);
    }
    return checker;
  }

  std::optional<SurfaceChecker> make_walls_checker() const {
    if (walls_.sliding.empty()) return std::nullopt;
    return SurfaceChecker(mesh_, surfaces_.surfaces);
  }

  void report_fields() const {
    for (std::size_t s = 0; s < surfaces_.surfaces.size(); ++s) {
      const SurfacePlan& plan = surfaces_.plans[s];
      report_.surfaces[s].field = fields_.samplers()[plan.field].summary();
      report_.surfaces[s].audit = fields_.audits()[plan.field];
      if (std::any_of(plan.weights.begin(), plan.weights.end(), [](double w) { return w == 1; }))
        detail::warn_of_constant_heights(report_, surfaces_.surfaces[s].groups,
                                         targets_[s].unfaded.value_or(targets_[s].whole).mean);
    }
    detail::warn_of_fields(report_);
    report_.citations = fields_.citations();
    detail::add_citations(report_.citations,
                          {"Max (1999), Weights for computing vertex normals from facet normals, "
                           "doi:10.1080/10867651.1999.10487501"});
  }

  /// The surface alone, before anything follows it.
  void accept_surface(std::span<const Vec3> nodes) {
    rough_.surface_check = timer_.time(&Timings::check, [&] { return checker_.check(nodes); });
    if (report_.realizations.empty())
      detail::warn_of_input_intersections(report_, rough_.surface_check);
    refuse_surface();
  }

  /// The surface once more, with the walls that followed it.
  void accept_walls(std::span<const Vec3> nodes) {
    if (!walls_checker_ || !rough_.surface_check.valid()) return;
    rough_.surface_check =
        timer_.time(&Timings::check, [&] { return walls_checker_->check(nodes); });
    refuse_surface();
  }

  void refuse_surface() {
    detail::refuse_invalid(rough_.surface_check, rough_.realization,
                           remedy(detail::lower_rms(rough_.surface_check, report_.request) +
                                  (has_sharp_edges() ? ", hold sharp edges (--edges fix)" : "")),
                           report_);
  }

  bool has_sharp_edges() const {
    for (std::size_t s = 0; s < surfaces_.surfaces.size(); ++s)
      if (surfaces_.surfaces[s].n_sharp_edges > 0 &&
          surfaces_.plans[s].request.edges != EdgeRule::fix)
        return true;
    return false;
  }

  std::string remedy(const std::string& lower) const {
    return detail::remedy(surfaces_.fields, torn_walls(), lower);
  }

  /// The surface where it goes, all else where it was.
  std::vector<Vec3> moved_surface(const std::vector<Vec3>& displacements) const {
    std::vector<Vec3> nodes = mesh_.nodes;
    const std::vector<Index>& moving = surface_mover_.nodes();
    for (std::size_t i = 0; i < moving.size(); ++i) nodes[moving[i]] += displacements[i];
    return nodes;
  }

  /// At the nodes of the rough mesh, from those of the input.
  void fill_fields(const std::vector<std::vector<double>>& heights) {
    const std::vector<Surface>& surfaces = surfaces_.surfaces;
    const auto heights_of = [&](std::size_t s) -> const auto& { return heights[s]; };
    const auto normals_of = [&](std::size_t s) -> const auto& { return surfaces[s].normals; };
    rough_.heights = volume_.on_nodes_of<double>(
        rough_.mesh, at_nodes<double>(mesh_, surfaces, heights_of, 0.0), 0.0);
    rough_.normals = volume_.on_nodes_of<Vec3>(
        rough_.mesh, at_nodes<Vec3>(mesh_, surfaces, normals_of, Vec3::Zero()), Vec3::Zero());
  }

  RealizationReport describe_realization(VolumeMethod volume_method,
                                         const std::vector<std::vector<double>>& heights) const {
    RealizationReport result;
    result.index = rough_.realization;
    for (std::size_t s = 0; s < heights.size(); ++s)
      result.surfaces.push_back(detail::measure(
          surfaces_.surfaces[s], surfaces_.plans[s].request.rms, targets_[s], heights[s]));
    result.inverted_elements = rough_.check.inverted_elements;
    result.min_quality = rough_.check.min_quality;
    result.min_quality_before = quality_before_;
    result.volume_method = volume_method;
    result.self_intersections = rough_.surface_check.self_intersections;
    return result;
  }

  const Mesh& mesh_;
  Report& report_;
  detail::StageTimer timer_;
  const RoughSurfaces surfaces_;
  const Walls walls_;
  detail::VolumeStage volume_;
  const SurfaceMover surface_mover_;
  const double quality_before_;
  const FieldEnsemble fields_;
  const std::vector<SqTarget> targets_;                // one for each surface
  const SurfaceChecker checker_;                       // of what does not follow
  const std::optional<SurfaceChecker> walls_checker_;  // of all, where walls slide
  RoughMesh rough_;                                    // the latest
};

}  // namespace

Report roughen(const Mesh& mesh, const RoughenOptions& options, const Deliver& deliver,
               const Watch& watch) {
  check_options(options);
  const detail::ThreadLimit threads(options.threads);
  Report report = begin_report(mesh, options);
  report.request.threads = threads.n_threads();  // results are the same bits at equal threads only
  Run run(mesh, options, watch, report);
  for (std::uint64_t k = 0; k < options.realizations; ++k) {
    const RoughMesh& rough = run.realize(options.first + k);
    run.timer().time(&Timings::write, [&] { deliver(rough, report); });
  }
  return report;
}

Mesh output_sample(const Mesh& mesh, const RoughenOptions& options) {
  Mesh sample = mesh;
  if (options.volume != VolumeChoice::remesh || mesh.nodes.size() < 4) return sample;
  // Its number and entity are free: the sample differs from the file that was read.
  detail::NewTags tags("element");
  for (const ElementBlock& block : mesh.blocks) tags.keep_off(block.tags);
  sample.blocks.push_back({{ElementShape::tetrahedron, 1, 4}, 0, {}, {0, 1, 2, 3}, {tags.next()}});
  return sample;
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
