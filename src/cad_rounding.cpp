// SPDX-License-Identifier: BSD-3-Clause
#include "cad_rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/surface.hpp"

#include "surface_edges.hpp"

namespace roughmesh::detail {
namespace {

/// How far rounding may be from the change of first order: corners and curved edges, whose share is
/// at most this while fillets do not meet.
constexpr double share_of_corners = 0.5;

/// The entity of each edge of the surface that is a line element.
using CurveOfEdge = std::map<std::array<Index, 2>, Tag>;

CurveOfEdge curves(const Mesh& mesh, const Surface& surface) {
  const auto point = [&](Index node) {
    const auto at = std::lower_bound(surface.nodes.begin(), surface.nodes.end(), node);
    return at != surface.nodes.end() && *at == node
               ? surface.point_of_node[static_cast<std::size_t>(at - surface.nodes.begin())]
               : Index{-1};
  };
  CurveOfEdge result;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; block.type.shape == ElementShape::line && e < block.size(); ++e) {
      std::array<Index, 2> edge = {point(block.element(e).front()), point(block.element(e).back())};
      std::sort(edge.begin(), edge.end());
      result.try_emplace(edge, block.entity);
    }
  return result;
}

Vec3 area_vector_of(const Surface& surface, Index face) {
  std::vector<Vec3> corners;
  for (const Index point : surface.face(face)) corners.push_back(surface.points[point]);
  return area_vector(corners);
}

Vec3 middle(const Surface& surface, Index face) {
  Vec3 sum = Vec3::Zero();
  for (const Index point : surface.face(face)) sum += surface.points[point];
  return sum / static_cast<double>(surface.face(face).size());
}

/// Angle by which the outward normal turns from face to face, negative at a concave edge.
double turn(const Surface& surface, Index a, Index b) {
  const Vec3 normal_a = area_vector_of(surface, a), normal_b = area_vector_of(surface, b);
  const double angle = std::atan2(normal_a.cross(normal_b).norm(), normal_a.dot(normal_b));
  const bool is_convex = (middle(surface, b) - middle(surface, a)).dot(normal_a) < 0;
  return is_convex ? angle : -angle;
}

void require_simple(const Surface& surface) {
  if (surface.n_border_edges == 0 && surface.n_nonmanifold_edges == 0 &&
      surface.n_duplicate_faces == 0)
    return;
  throw InputError(fmt::format(
      "--round: {} edges of the CAD file are not between two faces of one solid; give solids that "
      "are closed and do not touch each other",
      surface.n_border_edges + surface.n_nonmanifold_edges + 3 * surface.n_duplicate_faces));
}

}  // namespace

Rounding plan_rounding(const Mesh& mesh, double radius, double angle) {
  const Surface surface = select_surface(mesh, {.groups = {"all"}, .sharp_angle = angle});
  require_simple(surface);
  const CurveOfEdge curve_of = curves(mesh, surface);
  const EdgeTable edges =
      make_edges({2, surface.face_offsets, surface.face_points}, surface.n_points());
  std::vector<double> turned;
  std::set<Tag> sharp;
  for (Index e = 0; e < edges.size(); ++e) {
    turned.push_back(turn(surface, edges.edge(e)[0].face, edges.edge(e)[1].face));
    const auto curve = curve_of.find(edges.points[e]);
    if (curve != curve_of.end() && std::abs(turned.back()) > angle) sharp.insert(curve->second);
  }
  Rounding result{.curves = {sharp.begin(), sharp.end()}, .radius = radius};
  for (Index e = 0; e < edges.size(); ++e) {  // all of a curve is rounded, if a part of it is sharp
    const auto curve = curve_of.find(edges.points[e]);
    if (curve == curve_of.end() || !sharp.contains(curve->second)) continue;
    const double length =
        (surface.points[edges.points[e][1]] - surface.points[edges.points[e][0]]).norm();
    const double change = -radius * radius * length * (std::tan(turned[e] / 2) - turned[e] / 2);
    result.volume_change += change;
    result.volume_turned += std::abs(change);
  }
  return result;
}

bool is_plausible(const Rounding& rounding, double volume_before, double volume_after) {
  const double change = volume_after - volume_before;
  return std::abs(change - rounding.volume_change) <= share_of_corners * rounding.volume_turned;
}

}  // namespace roughmesh::detail
