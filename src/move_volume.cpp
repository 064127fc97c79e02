// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/move_volume.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "roughmesh/displace.hpp"

#include "curved_elements.hpp"
#include "disjoint_sets.hpp"
#include "harmonic.hpp"
#include "messages.hpp"
#include "plane.hpp"
#include "repair_volume.hpp"

namespace roughmesh {

struct VolumeMover::Plan {
  std::vector<Vec3> nodes;
  std::vector<Index> moved_nodes;  // of the surfaces
  std::vector<Index> free_nodes;
  std::vector<Index> unknown_of_free;  // of each free node
  /// Nodes of no surface that are images of one that moves: (node, number of its displacement).
  std::vector<std::array<Index, 2>> copies;
  std::vector<std::array<Index, 2>> images;  // free nodes that move as an earlier one: (node, it)
  // None without elements to deform.
  std::unique_ptr<const detail::HarmonicExtension> extension;
  std::unique_ptr<const detail::CurvedElements> curved;
  std::unique_ptr<const detail::VolumeRepair> repair;
  std::vector<Index> wall_nodes;
};

namespace {

using detail::NodeFlags;

std::span<const Index> corners_of(const ElementBlock& block, Index element) {
  return block.element(element).first(static_cast<std::size_t>(n_corners(block.type.shape)));
}

bool is_cell(const ElementBlock& block, int cell_dimension) {
  return dimension(block.type.shape) == cell_dimension;
}

// Corners of cells that are joined to a given node without crossing a wall. Beyond walls nothing
// moves, whatever elements there are.
NodeFlags reached_corners(const Mesh& mesh, int cell_dimension, const detail::NodeRoles& roles,
                          const Walls& walls) {
  const auto can_move = [&](Index node) { return roles.given[node] >= 0 || !walls.stays[node]; };
  detail::DisjointSets sets(mesh.nodes.size());
  for (std::size_t node = 0; node < walls.images.size(); ++node)
    sets.unite(static_cast<Index>(node), walls.images[node]);
  NodeFlags is_corner(mesh.nodes.size(), 0);
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; is_cell(block, cell_dimension) && e < block.size(); ++e) {
      Index first = -1;
      for (const Index node : corners_of(block, e)) {
        is_corner[node] = 1;
        if (!can_move(node)) continue;
        if (first >= 0) sets.unite(node, first);
        first = node;
      }
    }
  NodeFlags is_reached_set(mesh.nodes.size(), 0);
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (roles.given[node] >= 0) is_reached_set[sets.smallest(node)] = 1;
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    is_corner[node] = is_corner[node] && can_move(node) && is_reached_set[sets.smallest(node)];
  return is_corner;
}

detail::NodeRoles given_roles(const Mesh& mesh, std::span<const Index> moved_nodes) {
  detail::NodeRoles roles;
  roles.unknown.assign(mesh.nodes.size(), -1);
  roles.given.assign(mesh.nodes.size(), -1);
  for (const Index node : moved_nodes) roles.given[node] = roles.n_given++;
  return roles;
}

Index image(const Walls& walls, Index node) {
  return walls.images.empty() ? node : walls.images[node];
}

// Images of nodes whose displacement is given.
std::vector<std::array<Index, 2>> give_to_images(const Walls& walls, detail::NodeRoles& roles) {
  std::vector<std::array<Index, 2>> copies;
  std::vector<Index> given_of_image(walls.images.size(), -1);
  for (std::size_t node = 0; node < given_of_image.size(); ++node)
    if (roles.given[node] >= 0) given_of_image[walls.images[node]] = roles.given[node];
  for (std::size_t node = 0; node < given_of_image.size(); ++node) {
    const Index given = given_of_image[walls.images[node]];
    if (given < 0 || roles.given[node] >= 0 || walls.stays[node] != 0) continue;
    roles.given[node] = given;
    copies.push_back({static_cast<Index>(node), given});
  }
  return copies;
}

Eigen::Matrix3d free_projection(std::span<const SlidingNode> normals) {
  Eigen::Matrix3d free = Eigen::Matrix3d::Identity();
  for (const SlidingNode& each : normals) free -= each.normal * each.normal.transpose();
  return free;
}

// Nodes that move alike have one unknown, numbered with the first of them.
void add_unknowns(const NodeFlags& is_reached, const Walls& walls, const detail::NodeTies& ties,
                  detail::NodeRoles& roles) {
  std::vector<Index> unknown_of_image(is_reached.size(), -1);
  for (std::size_t i = 0; i < is_reached.size(); ++i) {
    if (!is_reached[i] || roles.given[i] >= 0) continue;
    const auto node = static_cast<Index>(i);
    Index& unknown = unknown_of_image[image(walls, node)];
    if (unknown < 0) {
      unknown = roles.n_unknown++;
      if (const auto normals = ties.of(node); !normals.empty())
        roles.sliding.push_back({unknown, free_projection(normals)});
    }
    roles.unknown[i] = unknown;
  }
}

void require_movable_elements(const Mesh& mesh, const detail::NodeRoles& roles) {
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.order <= 2) continue;
    for (Index e = 0; e < block.size(); ++e)
      for (const Index node : block.element(e))
        if (roles.unknown[node] >= 0 || roles.given[node] >= 0)
          detail::require_movable_order(block.type, block.tags[e]);
  }
}

