// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <tuple>

#include "flat_walls.hpp"
#include "node_images.hpp"
#include "wall_faces.hpp"

namespace roughmesh {
namespace {

using Flags = std::vector<std::uint8_t>;

// Sine of the least angle between a rough surface and a wall that it crosses; beside a smaller one
// the wall goes on where the surface ends. Its inverse is the most that a node may slide by over
// its height (docs/math.md, eq. 36).
constexpr double least_sine = 1.0 / 3;
// Sine of 40 degrees: planes at a smaller angle are facets of one curved wall.
constexpr double smooth_sine = 0.64;
// Of a unit normal outside of the space of others, below which it is one of them but for round-off.
constexpr double new_direction = 1e-4;
// Sine of an angle between a line and a plane that it lies in.
constexpr double in_plane = 1e-5;

// Directions that a node cannot move along, orthonormal.
struct Directions {
  std::array<Vec3, 3> all;
  std::size_t n = 0;

  void add(Vec3 normal) {
    for (std::size_t k = 0; k < n; ++k) normal -= all[k].dot(normal) * all[k];
    if (n < 3 && normal.norm() > new_direction) all[n++] = normal.normalized();
  }
  void add(const Directions& other) {
    for (std::size_t k = 0; k < other.n; ++k) add(other.all[k]);
  }
};

Flags rough_flags(const Mesh& mesh, std::span<const Surface> surfaces) {
  Flags is_rough(mesh.nodes.size(), 0);
  for (const Surface& surface : surfaces)
    for (const Index node : surface.nodes) is_rough[node] = 1;
  return is_rough;
}

// A node of a surface that moves although it is on a wall; by node, once for each surface.
struct Meeting {
  Index node = 0;
  Vec3 normal = Vec3::Zero();  // of the surface
};

std::vector<Meeting> meetings(std::span<const Surface> surfaces, const Flags& is_wall,
                              const Flags& moving) {
  std::vector<Meeting> result;
  for (const Surface& surface : surfaces)
    for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
      const Index node = surface.nodes[i];
      if (is_wall[node] != 0 && (moving.empty() || moving[node] != 0))
        result.push_back({node, surface.normals[surface.point_of_node[i]]});
    }
  std::stable_sort(result.begin(), result.end(),
                   [](const Meeting& a, const Meeting& b) { return a.node < b.node; });
  return result;
}

// Walls and which of them slide.
struct Patched {
  std::vector<detail::WallFace> faces;
  detail::WallPatches found;
  Flags slides;  // per patch

  // Calls visit(node, patch), more than once where faces meet.
  template <class Visit>
  void for_each_node(Visit&& visit) const {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Index patch = found.patch_of_face[f];
      for (const Index node : faces[f].face.all())
        if (patch >= 0) visit(node, patch);
    }
  }
};

// A patch at a place where surfaces meet it.
struct Contact {
  Index patch = 0;
  Index meeting = 0;

  friend bool operator==(const Contact&, const Contact&) = default;
};

