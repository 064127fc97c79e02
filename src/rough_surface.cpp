// SPDX-License-Identifier: BSD-3-Clause
#include "rough_surface.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "roughmesh/pipeline.hpp"

#include "messages.hpp"

namespace roughmesh::detail {
namespace {

/// Positions of the surfaces that carry each field.
std::vector<std::vector<std::size_t>> share_fields(std::span<const Roughness> requests) {
  std::vector<std::vector<std::size_t>> fields;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto same = std::find_if(fields.begin(), fields.end(), [&](const auto& members) {
      return same_field(requests[members.front()], requests[i]);
    });
    if (same == fields.end())
      fields.push_back({i});
    else
      same->push_back(i);
  }
  return fields;
}

/// The faces of all surfaces of a field as one surface, which puts their points in one canonical
/// order.
Surface joined(const Mesh& mesh, std::span<const SurfacePlan> plans,
               std::span<const std::size_t> members) {
  SurfaceOptions options = surface_options(plans[members.front()].request);
  for (const std::size_t member : members.subspan(1)) {
    const std::vector<std::string>& groups = plans[member].request.group;
    options.groups.insert(options.groups.end(), groups.begin(), groups.end());
  }
  return select_surface(mesh, options);
}

/// For each point of `part`, the point of `whole` that has its node.
std::vector<Index> points_in(const Mesh& mesh, const Surface& part, const Surface& whole) {
  std::vector<Index> of_node(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < whole.nodes.size(); ++i)
    of_node[whole.nodes[i]] = whole.point_of_node[i];
  std::vector<Index> points(part.points.size());
  for (std::size_t i = 0; i < part.nodes.size(); ++i)
    points[part.point_of_node[i]] = of_node[part.nodes[i]];
  return points;
}

bool is_periodic(DistanceKind kind) {
  return kind == DistanceKind::periodic || kind == DistanceKind::minimum_image;
}

/// Links join nodes of a surface; unless the distance knows of them, or they stay, the two sides
/// would come apart.
void refuse_broken_links(const Surface& surface, const SurfacePlan& plan,
                         const PeriodicPartners& partners) {
  constexpr const char* remedy = "let the roughness end there with --fade WIDTH:GROUP or --fixed";
  for (Index i = 0; i < surface.n_points(); ++i) {
    if (plan.weights[i] == 0) continue;
    const std::string at = place(surface.points[i]);
    if (partners.rotated[i] != 0)
      throw InputError(fmt::format(
          "the periodic link of the node at {} is no translation along an axis; {}", at, remedy));
    if (partners.unpaired[i] != 0)
      throw InputError(fmt::format(
          "a periodic link joins the node at {} to one that stays; choose both sides, or {}", at,
          remedy));
    if (partners.master[i] != i && !is_periodic(*plan.request.distance))
      throw InputError(
          fmt::format("a periodic link joins the node at {} to another that moves; take --distance "
                      "periodic, or {}",
                      at, remedy));
  }
}

void fill_in_distance(Roughness& request, const Vec3& period) {
  const bool has_period = !period.isZero(0);
  if (!request.distance)
    request.distance = has_period ? DistanceKind::periodic : DistanceKind::euclidean;
  if (!is_periodic(*request.distance)) return;
  if (!has_period)
    throw InputError(
        fmt::format("--distance: {}; needs --period LX,LY,LZ, since the mesh has no periodic links",
                    name(*request.distance)));
  request.period = {period.x(), period.y(), period.z()};
}

PeriodicPartners partners_of(const Mesh& mesh, const Surface& surface, const Roughness& request) {
  if (request.period.empty()) return periodic_partners(mesh, surface);
  const std::vector<double>& p = request.period;
  return periodic_partners(mesh, surface, Vec3(p[0], p[1], p[2]));
}

FieldPlan plan_field(Correlation correlation, const PeriodicPartners& partners) {
  FieldPlan plan{std::move(correlation), masters(partners), {}};
  std::vector<Index> position(partners.master.size(), -1);
  for (std::size_t i = 0; i < plan.masters.size(); ++i)
    position[plan.masters[i]] = static_cast<Index>(i);
  for (const Index master : partners.master) plan.sampled_at.push_back(position[master]);
  return plan;
}

/// Every point for itself.
PeriodicPartners no_partners(Index n_points) {
  PeriodicPartners partners;
  partners.master.resize(static_cast<std::size_t>(n_points));
  std::iota(partners.master.begin(), partners.master.end(), Index{0});
  return partners;
}

/// One surface of a field whose points are those of `whole`.
void join_field(const Mesh& mesh, const Surface& whole, const Vec3& period, Surface& surface,
                SurfacePlan& plan) {
  fill_in_distance(plan.request, period);
  plan.field_point = points_in(mesh, surface, whole);
  const PeriodicPartners partners = partners_of(mesh, surface, plan.request);
  refuse_broken_links(surface, plan, partners);
  if (is_periodic(*plan.request.distance)) surface = with_partner_normals(surface, partners);
}

FieldPlan prepare_field(const Mesh& mesh, RoughSurfaces& rough,
                        std::span<const std::size_t> members) {
  const std::size_t first = members.front();
  const Surface whole =
      members.size() == 1 ? rough.surfaces[first] : joined(mesh, rough.plans, members);
  const PeriodicPartners partners = partners_of(mesh, whole, rough.plans[first].request);
  for (const std::size_t member : members)
    join_field(mesh, whole, partners.period, rough.surfaces[member], rough.plans[member]);
  const Roughness& request = rough.plans[first].request;
  return plan_field(field_model(request, whole),
                    is_periodic(*request.distance) ? partners : no_partners(whole.n_points()));
}

}  // namespace

RoughSurfaces prepare_surfaces(const Mesh& mesh, std::span<const Roughness> requests) {
  RoughSurfaces rough;
  for (const Roughness& request : requests) {
    rough.surfaces.push_back(select_surface(mesh, surface_options(request)));
    rough.plans.push_back(
        {request, mask_weights(mesh, rough.surfaces.back(), mask_options(request)), 0, {}});
  }
  for (const std::vector<std::size_t>& members : share_fields(requests)) {
    for (const std::size_t member : members) rough.plans[member].field = rough.fields.size();
    rough.fields.push_back(prepare_field(mesh, rough, members));
  }
  return rough;
}

Correlation correlation_of(const SurfacePlan& surface, std::span<const FieldPlan> fields) {
  return fields[surface.field].correlation.among(surface.field_point);
}

Index n_moving(const RoughSurfaces& rough, const Mesh& mesh, std::span<const Index> nodes) {
  std::vector<bool> moves(mesh.nodes.size(), false);
  for (std::size_t s = 0; s < rough.surfaces.size(); ++s)
    for (std::size_t i = 0; i < rough.surfaces[s].nodes.size(); ++i)
      if (rough.plans[s].weights[rough.surfaces[s].point_of_node[i]] > 0)
        moves[rough.surfaces[s].nodes[i]] = true;
  return static_cast<Index>(
      std::count_if(nodes.begin(), nodes.end(), [&](Index node) { return moves[node]; }));
}

std::vector<double> heights_of(const SurfacePlan& surface, const FieldPlan& field,
                               std::span<const double> samples) {
  std::vector<double> heights(surface.weights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = surface.weights[i] * surface.request.rms *
                 samples[field.sampled_at[surface.field_point[i]]];
  return heights;
}

}  // namespace roughmesh::detail