NodeFlags free_flags(const detail::NodeRoles& roles) {
  NodeFlags is_free(roles.unknown.size());
  for (std::size_t node = 0; node < is_free.size(); ++node)
    is_free[node] = roles.unknown[node] >= 0;
  return is_free;
}

// Nodes of walls that slide, and nodes that move alike, do so as their edges do: an offset could
// lead off the plane, or be another on the other side.
detail::SettledNodes settled_nodes(const detail::NodeRoles& roles, const Walls& walls) {
  const std::size_t n = walls.stays.size();
  detail::SettledNodes known{walls.stays, NodeFlags(n, 0), walls.is_wall};
  for (std::size_t node = 0; node < walls.images.size(); ++node)
    if (walls.images[node] != static_cast<Index>(node))
      known.keeps_straight[node] = known.keeps_straight[walls.images[node]] = 1;
  for (std::size_t node = 0; node < n; ++node) {
    if (roles.given[node] >= 0) known.is_settled[node] = known.is_moved[node] = 1;
    if (known.is_settled[node] != 0) known.keeps_straight[node] = 0;
  }
  return known;
}

constexpr int most_splits = 2;

// Faces in space have no side on which they are inverted.
bool can_be_repaired(const Mesh& mesh, int cell_dimension) {
  return cell_dimension == dimension(mesh) &&
         (cell_dimension == 3 || detail::fit_plane(mesh).is_planar());
}

void check_surfaces(const Mesh& mesh, std::span<const Surface> surfaces) {
  if (surfaces.empty()) throw InputError("no surface to move; give one or more");
  for (const Surface& surface : surfaces) {
    if (surface.dimension != surfaces.front().dimension)
      throw InputError("rough curves and rough faces in one mesh; choose groups of one dimension");
    if (!surface.nodes.empty() && surface.nodes.back() >= mesh.n_nodes())
      throw InputError(
          fmt::format("a surface with node number {} in a mesh of {} nodes; give "
                      "surfaces of this mesh",
                      surface.nodes.back(), mesh.n_nodes()));
  }
}

void require_finite(std::span<const Vec3> displacements) {
  for (std::size_t i = 0; i < displacements.size(); ++i)
    if (!displacements[i].allFinite())
      throw InputError(
          fmt::format("the displacement of moved node {} is not finite; check the heights", i));
}

}  // namespace

std::string_view name(VolumeMethod method) {
  switch (method) {
    case VolumeMethod::harmonic:
      return "harmonic";
    case VolumeMethod::foldover_free:
      return "foldover-free";
    case VolumeMethod::split:
      return "split";
    case VolumeMethod::remesh:
      return "remesh";
    default:
      return "none";
  }
}

namespace {

std::vector<Vec3> added(std::span<const Vec3> nodes, std::vector<Vec3> shifts) {
  for (std::size_t node = 0; node < shifts.size(); ++node) shifts[node] += nodes[node];
  return shifts;
}

// What moves alike differs by round-off of several steps; then by that of one.
void equal_images(const VolumeMover::Plan& plan, std::vector<Vec3>& nodes) {
  for (const auto& [node, first] : plan.images)
    nodes[node] = plan.nodes[node] + (nodes[first] - plan.nodes[first]);
}

// Other nodes follow the corners, wherever these went.
MovedVolume move_interior(const VolumeMover::Plan& plan, std::span<const Vec3> displacements,
                          std::vector<Vec3> shifts) {
  const std::vector<Vec3> interior = plan.extension->extend(displacements);
  for (std::size_t i = 0; i < plan.free_nodes.size(); ++i)
    shifts[plan.free_nodes[i]] = interior[plan.unknown_of_free[i]];
  for (const auto& [node, given] : plan.copies) shifts[node] = displacements[given];
  MovedVolume result{added(plan.nodes, std::move(shifts)), VolumeMethod::harmonic, nullptr};
  if (plan.repair) {
    result = plan.repair->mend(std::move(result.nodes));
    if (result.method != VolumeMethod::harmonic) equal_images(plan, result.nodes);
  }
  plan.curved->place(result.nodes);
  return result;
}

}  // namespace