// By meeting; each once.
std::vector<Contact> contacts(const Patched& walls, std::span<const Meeting> met) {
  std::vector<Contact> result;
  walls.for_each_node([&](Index node, Index patch) {
    auto at = std::lower_bound(met.begin(), met.end(), node,
                               [](const Meeting& meeting, Index n) { return meeting.node < n; });
    for (; at != met.end() && at->node == node; ++at)
      result.push_back({patch, static_cast<Index>(at - met.begin())});
  });
  std::sort(result.begin(), result.end(), [](const Contact& a, const Contact& b) {
    return std::tie(a.meeting, a.patch) < std::tie(b.meeting, b.patch);
  });
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// Facets of a curved wall are many planes, which together leave a node no way to move by its
// height: such facets do not slide.
void hold_curved(std::span<const Contact> at, const Vec3& normal, const Flags& crossed,
                 Patched& walls) {
  const auto plane = [&](const Contact& contact) -> const Vec3& {
    return walls.found.patches[contact.patch].normal;
  };
  Directions across;
  for (const Contact& each : at)
    if (crossed[each.patch] != 0) across.add(plane(each));
  Vec3 left = normal;
  for (std::size_t k = 0; k < across.n; ++k) left -= across.all[k].dot(normal) * across.all[k];
  if (!(left.norm() < least_sine)) return;
  for (const Contact& a : at)
    for (const Contact& b : at) {
      const double sine = plane(a).cross(plane(b)).norm();
      if (new_direction < sine && sine < smooth_sine)
        walls.slides[a.patch] = walls.slides[b.patch] = 0;
    }
}

Patched find_sliding_patches(const Mesh& mesh, std::span<const Surface> surfaces,
                             std::span<const Meeting> met) {
  Patched walls{detail::wall_faces(mesh, surfaces), {}, {}};
  walls.found = detail::find_patches(mesh, walls.faces, surfaces.front().plane_normal);
  walls.slides.assign(walls.found.patches.size(), 0);
  const std::vector<Contact> all = contacts(walls, met);
  for (const Contact& each : all)
    walls.slides[each.patch] = walls.found.patches[each.patch].is_flat;
  for (const Contact& each : all)
    if (met[each.meeting].normal.cross(walls.found.patches[each.patch].normal).norm() < least_sine)
      walls.slides[each.patch] = 0;
  const Flags crossed = walls.slides;
  for (std::size_t first = 0; first < all.size();) {
    std::size_t end = first;
    while (end < all.size() && all[end].meeting == all[first].meeting) ++end;
    hold_curved(std::span(all).subspan(first, end - first), met[all[first].meeting].normal, crossed,
                walls);
    first = end;
  }
  return walls;
}

// What each node on sliding walls cannot do.
class NodeDirections {
 public:
  explicit NodeDirections(std::size_t n_nodes) : number_(n_nodes, -1) {}

  bool has(Index node) const { return number_[node] >= 0; }
  void add(Index node, const Vec3& normal) { of(node).add(normal); }
  void drop(Index node) { number_[node] = -1; }
  Directions& of(Index node) {
    if (!has(node)) {
      number_[node] = static_cast<Index>(all_.size());
      all_.emplace_back();
    }
    return all_[number_[node]];
  }
  std::vector<Index> nodes() const {
    std::vector<Index> result;
    for (std::size_t node = 0; node < number_.size(); ++node)
      if (number_[node] >= 0) result.push_back(static_cast<Index>(node));
    return result;
  }

 private:
  std::vector<Index> number_;
  std::vector<Directions> all_;
};

// The outline of a patch and of the groups in it keeps its shape, but where it moves with a
// surface.
void keep_borders(const Mesh& mesh, const Patched& walls, const Flags& is_rough,
                  const Vec3& plane_normal, NodeDirections& directions) {
  for (const detail::WallBorder& border : walls.found.borders) {
    const auto [a, b] = border.nodes;
    if (walls.slides[border.patch] == 0 || (is_rough[a] != 0 && is_rough[b] != 0)) continue;
    const Vec3 along = a == b ? plane_normal : Vec3((mesh.nodes[b] - mesh.nodes[a]).normalized());
    const Vec3 across = walls.found.patches[border.patch].normal.cross(along);
    for (const Index node : border.nodes)
      if (directions.has(node)) directions.add(node, across);
  }
}

// Lines and points of the mesh in a sliding wall are features that a user may have named.
void keep_features(const Mesh& mesh, const Flags& is_wall, const Flags& is_rough,
                   int face_dimension, NodeDirections& directions) {
  const auto keep_line = [&](Index a, Index b) {
    if (is_wall[a] == 0 || is_wall[b] == 0 || (is_rough[a] != 0 && is_rough[b] != 0)) return;
    const Vec3 along = (mesh.nodes[b] - mesh.nodes[a]).normalized();
    for (const Index node : {a, b}) {
      if (!directions.has(node)) continue;
      const Directions planes = directions.of(node);
      for (std::size_t k = 0; k < planes.n; ++k)
        if (std::abs(planes.all[k].dot(along)) <= in_plane)
          directions.add(node, planes.all[k].cross(along));
    }
  };
  for (const ElementBlock& block : mesh.blocks) {
    const int dim = dimension(block.type.shape);
    if (dim >= face_dimension || detail::is_between_partitions(mesh, block)) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto nodes = block.element(e);
      if (dim == 1) keep_line(nodes[0], nodes[1]);
      if (dim == 0 && directions.has(nodes[0]) && is_rough[nodes[0]] == 0)
        for (Eigen::Index axis = 0; axis < 3; ++axis) directions.add(nodes[0], Vec3::Unit(axis));
    }
  }
}

