// SPDX-License-Identifier: BSD-3-Clause
#include "rough_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "roughmesh/field_model.hpp"

#include "all_points.hpp"
#include "edge_taper.hpp"
#include "messages.hpp"
#include "sectors.hpp"

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
  std::vector<Index> points(part.points.size());
  if (&part == &whole) {
    std::iota(points.begin(), points.end(), Index{0});
    return points;
  }
  std::vector<Index> of_node(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < whole.nodes.size(); ++i)
    of_node[whole.nodes[i]] = whole.point_of_node[i];
  for (std::size_t i = 0; i < part.nodes.size(); ++i)
    points[part.point_of_node[i]] = of_node[part.nodes[i]];
  return points;
}

bool is_periodic(DistanceKind kind) {
  return kind == DistanceKind::periodic || kind == DistanceKind::minimum_image;
}

/// What the roughness of a surface does at a point, apart from the field.
struct Effect {
  const Surface* surface = nullptr;
  Index point = 0;
  double factor = 0;  ///< weight times Rq

  const Vec3& place() const { return surface->points[point]; }
  Vec3 per_unit() const { return factor * surface->normals[point]; }
};

/// Effects at the points of a field, sorted by the class of periodic partners that they are in.
struct ClassedEffect {
  Index master;
  Effect effect;
};

std::vector<ClassedEffect> effects(const RoughSurfaces& rough, std::span<const std::size_t> members,
                                   const PeriodicPartners& partners) {
  std::vector<ClassedEffect> result;
  for (const std::size_t s : members) {
    const SurfacePlan& plan = rough.plans[s];
    for (Index i = 0; i < rough.surfaces[s].n_points(); ++i)
      result.push_back({partners.master[plan.field_point[i]],
                        {&rough.surfaces[s], i, plan.weights[i] * plan.request.rms}});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.master < b.master; });
  return result;
}

/// Calls visit(first, end) for the effects of each class of points that moves at all.
template <class Visit>
void for_each_moving_class(std::span<const ClassedEffect> effects, Visit&& visit) {
  for (auto first = effects.begin(); first != effects.end();) {
    const auto end = std::find_if(first, effects.end(), [&](const ClassedEffect& each) {
      return each.master != first->master;
    });
    if (std::any_of(first, end, [](const ClassedEffect& e) { return e.effect.factor > 0; }))
      visit(first, end);
    first = end;
  }
}

constexpr const char* end_there = "let the roughness end there with --fade WIDTH:GROUP or --fixed";

/// Links join nodes of a surface; unless the distance knows of them, or they stay, the two sides
/// would come apart.
void refuse_broken_links(std::span<const ClassedEffect> effects, const PeriodicPartners& partners,
                         DistanceKind distance) {
  std::vector<Index> n_points(partners.master.size(), 0);
  for (const Index master : partners.master) ++n_points[master];
  for_each_moving_class(effects, [&](auto first, auto) {
    const std::string at = place(first->effect.place());
    if (partners.rotated[first->master] != 0)
      throw InputError(
          fmt::format("the periodic link of the node at {} is no translation along an axis; {}", at,
                      end_there));
    if (partners.unpaired[first->master] != 0)
      throw InputError(
          fmt::format("a periodic link joins the node at {} to one that is not on this "
                      "surface; choose both sides as one surface, or {}",
                      at, end_there));
    if (n_points[first->master] > 1 && !is_periodic(distance))
      throw InputError(
          fmt::format("a periodic link joins the node at {} to another that moves; take --distance "
                      "periodic, or {}",
                      at, end_there));
  });
}

/// Images carry one height, so that masks, Rq and direction must be equal for them to stay images.
void refuse_unequal_images(std::span<const ClassedEffect> effects) {
  constexpr double round_off = 1e-9;
  for_each_moving_class(effects, [&](auto first, auto end) {
    const Effect& one = first->effect;
    for (auto other = first + 1; other != end; ++other) {
      const double difference = (other->effect.per_unit() - one.per_unit()).norm();
      if (difference > round_off * std::max(one.factor, other->effect.factor))
        throw InputError(fmt::format(
            "the roughness at {} and at its periodic image {} differ (masks, --rms or --flip); "
            "make them equal on both sides, for example by a fade or mask for each",
            place(one.place()), place(other->effect.place())));
    }
  });
}

