// SPDX-License-Identifier: BSD-3-Clause
#include "edge_motion.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "disjoint_sets.hpp"
#include "unfolding.hpp"

namespace roughmesh::detail {
namespace {

// Of its height, by which a node on a wall may slide along the surface without any other: a tenth
// of a cell where heights are two.
constexpr double little_slide = 0.05;

Vec3 along_surface(const Vec3& u, const Vec3& normal) { return u - normal.dot(u) * normal; }

std::size_t place_of(Index node, std::span<const Index> moved) {
  return static_cast<std::size_t>(std::lower_bound(moved.begin(), moved.end(), node) -
                                  moved.begin());
}

// Orthonormal, without those that are combinations of others but for round-off.
std::vector<Vec3> orthonormal(std::span<const Vec3> directions) {
  constexpr double new_direction = 1e-6;
  std::vector<Vec3> result;
  for (Vec3 each : directions) {
    for (const Vec3& other : result) each -= other.dot(each) * other;
    if (result.size() < 3 && each.norm() > new_direction) result.push_back(each.normalized());
  }
  return result;
}

// Vertices whose points have the same number; classes of one are left out.
std::vector<std::vector<Index>> image_classes(std::span<const EdgeOptions> options,
                                              const JoinedSurfaces& joined) {
  std::map<Index, std::vector<Index>> classes;
  for (std::size_t s = 0; s < options.size(); ++s)
    for (std::size_t i = 0; i < options[s].images.size(); ++i)
      classes[options[s].images[i]].push_back(joined.vertex_of_point[s][i]);
  std::vector<std::vector<Index>> result;
  for (auto& [number, vertices] : classes) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    if (vertices.size() > 1) result.push_back(std::move(vertices));
  }
  return result;
}

}  // namespace

EdgeMotion::EdgeMotion(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                       const NodeConstraints& constraints, std::span<const Index> moved)
    : joined_(join_surfaces(surfaces, moved)), sectors_(find_sectors(surfaces, options, joined_)) {
  find_still(surfaces, options, constraints.fixed, moved);
  const Images images = image_classes(options, joined_);
  find_bound(across(constraints, moved), images);
  find_sliding(options, images, constraints.anchored, moved);
  prepare_chains();
  prepare_faces(options);
}

void EdgeMotion::find_still(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                            std::span<const Index> fixed, std::span<const Index> moved) {
  for (const Sector& sector : sectors_.all) {
    const std::vector<double>& weights = options[sector.surface].weights;
    is_moving_.push_back(weights.empty() || weights[sector.point] > 0 ? 1 : 0);
  }
  is_still_.assign(joined_.positions.size(), 1);
  for (std::size_t i = 0; i < sectors_.all.size(); ++i)
    if (is_moving_[i] != 0) is_still_[sectors_.all[i].vertex] = 0;
  for (const Index node : fixed) is_still_[joined_.vertex_of_node[place_of(node, moved)]] = 1;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (options[s].rule != EdgeRule::fix) continue;
    const std::vector<std::uint8_t> sharp = sharp_points(surfaces[s], options[s].sharp_angle);
    for (std::size_t i = 0; i < sharp.size(); ++i)
      if (sharp[i] != 0) is_still_[joined_.vertex_of_point[s][i]] = 1;
  }
}

std::vector<std::vector<Vec3>> EdgeMotion::across(const NodeConstraints& constraints,
                                                  std::span<const Index> moved) const {
  std::vector<std::vector<Vec3>> across(joined_.positions.size());
  for (const SlidingNode& sliding : constraints.sliding)
    across[joined_.vertex_of_node[place_of(sliding.node, moved)]].push_back(sliding.normal);
  return across;
}

void EdgeMotion::find_bound(const std::vector<std::vector<Vec3>>& across, const Images& images) {
  std::vector<std::uint8_t> is_bound(joined_.positions.size(), 0);
  for (Index v = 0; v < joined_.n_vertices(); ++v)
    is_bound[v] = is_still_[v] == 0 && (sectors_.at(v).size() > 1 || !across[v].empty()) ? 1 : 0;
  for (const std::vector<Index>& vertices : images) {
    if (std::none_of(vertices.begin(), vertices.end(), [&](Index v) { return is_bound[v] != 0; }))
      continue;
    for (const Index v : vertices) is_bound[v] = is_still_[v] == 0 ? 1 : 0;
    images_.push_back(vertices);
  }
  bound_of_vertex_.assign(joined_.positions.size(), -1);
  for (Index v = 0; v < joined_.n_vertices(); ++v) {
    if (is_bound[v] == 0) continue;
    std::vector<Index> moving;
    std::vector<Vec3> normals;
    for (Index i = sectors_.offsets[v]; i < sectors_.offsets[v + 1]; ++i) {
      if (is_moving_[i] == 0) continue;
      moving.push_back(i);
      normals.push_back(sectors_.all[i].normal);
    }
    bound_of_vertex_[v] = static_cast<Index>(bound_.size());
    const LeastDisplacement least(normals, across[v]);
    const bool slides = across[v].empty() || normals.size() != 1 ||
                        (least.solve(normals[0], 1) - normals[0]).norm() > little_slide;
    bound_.push_back({v, std::move(moving), least, slides});
  }
}