void slide(const Mesh& mesh, std::span<const Surface> surfaces, std::span<const Meeting> met,
           const Flags& is_rough, Walls& walls, NodeDirections& directions) {
  const Patched patched = find_sliding_patches(mesh, surfaces, met);
  Flags slides(mesh.nodes.size(), 0), stays(mesh.nodes.size(), 0);
  patched.for_each_node(
      [&](Index node, Index patch) { (patched.slides[patch] != 0 ? slides : stays)[node] = 1; });
  std::erase_if(walls.torn, [&](Index node) { return slides[node] != 0 && stays[node] == 0; });
  patched.for_each_node([&](Index node, Index patch) {
    if (patched.slides[patch] != 0 && (stays[node] == 0 || is_rough[node] != 0))
      directions.add(node, patched.found.patches[patch].normal);
  });
  keep_borders(mesh, patched, is_rough, surfaces.front().plane_normal, directions);
  keep_features(mesh, walls.is_wall, is_rough, surfaces.front().dimension, directions);
}

// Nodes that move alike cannot do what one of them cannot.
void share_directions(Walls& walls, const Flags& is_rough, NodeDirections& directions) {
  const auto n = static_cast<Index>(walls.images.size());
  Flags stays(walls.images.size(), 0);
  for (Index node = 0; node < n; ++node) {
    const Index first = walls.images[node];
    if (walls.stays[node] != 0 && !directions.has(node)) stays[first] = 1;
    if (first != node && directions.has(node)) {
      const Directions own = directions.of(node);
      directions.of(first).add(own);
    }
  }
  for (Index node = 0; node < n; ++node) {
    const Index first = walls.images[node];
    if (stays[first] != 0 && is_rough[node] == 0) {
      directions.drop(node);
      walls.stays[node] = 1;
    } else if (first != node && directions.has(first)) {
      const Directions common = directions.of(first);
      directions.of(node) = common;
    }
  }
}

void find_images(const Mesh& mesh, const std::optional<Vec3>& period, const Flags& is_rough,
                 Walls& walls, NodeDirections& directions) {
  const bool has_period = period && !period->isZero(0);
  if (mesh.periodic_links.empty() && !has_period) return;
  detail::NodeLinks links = detail::node_links(mesh);
  if (has_period) detail::unite_by_position(mesh, directions.nodes(), *period, links.translated);
  walls.images.resize(mesh.nodes.size());
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    walls.images[node] = links.translated.smallest(node);
    if (links.held[node] == 0 || is_rough[node] != 0) continue;
    walls.stays[node] = 1;
    directions.drop(node);
  }
  share_directions(walls, is_rough, directions);
}

// In a plane two directions are all there are.
void take_directions(const Flags& is_rough, std::size_t n_all, Walls& walls,
                     NodeDirections& directions) {
  for (const Index node : directions.nodes()) {
    const Directions& each = directions.of(node);
    if (is_rough[node] == 0) walls.stays[node] = each.n >= n_all;
    if (is_rough[node] == 0 && each.n >= n_all) continue;
    for (std::size_t k = 0; k < each.n; ++k) walls.sliding.push_back({node, each.all[k]});
  }
}

}  // namespace

Walls find_walls(const Mesh& mesh, std::span<const Surface> surfaces, const WallOptions& options) {
  if (surfaces.empty()) throw InputError("no rough surface; choose at least one");
  Walls walls;
  walls.is_wall = detail::wall_nodes(mesh, surfaces);
  walls.stays = walls.is_wall;
  const Flags is_rough = rough_flags(mesh, surfaces);
  for (std::size_t node = 0; node < is_rough.size(); ++node)
    if (is_rough[node] != 0) walls.stays[node] = 0;
  const std::vector<Meeting> met = meetings(surfaces, walls.is_wall, options.moving);
  for (const Meeting& each : met)
    if (walls.torn.empty() || walls.torn.back() != each.node) walls.torn.push_back(each.node);
  NodeDirections directions(mesh.nodes.size());
  if (options.can_slide && !met.empty()) slide(mesh, surfaces, met, is_rough, walls, directions);
  find_images(mesh, options.period, is_rough, walls, directions);
  take_directions(is_rough, static_cast<std::size_t>(surfaces.front().dimension) + 1, walls,
                  directions);
  return walls;
}

std::vector<SlidingNode> sliding_on_surfaces(const Walls& walls,
                                             std::span<const Surface> surfaces) {
  std::vector<std::uint8_t> is_rough(walls.is_wall.size(), 0);
  for (const Surface& surface : surfaces)
    for (const Index node : surface.nodes) is_rough[node] = 1;
  std::vector<SlidingNode> result;
  std::copy_if(walls.sliding.begin(), walls.sliding.end(), std::back_inserter(result),
               [&](const SlidingNode& each) { return is_rough[each.node] != 0; });
  return result;
}

}  // namespace roughmesh
