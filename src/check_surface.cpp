// SPDX-License-Identifier: BSD-3-Clause
// Of check.hpp, what concerns surfaces alone.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "roughmesh/check.hpp"

#include "messages.hpp"
#include "opposite_sheet.hpp"
#include "parallel.hpp"
#include "surface_motion.hpp"

namespace roughmesh {

struct SurfaceChecker::Plan {
  detail::FacesAtRest rest;
  std::vector<Tag> node_tags;                        // of the mesh
  std::vector<std::uint8_t> is_rough;                // per point of the faces
  std::vector<Index> point_of_node;                  // of the mesh; -1 where no face has the node
  std::unique_ptr<const detail::TriangleTree> tree;  // of the input
};

namespace {

using detail::CheckedFaces;
using detail::SurfaceMotion;

// The axis along which a plane is seen largest.
int axis_of(const Vec3& plane_normal) {
  Eigen::Index axis = 2;
  if (plane_normal.norm() > 0) plane_normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(axis);
}

void require_positions(const SurfaceChecker::Plan& plan, std::span<const Vec3> moved) {
  if (moved.size() != plan.node_tags.size())
    throw InputError(fmt::format("{} positions for a mesh of {} nodes; give one per node",
                                 moved.size(), plan.node_tags.size()));
  const CheckedFaces& faces = plan.rest.faces;
  for (std::size_t i = 0; i < faces.nodes.size(); ++i)
    if (!moved[faces.nodes[i]].allFinite())
      throw NumericalError(
          fmt::format("node {} moved from {} to a position that is not finite; lower the heights",
                      plan.node_tags[faces.nodes[i]], detail::place(faces.before[i])));
}

std::string describe(const CheckedFaces& faces, Index face) {
  const detail::FaceSource& source = faces.sources[face];
  if (source.is_side) return fmt::format("a side of element {}", source.element);
  return fmt::format("{} {}", name(ElementType{source.shape}), source.element);
}

std::string describe(const CheckedFaces& faces, const detail::Defect& defect) {
  const std::string first = describe(faces, defect.a), second = describe(faces, defect.b);
  switch (defect.kind) {
    case SurfaceDefect::intersection:
      // Facets of one element of order 2.
      return first == second ? fmt::format("{} intersects itself", first)
                             : fmt::format("{} intersects {}", first, second);
    case SurfaceDefect::folded:
      return fmt::format("{} is folded over", first);
    case SurfaceDefect::collapsed:
      return fmt::format("{} has collapsed", first);
    default:
      return fmt::format("{} has passed {}, on the other side of a thin wall or gap", first,
                         second);
  }
}

Vec3 middle(const SurfaceMotion& motion, Index face) {
  Vec3 sum = Vec3::Zero();
  const auto points = motion.rest.faces.face(face);
  for (const Index point : points) sum += motion.after[point];
  return sum / static_cast<double>(points.size());
}

SurfaceFinding make_finding(const SurfaceMotion& motion, const detail::Defect& defect) {
  SurfaceFinding finding{defect.kind,
                         describe(motion.rest.faces, defect),
                         defect.elements,
                         (middle(motion, defect.a) + middle(motion, defect.b)) / 2,
                         0,
                         defect.passing_share};
  for (const Index face : {defect.a, defect.b})
    for (const Index point : motion.rest.faces.face(face))
      finding.height = std::max(finding.height, motion.displacement(point).norm());
  return finding;
}

// Which side of a point a wall is on, and what it takes to close it.
std::optional<ThinWall> wall_at(const SurfaceChecker::Plan& plan, Index point, const Vec3& normal,
                                bool is_gap, double height) {
  const CheckedFaces& faces = plan.rest.faces;
  const auto hit = detail::opposite_sheet(faces, *plan.tree, point, is_gap ? normal : Vec3(-normal),
                                          2 * height, plan.rest.plane_normal);
  if (!hit) return std::nullopt;
  const detail::Facet& facet = faces.facets[hit->facet];
  const bool are_both_rough =
      std::all_of(facet.begin(), facet.end(), [&](Index p) { return plan.is_rough[p]; });
  const double share = hit->distance / (height * (are_both_rough ? 2 : 1));
  if (!(share < 1)) return std::nullopt;
  return ThinWall{faces.before[point], hit->distance, is_gap,
                  faces.sources[faces.face_of_facet[hit->facet]].element, share};
}

void keep_thinner(std::optional<ThinWall>& thinnest, const std::optional<ThinWall>& other) {
  if (other && (!thinnest || other->passing_share < thinnest->passing_share)) thinnest = other;
}

}  // namespace

SurfaceChecker::SurfaceChecker(const Mesh& mesh, std::span<const Surface> surfaces,
                               std::span<const std::uint8_t> left_out) {
  if (surfaces.empty()) throw InputError("no surface to check; give one or more");
  auto plan = std::make_unique<Plan>();
  const Surface& first = surfaces.front();
  plan->rest = {detail::collect_faces(mesh, first.dimension, left_out), first.plane_normal,
                axis_of(first.plane_normal)};
  plan->node_tags = mesh.node_tags;
  const CheckedFaces& faces = plan->rest.faces;
  plan->point_of_node.assign(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < faces.nodes.size(); ++i)
    plan->point_of_node[faces.nodes[i]] = static_cast<Index>(i);
  plan->is_rough.assign(faces.nodes.size(), 0);
  for (const Surface& surface : surfaces)
    for (const Index node : surface.nodes) plan->is_rough[plan->point_of_node[node]] = 1;
  plan->tree =
      std::make_unique<const detail::TriangleTree>(faces.facets, faces.before, plan->is_rough);
  plan_ = std::move(plan);
}

SurfaceChecker::~SurfaceChecker() = default;
SurfaceChecker::SurfaceChecker(SurfaceChecker&&) noexcept = default;
SurfaceChecker& SurfaceChecker::operator=(SurfaceChecker&&) noexcept = default;

SurfaceCheck SurfaceChecker::check(std::span<const Vec3> moved) const {
  require_positions(*plan_, moved);
  const SurfaceMotion motion = detail::move_faces(plan_->rest, moved);
  const detail::FoundPairs found =
      detail::find_intersections(plan_->rest.in_place(), motion.in_place(), motion.has_moved);
  detail::DefectTally tally = detail::new_intersections(motion, found.pairs);
  tally.add(detail::turned_faces(motion));
  tally.add(detail::closed_walls(motion, *plan_->tree));

  SurfaceCheck check;
  check.self_intersections = tally.count(SurfaceDefect::intersection);
  check.input_intersections = static_cast<std::int64_t>(found.in_input.size());
  check.folded_faces = tally.count(SurfaceDefect::folded);
  check.collapsed_faces = tally.count(SurfaceDefect::collapsed);
  check.closed_walls = tally.count(SurfaceDefect::closed_wall);
  check.is_complete = found.is_complete;
  for (const detail::Defect& defect : tally.worst())
    check.findings.push_back(make_finding(motion, defect));
  return check;
}

std::optional<ThinWall> SurfaceChecker::thinnest_wall(const Surface& surface, double height) const {
  constexpr std::size_t grain = 1024;
  const std::size_t step = 1 + surface.nodes.size() / detail::most_sampled_points;
  const std::size_t n = (surface.nodes.size() + step - 1) / step;
  std::vector<std::optional<ThinWall>> parts((n + grain - 1) / grain);
  detail::parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const bool is_gap : {false, true})
        keep_thinner(parts[begin / grain],
                     wall_at(*plan_, plan_->point_of_node[surface.nodes[step * i]],
                             surface.normals[surface.point_of_node[step * i]], is_gap, height));
  });
  std::optional<ThinWall> thinnest;
  for (const auto& part : parts) keep_thinner(thinnest, part);
  return thinnest;
}

SurfaceCheck check_surface(const Mesh& mesh, std::span<const Surface> surfaces,
                           std::span<const Vec3> moved) {
  return SurfaceChecker(mesh, surfaces).check(moved);
}

}  // namespace roughmesh