// Images would have to slide alike, ends of surfaces would change their shape.
void EdgeMotion::find_sliding(std::span<const EdgeOptions> options, const Images& images,
                              std::span<const Index> anchored, std::span<const Index> moved) {
  can_slide_.assign(joined_.positions.size(), joined_.dimension == 2 ? 1 : 0);
  const auto hold = [&](Index vertex) { can_slide_[vertex] = 0; };
  for (std::size_t i = 0; i < sectors_.all.size(); ++i)
    if (is_moving_[i] == 0 || options[sectors_.all[i].surface].rule != EdgeRule::offset)
      hold(sectors_.all[i].vertex);
  for (Index v = 0; v < joined_.n_vertices(); ++v)
    if (is_still_[v] != 0) hold(v);
  for (Index e = 0; e < joined_.edges.size(); ++e)
    if (sectors_.kind_of_edge[e] == EdgeKind::border)
      for (const Index vertex : joined_.edges.points[e]) hold(vertex);
  for (const std::vector<Index>& vertices : images)
    for (const Index vertex : vertices) hold(vertex);
  for (const Index node : anchored) {
    const Index vertex = joined_.vertex_of_node[place_of(node, moved)];
    if (sectors_.at(vertex).size() == 1) hold(vertex);
  }
}

// Edge curves; of a planar mesh, the smooth pieces of the curve itself.
void EdgeMotion::prepare_chains() {
  if (bound_.empty()) return;
  std::vector<std::array<Index, 2>> segments;
  std::vector<std::uint8_t> is_end(joined_.positions.size(), 1);
  if (joined_.dimension == 1) {
    for (Index f = 0; f < joined_.n_faces(); ++f)
      segments.push_back({joined_.face(f)[0], joined_.face(f)[1]});
    for (Index v = 0; v < joined_.n_vertices(); ++v)
      is_end[v] = is_still_[v] != 0 || is_bound(v) ? 1 : 0;
  } else {
    for (Index e = 0; e < joined_.edges.size(); ++e) {
      const auto& [a, b] = joined_.edges.points[e];
      if (sectors_.kind_of_edge[e] != EdgeKind::smooth && is_on_edge(a) && is_on_edge(b))
        segments.push_back({a, b});
    }
    for (const Bound& bound : bound_) is_end[bound.vertex] = bound.least.is_rigid() ? 1 : 0;
  }
  chains_ = find_chains(segments, joined_.positions, is_end);
}

// Triangles, with sectors as their corners, of pieces of surface that have a bound vertex;
// quadrangles count as the triangles at their corners (docs/math.md, eq. 37).
std::vector<std::array<Index, 3>> EdgeMotion::faces_to_stretch(
    std::span<const std::uint8_t> is_inner) const {
  DisjointSets pieces(sectors_.all.size());
  const auto seats = [&](Index f) {
    return std::span(sectors_.sector_of_corner)
        .subspan(joined_.face_offsets[f], joined_.face(f).size());
  };
  for (Index f = 0; f < joined_.n_faces(); ++f)
    for (const Index seat : seats(f)) pieces.unite(seats(f)[0], seat);
  std::vector<std::uint8_t> has_bound(sectors_.all.size(), 0);
  for (std::size_t i = 0; i < sectors_.all.size(); ++i)
    if (is_bound(sectors_.all[i].vertex) && bound_[bound_of_vertex_[sectors_.all[i].vertex]].slides)
      has_bound[pieces.smallest(static_cast<Index>(i))] = 1;
  std::vector<std::array<Index, 3>> triangles;
  for (Index f = 0; f < joined_.n_faces(); ++f) {
    const auto corners = seats(f);
    const std::size_t n = corners.size();
    if (has_bound[pieces.smallest(corners[0])] == 0 ||
        std::none_of(corners.begin(), corners.end(), [&](Index i) { return is_inner[i] != 0; }))
      continue;
    for (std::size_t k = 0; k < (n == 3 ? 1 : n); ++k)
      triangles.push_back({corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]});
  }
  return triangles;
}

void EdgeMotion::prepare_faces(std::span<const EdgeOptions> options) {
  if (bound_.empty() || joined_.dimension == 1) return;
  std::vector<std::uint8_t> is_inner(sectors_.all.size(), 0);
  for (std::size_t i = 0; i < sectors_.all.size(); ++i) {
    const Sector& sector = sectors_.all[i];
    is_inner[i] = options[sector.surface].rule == EdgeRule::offset && !is_bound(sector.vertex) &&
                          is_still_[sector.vertex] == 0
                      ? 1
                      : 0;
  }
  for (Index e = 0; e < joined_.edges.size(); ++e)
    if (sectors_.kind_of_edge[e] == EdgeKind::border)
      for (const Index vertex : joined_.edges.points[e])
        for (Index i = sectors_.offsets[vertex]; i < sectors_.offsets[vertex + 1]; ++i)
          is_inner[i] = 0;
  const std::vector<std::array<Index, 3>> triangles = faces_to_stretch(is_inner);

  std::vector<NodeRole> roles(sectors_.all.size(), NodeRole::zero);
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (is_inner[i] != 0) roles[i] = NodeRole::sought;
    if (is_bound(sectors_.all[i].vertex)) roles[i] = NodeRole::given;
  }
  std::vector<Vec3> places;
  for (const Sector& sector : sectors_.all) places.push_back(joined_.positions[sector.vertex]);
  faces_ = std::make_unique<const SmoothExtension>(places, triangles, roles);
}

