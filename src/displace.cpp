// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/displace.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "edge_motion.hpp"
#include "unfolding.hpp"

namespace roughmesh {
namespace {

void require_size(const Surface& surface, std::size_t n, const char* what) {
  if (n != surface.points.size())
    throw InputError(fmt::format("{} {} for a surface of {} points; give one per point", n, what,
                                 surface.points.size()));
}

void require_one_each(std::span<const Surface> surfaces, std::size_t n, const char* what) {
  if (n != surfaces.size())
    throw InputError(fmt::format("{} of {} surfaces for {}; give one for each surface", what, n,
                                 surfaces.size()));
}

void check_options(std::span<const Surface> surfaces, std::span<const EdgeOptions> options) {
  if (surfaces.empty()) throw InputError("no rough surface; choose at least one");
  require_one_each(surfaces, options.size(), "edge options");
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const EdgeOptions& each = options[s];
    if (!each.weights.empty()) require_size(surfaces[s], each.weights.size(), "weights");
    if (!each.images.empty()) require_size(surfaces[s], each.images.size(), "numbers of images");
  }
}

// Share of a height that is round-off.
constexpr double round_off = 1e-12;

// Some normal has a part across a plane in which its node slides.
bool leads_off(const Surface& surface, std::span<const SlidingNode> sliding) {
  return std::any_of(sliding.begin(), sliding.end(), [&](const SlidingNode& each) {
    const auto at = std::lower_bound(surface.nodes.begin(), surface.nodes.end(), each.node);
    if (at == surface.nodes.end() || *at != each.node) return true;  // told of by EdgeMotion
    const auto i = static_cast<std::size_t>(at - surface.nodes.begin());
    const Vec3& normal = surface.normals[surface.point_of_node[i]];
    return std::abs(normal.dot(each.normal.normalized())) > round_off;
  });
}

// Every node moves along the normal of its point.
bool has_no_edges(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                  const NodeConstraints& constraints) {
  const Surface& surface = surfaces.front();
  if (surfaces.size() > 1 || leads_off(surface, constraints.sliding)) return false;
  const bool is_smooth = surface.n_sharp_edges == 0 && surface.n_nonmanifold_edges == 0;
  return options.front().rule == EdgeRule::average || is_smooth;
}

void require_of_surfaces(const NodeConstraints& constraints, std::span<const Index> nodes) {
  const auto require = [&](Index node) {
    if (!std::binary_search(nodes.begin(), nodes.end(), node))
      throw InputError(fmt::format(
          "node number {} has a constraint but is on no rough surface; leave it out", node));
  };
  for (const Index node : constraints.fixed) require(node);
  for (const Index node : constraints.anchored) require(node);
  for (const SlidingNode& each : constraints.sliding) require(each.node);
}

/// @param nodes  ascending
std::vector<Index> points_of(const Surface& surface, std::span<const Index> nodes) {
  std::vector<Index> points;
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    if (std::binary_search(nodes.begin(), nodes.end(), surface.nodes[i]))
      points.push_back(surface.point_of_node[i]);
  return points;
}

detail::FaceView faces_of(const Surface& surface) {
  return {surface.dimension, surface.face_offsets, surface.face_points};
}

}  // namespace

std::string_view name(EdgeRule rule) {
  switch (rule) {
    case EdgeRule::offset:
      return "offset";
    case EdgeRule::average:
      return "average";
    case EdgeRule::fix:
      break;
  }
  return "fix";
}

std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights) {
  require_size(surface, heights.size(), "heights");
  std::vector<Vec3> displacements(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    displacements[i] = heights[i] * surface.normals[i];
  return displacements;
}

std::vector<Index> moved_nodes(std::span<const Surface> surfaces) {
  if (surfaces.size() == 1) return surfaces.front().nodes;
  std::vector<Index> nodes;
  for (const Surface& surface : surfaces)
    nodes.insert(nodes.end(), surface.nodes.begin(), surface.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

struct SurfaceMover::Plan {
  std::span<const Surface> surfaces;
  std::vector<EdgeOptions> options;
  NodeConstraints constraints;
  std::vector<Index> nodes, fixed_points = {};
  bool has_edges = false;

  // Where there are no edges only faces that would fold need it.
  const detail::EdgeMotion& edges() const {
    std::call_once(once, [&] {
      made = std::make_unique<const detail::EdgeMotion>(surfaces, options, constraints, nodes);
    });
    return *made;
  }

  mutable std::once_flag once = {};
  mutable std::unique_ptr<const detail::EdgeMotion> made = nullptr;
};

SurfaceMover::SurfaceMover(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                           const NodeConstraints& constraints) {
  check_options(surfaces, options);
  auto plan = std::make_unique<Plan>();
  plan->surfaces = surfaces;
  plan->options.assign(options.begin(), options.end());
  plan->constraints = constraints;
  plan->nodes = moved_nodes(surfaces);
  require_of_surfaces(constraints, plan->nodes);
  plan->has_edges = !has_no_edges(surfaces, options, constraints);
  if (plan->has_edges)
    plan->edges();
  else
    plan->fixed_points = points_of(surfaces.front(), constraints.fixed);
  plan_ = std::move(plan);
}

SurfaceMover::~SurfaceMover() = default;
SurfaceMover::SurfaceMover(SurfaceMover&&) noexcept = default;
SurfaceMover& SurfaceMover::operator=(SurfaceMover&&) noexcept = default;

const std::vector<Index>& SurfaceMover::nodes() const { return plan_->nodes; }

MovedSurface SurfaceMover::move(std::span<const std::vector<double>> heights) const {
  const auto& surfaces = plan_->surfaces;
  require_one_each(surfaces, heights.size(), "heights");
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    require_size(surfaces[s], heights[s].size(), "heights");
  if (plan_->has_edges) return plan_->edges().move(heights);
  const Surface& surface = surfaces.front();
  std::vector<Vec3> at_points = displace(surface, heights.front());
  for (const Index point : plan_->fixed_points) at_points[point] = Vec3::Zero();
  if (surface.dimension == 2 && plan_->options.front().rule == EdgeRule::offset &&
      detail::has_turned_face(faces_of(surface), surface.points, at_points))
    return plan_->edges().unfolded(at_points);
  MovedSurface moved;
  moved.displacements.reserve(plan_->nodes.size());
  for (const Index point : surface.point_of_node) moved.displacements.push_back(at_points[point]);
  return moved;
}

std::vector<Vec3> displace_nodes(std::span<const Surface> surfaces,
                                 std::span<const std::vector<double>> heights,
                                 std::span<const EdgeOptions> options) {
  require_one_each(surfaces, heights.size(), "heights");
  std::vector<EdgeOptions> masked(options.begin(), options.end());
  if (masked.empty()) masked.resize(surfaces.size());
  require_one_each(surfaces, masked.size(), "edge options");
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    masked[s].weights = heights[s];
    for (double& weight : masked[s].weights) weight = weight != 0 ? 1 : 0;
  }
  return SurfaceMover(surfaces, masked).move(heights).displacements;
}

}  // namespace roughmesh
