// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/move_volume.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "corners.hpp"
#include "harmonic.hpp"
#include "messages.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"

namespace roughmesh {

struct VolumeMover::Plan {
  std::vector<Vec3> nodes;
  std::vector<Index> surface_nodes;
  std::vector<Index> point_of_node;  // of surface_nodes
  std::size_t n_points = 0;
  std::vector<Index> free_nodes;
  std::unique_ptr<const detail::HarmonicExtension> extension;  // none without volume elements
  Index n_wall_nodes = 0;
};

namespace {

using NodeFlags = std::vector<std::uint8_t>;

bool is_volume(const ElementBlock& block) { return dimension(block.type.shape) == 3; }

bool is_face(const ElementBlock& block) { return dimension(block.type.shape) == 2; }

// Marks the nodes of faces that are not part of the surface: they belong to walls, which stay.
class WallMarker {
 public:
  WallMarker(const Mesh& mesh, const Surface& surface, std::span<const Index> point_of_node)
      : lookup_(surface.face_offsets, surface.face_points),
        point_of_node_(point_of_node),
        on_wall_(mesh.nodes.size(), 0) {}

  void add(std::span<const Index> corners, std::span<const Index> nodes) {
    if (is_selected(corners)) return;
    for (const Index node : nodes) on_wall_[node] = 1;
  }
  NodeFlags take() { return std::move(on_wall_); }

 private:
  bool is_selected(std::span<const Index> corners) const {
    std::array<Index, 4> points{};
    for (std::size_t k = 0; k < corners.size(); ++k) points[k] = point_of_node_[corners[k]];
    return lookup_.find({points.data(), corners.size()}) >= 0;
  }

  detail::FaceLookup lookup_;
  std::span<const Index> point_of_node_;
  NodeFlags on_wall_;
};

NodeFlags wall_nodes(const Mesh& mesh, const Surface& surface,
                     std::span<const Index> point_of_node) {
  WallMarker walls(mesh, surface, point_of_node);
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_face(block)) continue;
    const auto n = static_cast<std::size_t>(n_corners(block.type.shape));
    for (Index e = 0; e < block.size(); ++e) walls.add(block.element(e).first(n), block.element(e));
  }
  for (const detail::VolumeFace& face : detail::boundary_faces(mesh))
    walls.add(face.corners(), face.corners());
  return walls.take();
}

detail::NodeRoles make_roles(const Mesh& mesh, const Surface& surface,
                             std::vector<Index> point_of_node, const NodeFlags& on_wall,
                             bool moves_interior) {
  NodeFlags in_volume(mesh.nodes.size(), 0);
  for (const ElementBlock& block : mesh.blocks)
    if (moves_interior && is_volume(block))
      for (const Index node : block.nodes) in_volume[node] = 1;
  detail::NodeRoles roles;
  roles.unknown.assign(mesh.nodes.size(), -1);
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (in_volume[node] && !on_wall[node] && point_of_node[node] < 0)
      roles.unknown[node] = roles.n_unknown++;
  roles.given = std::move(point_of_node);
  roles.n_given = surface.n_points();
  return roles;
}

void require_linear_elements(const Mesh& mesh, const detail::NodeRoles& roles) {
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.order == 1) continue;
    for (Index e = 0; e < block.size(); ++e)
      for (const Index node : block.element(e))
        if (roles.unknown[node] >= 0 || roles.given[node] >= 0)
          detail::require_first_order(block.type, block.tags[e]);
  }
}

// A tetrahedron stands for itself, every other shape for its corner tetrahedra.
std::vector<detail::Tetrahedron> deforming_tetrahedra(const Mesh& mesh,
                                                      const detail::NodeRoles& roles) {
  std::vector<detail::Tetrahedron> tetrahedra;
  for (const ElementBlock& block : mesh.blocks) {
    auto corners = detail::corner_tetrahedra(block.type.shape);
    if (block.type.shape == ElementShape::tetrahedron) corners = corners.first(1);
    for (Index e = 0; e < block.size(); ++e) {
      const auto nodes = block.element(e);
      for (const auto& [a, b, c, d] : corners) {
        const detail::Tetrahedron t = {nodes[a], nodes[b], nodes[c], nodes[d]};
        if (std::any_of(t.begin(), t.end(), [&](Index node) { return roles.unknown[node] >= 0; }))
          tetrahedra.push_back(t);
      }
    }
  }
  return tetrahedra;
}

void require_finite(std::span<const Vec3> displacements) {
  for (std::size_t i = 0; i < displacements.size(); ++i)
    if (!displacements[i].allFinite())
      throw InputError(
          fmt::format("the displacement of surface point {} is not finite; check the heights", i));
}

}  // namespace

std::string_view name(VolumeMethod method) {
  return method == VolumeMethod::harmonic ? "harmonic" : "none";
}

VolumeMover::VolumeMover(const Mesh& mesh, const Surface& surface, VolumeMethod method) {
  auto plan = std::make_unique<Plan>();
  plan->nodes = mesh.nodes;
  plan->surface_nodes = surface.nodes;
  plan->point_of_node = surface.point_of_node;
  plan->n_points = surface.points.size();

  std::vector<Index> point_of_node(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    point_of_node[surface.nodes[i]] = surface.point_of_node[i];
  const NodeFlags on_wall = wall_nodes(mesh, surface, point_of_node);
  for (const Index node : surface.nodes) plan->n_wall_nodes += on_wall[node];

  const bool moves_interior = method == VolumeMethod::harmonic && n_elements(mesh, 3) > 0;
  const detail::NodeRoles roles =
      make_roles(mesh, surface, std::move(point_of_node), on_wall, moves_interior);
  require_linear_elements(mesh, roles);
  for (Index node = 0; node < mesh.n_nodes(); ++node)
    if (roles.unknown[node] >= 0) plan->free_nodes.push_back(node);
  if (moves_interior)
    plan->extension = std::make_unique<const detail::HarmonicExtension>(
        mesh.nodes, deforming_tetrahedra(mesh, roles), roles);
  plan_ = std::move(plan);
}

VolumeMover::~VolumeMover() = default;
VolumeMover::VolumeMover(VolumeMover&&) noexcept = default;
VolumeMover& VolumeMover::operator=(VolumeMover&&) noexcept = default;

VolumeMethod VolumeMover::method() const {
  return plan_->extension ? VolumeMethod::harmonic : VolumeMethod::none;
}

Index VolumeMover::n_wall_nodes() const { return plan_->n_wall_nodes; }

std::vector<Vec3> VolumeMover::move(std::span<const Vec3> displacements) const {
  if (displacements.size() != plan_->n_points)
    throw InputError(fmt::format("{} displacements for a surface of {} points; give one per point",
                                 displacements.size(), plan_->n_points));
  require_finite(displacements);
  std::vector<Vec3> moved = plan_->nodes;
  for (std::size_t i = 0; i < plan_->surface_nodes.size(); ++i)
    moved[plan_->surface_nodes[i]] += displacements[plan_->point_of_node[i]];
  if (!plan_->extension) return moved;
  const std::vector<Vec3> interior = plan_->extension->extend(displacements);
  for (std::size_t i = 0; i < interior.size(); ++i) moved[plan_->free_nodes[i]] += interior[i];
  return moved;
}

}  // namespace roughmesh