Vec3 EdgeMotion::bound_displacement(const Bound& bound,
                                    std::span<const std::vector<double>> heights) const {
  Vec3 load = Vec3::Zero();
  double largest = 0;
  for (const Index i : bound.sectors) {
    const Sector& sector = sectors_.all[i];
    const double height = heights[sector.surface][sector.point];
    load += height * sector.normal;
    largest = std::max(largest, std::abs(height));
  }
  return bound.least.solve(load, largest);
}

// Of what the ends of a chain move by, the part along it.
void EdgeMotion::slide_along_chains(std::vector<Vec3>& u) const {
  const auto along = [&](Index end, Index beside) {
    const Vec3 direction = (joined_.positions[beside] - joined_.positions[end]).normalized();
    return Vec3(direction.dot(u[end]) * direction);
  };
  std::vector<Vec3> slides;
  for (const Link& link : chains_.links) {
    const Chain& chain = chains_.chains[link.chain];
    const Vec3 slide = (1 - link.fraction) * along(chain.first_end, chain.first) +
                       link.fraction * along(chain.last_end, chain.last);
    slides.push_back(is_bound(link.point)
                         ? bound_[bound_of_vertex_[link.point]].least.free_part(slide)
                         : along_surface(slide, sectors_.at(link.point).front().normal));
  }
  for (std::size_t i = 0; i < slides.size(); ++i) u[chains_.links[i].point] += slides[i];
}

void EdgeMotion::equal_images(std::vector<Vec3>& u) const {
  for (const std::vector<Index>& vertices : images_) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : vertices) sum += u[v];
    for (const Index v : vertices) u[v] = sum / static_cast<double>(vertices.size());
  }
}

void EdgeMotion::stretch_faces(std::vector<Vec3>& u) const {
  if (!faces_) return;
  std::vector<Vec3> given;
  for (const Index i : faces_->given()) {
    const Sector& sector = sectors_.all[i];
    given.push_back(along_surface(u[sector.vertex], sector.normal));
  }
  const std::vector<Vec3> inner = faces_->extend(given);
  for (std::size_t k = 0; k < inner.size(); ++k) {
    const Sector& sector = sectors_.all[faces_->sought()[k]];
    u[sector.vertex] += along_surface(inner[k], sector.normal);
  }
}

// Of vertices that can slide: the normals of the pieces of surface there, and of walls.
std::vector<SlidingNode> EdgeMotion::directions_to_keep() const {
  std::vector<SlidingNode> result;
  for (Index v = 0; v < joined_.n_vertices(); ++v) {
    if (can_slide_[v] == 0) continue;
    std::vector<Vec3> directions;
    if (is_bound(v)) directions = bound_[bound_of_vertex_[v]].least.bound_directions();
    for (const Sector& sector : sectors_.at(v)) directions.push_back(sector.normal);
    for (const Vec3& each : orthonormal(directions)) result.push_back({v, each});
  }
  return result;
}

MovedSurface EdgeMotion::unfold(std::vector<Vec3> u) const {
  const std::vector<Vec3> before = u;
  if (joined_.dimension == 2 && has_turned_face(joined_.view(), joined_.positions, u))
    detail::unfold({joined_.positions, joined_.view(), can_slide_, directions_to_keep()}, u);
  MovedSurface moved;
  for (const Index vertex : joined_.vertex_of_node) {
    moved.displacements.push_back(u[vertex]);
    const double slide = (u[vertex] - before[vertex]).norm();
    moved.n_slid += slide > 0 ? 1 : 0;
    moved.farthest_slide = std::max(moved.farthest_slide, slide);
  }
  return moved;
}

MovedSurface EdgeMotion::unfolded(std::span<const Vec3> at_points) const {
  std::vector<Vec3> u(joined_.positions.size(), Vec3::Zero());
  for (std::size_t i = 0; i < at_points.size(); ++i)
    u[joined_.vertex_of_point.front()[i]] = at_points[i];
  return unfold(std::move(u));
}

MovedSurface EdgeMotion::move(std::span<const std::vector<double>> heights) const {
  std::vector<Vec3> u(joined_.positions.size(), Vec3::Zero());
  for (Index v = 0; v < joined_.n_vertices(); ++v) {
    if (is_still_[v] != 0) continue;
    const auto sectors = sectors_.at(v);
    u[v] = is_bound(v) ? bound_displacement(bound_[bound_of_vertex_[v]], heights)
                       : heights[sectors[0].surface][sectors[0].point] * sectors[0].normal;
  }
  slide_along_chains(u);
  equal_images(u);
  stretch_faces(u);
  return unfold(std::move(u));
}

}  // namespace roughmesh::detail