namespace {

Walls walls_that_stay(const Mesh& mesh, std::span<const Surface> surfaces) {
  check_surfaces(mesh, surfaces);
  return find_walls(mesh, surfaces, {.can_slide = false});
}

}  // namespace

VolumeMover::VolumeMover(const Mesh& mesh, std::span<const Surface> surfaces, VolumeMethod last)
    : VolumeMover(mesh, surfaces, walls_that_stay(mesh, surfaces), last) {}

VolumeMover::VolumeMover(const Mesh& mesh, std::span<const Surface> surfaces, const Walls& walls,
                         VolumeMethod last) {
  check_surfaces(mesh, surfaces);
  auto plan = std::make_unique<Plan>();
  plan->nodes = mesh.nodes;
  plan->moved_nodes = moved_nodes(surfaces);
  std::copy_if(plan->moved_nodes.begin(), plan->moved_nodes.end(),
               std::back_inserter(plan->wall_nodes),
               [&](Index node) { return walls.is_wall[node] != 0; });

  const int cell_dimension = surfaces.front().dimension + 1;
  const bool moves_interior = last != VolumeMethod::none && n_elements(mesh, cell_dimension) > 0;
  detail::NodeRoles roles = given_roles(mesh, plan->moved_nodes);
  const detail::NodeTies ties{walls.sliding, walls.images};
  if (moves_interior) {
    plan->copies = give_to_images(walls, roles);
    add_unknowns(reached_corners(mesh, cell_dimension, roles, walls), walls, ties, roles);
  }
  require_movable_elements(mesh, roles);
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    if (roles.unknown[node] < 0) continue;
    plan->free_nodes.push_back(node);
    plan->unknown_of_free.push_back(roles.unknown[node]);
    if (const Index first = image(walls, node); first != node)
      plan->images.push_back({node, first});
  }
  if (moves_interior) {
    NodeFlags is_free = free_flags(roles);
    plan->extension = std::make_unique<const detail::HarmonicExtension>(
        mesh.nodes, detail::deforming_simplices(mesh, cell_dimension, is_free), roles);
    const bool can_repair = last != VolumeMethod::harmonic && can_be_repaired(mesh, cell_dimension);
    if (can_repair)
      plan->repair = std::make_unique<const detail::VolumeRepair>(
          mesh, std::move(is_free), last == VolumeMethod::split ? most_splits : 0, ties);
    plan->curved = std::make_unique<const detail::CurvedElements>(
        mesh, cell_dimension, settled_nodes(roles, walls), can_repair);
  }
  plan_ = std::move(plan);
}

VolumeMover::~VolumeMover() = default;
VolumeMover::VolumeMover(VolumeMover&&) noexcept = default;
VolumeMover& VolumeMover::operator=(VolumeMover&&) noexcept = default;

bool VolumeMover::moves_interior() const { return plan_->extension != nullptr; }

const std::vector<Index>& VolumeMover::wall_nodes() const { return plan_->wall_nodes; }

MovedVolume VolumeMover::move(std::span<const Vec3> displacements) const {
  const Plan& plan = *plan_;
  if (displacements.size() != plan.moved_nodes.size())
    throw InputError(fmt::format("{} displacements for {} nodes that move; give one per node",
                                 displacements.size(), plan.moved_nodes.size()));
  require_finite(displacements);
  std::vector<Vec3> shifts(plan.nodes.size(), Vec3::Zero());
  for (std::size_t i = 0; i < displacements.size(); ++i)
    shifts[plan.moved_nodes[i]] = displacements[i];
  if (plan.extension) return move_interior(plan, displacements, std::move(shifts));
  return {added(plan.nodes, std::move(shifts)), VolumeMethod::none, nullptr};
}

}  // namespace roughmesh