PeriodicPartners partners_of(const Mesh& mesh, const Surface& surface, const Roughness& request) {
  if (request.period.empty()) return periodic_partners(mesh, surface);
  const std::vector<double>& p = request.period;
  return periodic_partners(mesh, surface, Vec3(p[0], p[1], p[2]));
}

/// Is any point of the surface linked to another node?
bool has_links(const PeriodicPartners& partners) {
  for (std::size_t i = 0; i < partners.master.size(); ++i)
    if (partners.master[i] != static_cast<Index>(i) || partners.unpaired[i] != 0) return true;
  return false;
}

/// Do linked points move, so that the field has to be periodic?
bool moves_images(std::span<const ClassedEffect> effects, const PeriodicPartners& partners) {
  std::vector<Index> n_points(partners.master.size(), 0);
  for (const Index master : partners.master) ++n_points[master];
  bool result = false;
  for_each_moving_class(effects, [&](auto first, auto) { result |= n_points[first->master] > 1; });
  return result;
}

void fill_in_distance(Roughness& request, const PeriodicPartners& linked, bool moves_images) {
  const bool has_period = !linked.period.isZero(0);
  if (!request.distance)
    request.distance =
        has_period && moves_images ? DistanceKind::periodic : DistanceKind::euclidean;
  if (!is_periodic(*request.distance)) return;
  if (!has_period)
    throw InputError(
        fmt::format("--distance: {}; needs --period LX,LY,LZ, since the mesh has no periodic links",
                    name(*request.distance)));
  request.period = {linked.period.x(), linked.period.y(), linked.period.z()};
}

/// Of the space that the places of a field fill: lines of a mesh in a plane z = const lie in a
/// space of two dimensions, unless axes of the lengths lead out of it.
int field_dimension(const Surface& surface, const Distance& distance) {
  const Eigen::Matrix3d& s = distance.stretch();
  const bool keeps_plane = s(2, 0) == 0 && s(2, 1) == 0;
  return surface.dimension == 1 && surface.plane_normal == Vec3::UnitZ() && keeps_plane ? 2 : 3;
}

/// Every point for itself.
PeriodicPartners no_partners(const Surface& surface) {
  PeriodicPartners partners;
  partners.master.resize(surface.points.size());
  std::iota(partners.master.begin(), partners.master.end(), Index{0});
  return partners;
}

/// Points that have images get the normal that they have in common, on their own side. `surface`
/// may be the whole itself.
void take_shared_normals(const Surface& whole, const PeriodicPartners& partners,
                         const SurfacePlan& plan, Surface& surface) {
  const Surface shared = with_partner_normals(whole, partners);
  for (Index i = 0; i < surface.n_points(); ++i) {
    const Index point = plan.field_point[i];
    const Vec3& own = whole.normals[point];
    const Vec3& common = shared.normals[point];
    if (own == common) continue;
    surface.normals[i] = surface.normals[i].dot(own) < 0 ? Vec3(-common) : common;
  }
}

FieldPlan field_plan(const Roughness& request, const Surface& whole, PeriodicPartners partners) {
  Correlation correlation = field_model(request, whole);
  const int dimension = field_dimension(whole, correlation.distance());
  return {std::move(correlation), std::move(partners), dimension};
}

FieldPlan prepare_field(const Mesh& mesh, RoughSurfaces& rough,
                        std::span<const std::size_t> members, TornLinks torn_links) {
  const std::size_t first = members.front();
  const Surface several = members.size() > 1 ? joined(mesh, rough.plans, members) : Surface();
  const Surface& whole = members.size() > 1 ? several : rough.surfaces[first];
  for (const std::size_t s : members)
    rough.plans[s].field_point = points_in(mesh, rough.surfaces[s], whole);

  const PeriodicPartners linked = partners_of(mesh, whole, rough.plans[first].request);
  const bool is_linked = has_links(linked);
  const bool images_move = is_linked && moves_images(effects(rough, members, linked), linked);
  for (const std::size_t s : members) fill_in_distance(rough.plans[s].request, linked, images_move);
  const Roughness& request = rough.plans[first].request;
  if (!is_periodic(*request.distance)) {
    if (is_linked && torn_links == TornLinks::refused)
      refuse_broken_links(effects(rough, members, linked), linked, *request.distance);
    return field_plan(request, whole, no_partners(whole));
  }
  // By links and positions: a file need not list all of its links, and a report names the period.
  PeriodicPartners partners = partners_of(mesh, whole, request);
  for (const std::size_t s : members)
    take_shared_normals(whole, partners, rough.plans[s], rough.surfaces[s]);
  if (torn_links == TornLinks::refused) {
    const std::vector<ClassedEffect> classed = effects(rough, members, partners);
    refuse_broken_links(classed, partners, *request.distance);
    refuse_unequal_images(classed);
  }
  return field_plan(request, whole, std::move(partners));
}

