// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/surface.hpp"

#include <utility>

#include <fmt/format.h>

#include "polygon.hpp"
#include "surface_edges.hpp"
#include "surface_faces.hpp"
#include "surface_measures.hpp"
#include "surface_orientation.hpp"
#include "surface_points.hpp"

namespace roughmesh {
namespace {

void check_options(const SurfaceOptions& options) {
  if (options.sharp_angle >= 0 && options.sharp_angle <= std::numbers::pi) return;
  throw InputError(
      fmt::format("sharp_angle is {} radians; give an angle from 0 to pi", options.sharp_angle));
}

void fill_nodes(const detail::WeldedPoints& welded, Surface& surface) {
  surface.n_coincident_nodes = welded.n_coincident_nodes;
  for (std::size_t node = 0; node < welded.point_of_node.size(); ++node) {
    if (welded.point_of_node[node] < 0) continue;
    surface.nodes.push_back(static_cast<Index>(node));
    surface.point_of_node.push_back(welded.point_of_node[node]);
  }
}

void require_size(std::size_t size, const Surface& surface, const char* what) {
  if (size == surface.points.size()) return;
  throw InputError(fmt::format("{} {} for a surface of {} points; give one per point", size, what,
                               surface.points.size()));
}

}  // namespace

Surface select_surface(const Mesh& mesh, const SurfaceOptions& options) {
  check_options(options);
  detail::ChosenFaces chosen = detail::choose_faces(mesh, options.groups);
  detail::WeldedPoints welded = detail::weld_points(mesh, chosen.faces.corners);
  const auto n_points = static_cast<Index>(welded.points.size());
  auto [faces, n_elements, n_duplicates] =
      detail::canonical_faces(chosen.faces, welded.point_of_node, n_points);
  chosen.faces = {};  // a large mesh needs the memory
  const detail::EdgeTable edges = detail::make_edges(faces.view(), n_points);

  Surface surface;
  surface.dimension = faces.dimension;
  surface.plane_normal = faces.plane_normal;
  surface.groups = std::move(chosen.groups);
  surface.n_elements = n_elements;
  surface.n_duplicate_faces = n_duplicates;
  surface.n_components = detail::orient_faces(mesh, welded, edges, faces);
  for (Index f = 0; options.flip && f < faces.size(); ++f) faces.turn(f);
  fill_nodes(welded, surface);
  surface.points = std::move(welded.points);
  surface.face_offsets = std::move(faces.offsets);
  surface.face_points = std::move(faces.corners);
  surface.face_tags = std::move(faces.tags);
  detail::measure_normals(mesh, surface);
  detail::measure_areas(surface);
  detail::measure_edges(edges, options.sharp_angle, surface);
  return surface;
}

std::vector<Vec3> moved_points(const Surface& surface, std::span<const Vec3> displacements) {
  require_size(displacements.size(), surface, "displacements");
  std::vector<Vec3> moved(surface.points);
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += displacements[i];
  return moved;
}

double enclosed_volume(const Surface& surface, std::span<const Vec3> positions) {
  require_size(positions.size(), surface, "positions");
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : positions) centre += x / static_cast<double>(positions.size());
  double volume = 0;
  for (Index f = 0; f < surface.n_faces(); ++f)
    volume += detail::cone_volume(detail::gather(surface.face(f), positions).span(), centre,
                                  surface.plane_normal);
  return volume;
}

}  // namespace roughmesh
