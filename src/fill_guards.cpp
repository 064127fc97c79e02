// SPDX-License-Identifier: BSD-3-Clause
#include "fill_guards.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "checked_faces.hpp"
#include "messages.hpp"
#include "self_intersection.hpp"
#include "surface_faces.hpp"

namespace roughmesh::detail {
namespace {

using Edge = std::pair<Index, Index>;  // ascending

Vec3 centre(const FillTask& task, const std::array<Index, 3>& triangle) {
  return (task.nodes[triangle[0]] + task.nodes[triangle[1]] + task.nodes[triangle[2]]) / 3;
}

void check_coordinates(const FillTask& task) {
  for (const Sheet& sheet : task.sheets)
    for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
      for (const Index node : sheet.triangles[t])
        if (!task.nodes[node].allFinite())
          throw InputError(
              fmt::format("triangle {} has a coordinate that is not finite; lower the heights",
                          sheet.elements[t]));
}

void check_repetitions(const FillTask& task) {
  std::vector<std::pair<FaceKey, Tag>> keys;
  for (const Sheet& sheet : task.sheets)
    for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
      keys.emplace_back(face_key(sheet.triangles[t]), sheet.elements[t]);
  std::sort(keys.begin(), keys.end());
  const auto twice = std::adjacent_find(
      keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice == keys.end()) return;
  throw InputError(
      fmt::format("triangles {} and {} have the same three nodes; take one of them out of the mesh",
                  twice->second, std::next(twice)->second));
}

// The triangles as a mesh of their own, for the search of the surface check.
Mesh mesh_of(const FillTask& task) {
  Mesh mesh;
  mesh.nodes = task.nodes;
  mesh.node_tags.resize(task.nodes.size());
  std::iota(mesh.node_tags.begin(), mesh.node_tags.end(), Tag{1});
  ElementBlock& block = mesh.blocks.emplace_back();
  block.type = {ElementShape::triangle, 1, 3};
  for (const Sheet& sheet : task.sheets) {
    for (const auto& triangle : sheet.triangles)
      block.nodes.insert(block.nodes.end(), triangle.begin(), triangle.end());
    block.tags.insert(block.tags.end(), sheet.elements.begin(), sheet.elements.end());
  }
  return mesh;
}

void check_places(const CheckedFaces& faces) {
  for (std::size_t point = 0; point < faces.joined.size(); ++point)
    if (faces.joined[point] != static_cast<Index>(point))
      throw InputError(fmt::format(
          "two nodes of the surface lie at {}: no volume mesh fits a crack; merge them, "
          "or take --volume move",
          place(faces.before[point])));
}

void check_intersections(const CheckedFaces& faces) {
  std::vector<Index> each(faces.before.size());
  std::iota(each.begin(), each.end(), Index{0});
  const std::vector<std::uint8_t> all(faces.before.size(), 1);
  const FacesInPlace here{faces, faces.before, each, 2};
  const FoundPairs found = find_intersections(here, here, all);  // that did not move
  if (!found.is_complete && found.in_input.empty())
    throw CheckError(
        "so many triangles around the volume to mesh lie upon each other that they cannot be "
        "checked: it cannot be filled; repair the surface");
  if (found.in_input.empty()) return;
  const FacePair& first = found.in_input.front();
  const FaceSource &a = faces.sources[first.a], &b = faces.sources[first.b];
  const Vec3& x = faces.before[faces.corners[first.a][0]];
  throw CheckError(fmt::format(
      "{} pairs of triangles around the volume to mesh intersect, the first are {} and {} "
      "at {}: it cannot be filled; lower --rms or repair the surface",
      found.in_input.size(), std::min(a.element, b.element), std::max(a.element, b.element),
      place(x)));
}

// A boundary that closes has an even number of triangles at every edge.
void check_closed(const FillTask& task, const VolumeToFill& volume) {
  std::vector<std::pair<Edge, Vec3>> edges;
  for (const Index s : volume.boundary)
    for (const auto& t : task.sheets[s].triangles)
      for (std::size_t k = 0; k < 3; ++k)
        edges.emplace_back(std::minmax(t[k], t[(k + 1) % 3]), centre(task, t));
  const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(edges.begin(), edges.end(), less);
  for (auto first = edges.begin(); first != edges.end();) {
    const auto end = std::upper_bound(first, edges.end(), *first, less);
    if ((end - first) % 2 != 0)
      throw InputError(
          fmt::format("the surface around the volume to mesh is open beside {}; close it",
                      place(first->second)));
    first = end;
  }
}

}  // namespace

void check_fill_task(const FillTask& task) {
  check_coordinates(task);
  check_repetitions(task);
  for (const VolumeToFill& volume : task.volumes) check_closed(task, volume);
  const CheckedFaces faces = collect_faces(mesh_of(task), 2);
  check_places(faces);
  check_intersections(faces);
}

}  // namespace roughmesh::detail