SurfacePlan plan_surface(const Mesh& mesh, const Surface& surface, const Roughness& request) {
  SurfacePlan plan;
  plan.request = request;
  plan.weights = mask_weights(mesh, surface, mask_options(request));
  plan.free = request.fixed.empty() ? std::vector<double>(plan.weights.size(), 1.0)
                                    : mask_weights(mesh, surface, {.fixed = request.fixed});
  return plan;
}

EdgeOptions edge_options(const Roughness& request, std::vector<double> weights) {
  return {.rule = request.edges,
          .sharp_angle = surface_options(request).sharp_angle,
          .weights = std::move(weights),
          .images = {}};
}

void hold_sharp_points(const Surface& surface, SurfacePlan& plan) {
  const std::vector<std::uint8_t> sharp =
      sharp_points(surface, surface_options(plan.request).sharp_angle);
  for (std::size_t i = 0; i < sharp.size(); ++i)
    if (sharp[i] != 0) plan.weights[i] = plan.free[i] = 0;
}

/// Area-weighted mean square of the weights.
double mean_square(const Surface& surface, std::span<const double> weights) {
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    sum += surface.areas[i] * weights[i] * weights[i];
  return sum / surface.area;
}

void apply_taper(const Surface& surface, std::span<const double> factors, const AcuteEdge& sharpest,
                 SurfacePlan& plan) {
  const double before = mean_square(surface, plan.weights);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    plan.taper.n_points += factors[i] < 1 && plan.weights[i] > 0;
    plan.weights[i] *= factors[i];
  }
  const double after = mean_square(surface, plan.weights);
  plan.taper.sq_share = before > 0 ? std::sqrt(after / before) : 1;
  plan.taper.angle = sharpest.angle;
  plan.taper.place = sharpest.place;
  if (after == 0 && before > 0)
    throw InputError(fmt::format(
        "the edge at {} has an angle of {:.3g} degrees, beside which no height fits into the wall; "
        "lower --rms, round the edge, or choose --edges average",
        place(sharpest.place), sharpest.angle * 180 / std::numbers::pi));
}

/// Weights that the edge rules of the surfaces ask for.
void apply_edge_rules(RoughSurfaces& rough) {
  std::vector<EdgeOptions> options;
  std::vector<double> rms;
  for (std::size_t s = 0; s < rough.plans.size(); ++s) {
    SurfacePlan& plan = rough.plans[s];
    if (plan.request.edges == EdgeRule::fix) hold_sharp_points(rough.surfaces[s], plan);
    options.push_back(edge_options(plan.request, {}));
    rms.push_back(plan.request.rms);
  }
  const EdgeTaper taper = taper_acute_edges(rough.surfaces, options, rms);
  for (std::size_t s = 0; s < rough.plans.size(); ++s)
    if (!taper.factors[s].empty())
      apply_taper(rough.surfaces[s], taper.factors[s], taper.sharpest[s], rough.plans[s]);
}

/// Values of the points of a field at those of a surface: mostly the same ones.
std::vector<double> at_points(std::vector<double> values, std::span<const Index> points) {
  if (is_all(points, static_cast<Index>(values.size()))) return values;
  std::vector<double> result;
  result.reserve(points.size());
  for (const Index point : points) result.push_back(values[point]);
  return result;
}

}  // namespace

RoughSurfaces prepare_surfaces(const Mesh& mesh, std::span<const Roughness> requests) {
  RoughSurfaces rough;
  for (const Roughness& request : requests) {
    rough.surfaces.push_back(select_surface(mesh, surface_options(request)));
    rough.plans.push_back(plan_surface(mesh, rough.surfaces.back(), request));
  }
  apply_edge_rules(rough);
  for (const std::vector<std::size_t>& members : share_fields(requests)) {
    for (const std::size_t member : members) rough.plans[member].field = rough.fields.size();
    rough.fields.push_back(prepare_field(mesh, rough, members, TornLinks::refused));
  }
  return rough;
}

RoughSurfaces prepare_surface(const Mesh& mesh, const Surface& surface, const Roughness& request,
                              TornLinks torn_links) {
  RoughSurfaces rough{{surface}, {plan_surface(mesh, surface, request)}, {}};
  apply_edge_rules(rough);
  rough.fields.push_back(prepare_field(mesh, rough, std::array<std::size_t, 1>{}, torn_links));
  return rough;
}

Correlation correlation_of(const SurfacePlan& surface, std::span<const FieldPlan> fields) {
  return fields[surface.field].correlation.among(surface.field_point);
}

std::vector<std::uint8_t> moving_nodes(const RoughSurfaces& rough, const Mesh& mesh) {
  std::vector<std::uint8_t> moves(mesh.nodes.size(), 0);
  for (std::size_t s = 0; s < rough.surfaces.size(); ++s)
    for (std::size_t i = 0; i < rough.surfaces[s].nodes.size(); ++i)
      if (rough.plans[s].weights[rough.surfaces[s].point_of_node[i]] > 0)
        moves[rough.surfaces[s].nodes[i]] = 1;
  for (const Index node : fixed_nodes(rough, mesh)) moves[node] = 0;
  return moves;
}

std::optional<Vec3> period_of(const RoughSurfaces& rough) {
  std::optional<Vec3> period;
  for (const SurfacePlan& plan : rough.plans) {
    const std::vector<double>& p = plan.request.period;
    if (!plan.request.distance || !is_periodic(*plan.request.distance) || p.size() != 3) continue;
    if (!period) period = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      double& known = (*period)[axis];
      const double given = p[static_cast<std::size_t>(axis)];
      if (known > 0 && given > 0 && known != given)
        throw InputError(
            fmt::format("--period: {:g} and {:g} along one axis; a mesh has one period along each",
                        known, given));
      known = std::max(known, given);
    }
  }
  return period;
}

std::vector<double> heights_of(const SurfacePlan& surface, std::vector<double> field_heights) {
  std::vector<double> heights = at_points(std::move(field_heights), surface.field_point);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] *= surface.weights[i] * surface.request.rms;
  return heights;
}

std::vector<EdgeOptions> edge_options(const RoughSurfaces& rough) {
  std::vector<EdgeOptions> options;
  std::vector<Index> first(1, 0);  // number of the first class of points of each field
  for (const FieldPlan& field : rough.fields)
    first.push_back(first.back() + static_cast<Index>(field.partners.master.size()));
  for (const SurfacePlan& plan : rough.plans) {
    options.push_back(edge_options(plan.request, plan.weights));
    if (!plan.request.distance || !is_periodic(*plan.request.distance)) continue;
    const PeriodicPartners& partners = rough.fields[plan.field].partners;
    for (const Index point : plan.field_point)
      options.back().images.push_back(first[plan.field] + partners.master[point]);
  }
  return options;
}

std::vector<Index> fixed_nodes(const RoughSurfaces& rough, const Mesh& mesh) {
  std::vector<bool> is_fixed(mesh.nodes.size(), false);
  for (std::size_t s = 0; s < rough.surfaces.size(); ++s)
    for (std::size_t i = 0; i < rough.surfaces[s].nodes.size(); ++i)
      if (rough.plans[s].free[rough.surfaces[s].point_of_node[i]] == 0)
        is_fixed[rough.surfaces[s].nodes[i]] = true;
  std::vector<Index> nodes;
  for (std::size_t node = 0; node < is_fixed.size(); ++node)
    if (is_fixed[node]) nodes.push_back(static_cast<Index>(node));
  return nodes;
}

}  // namespace roughmesh::detail
