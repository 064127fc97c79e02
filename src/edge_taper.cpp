// SPDX-License-Identifier: BSD-3-Clause
#include "edge_taper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "joined_surfaces.hpp"
#include "parallel.hpp"
#include "sectors.hpp"
#include "simplex.hpp"
#include "smooth_step.hpp"

namespace roughmesh::detail {
namespace {

// Sheets closer to each other than this are acute.
constexpr double largest_angle = std::numbers::pi / 4;
// Thickness, in Rq, from which on heights are whole: both sheets may move by 3.5 Rq, and the smooth
// step is at most 1.2 t.
constexpr double whole_thickness = 10;
// No taper reaches farther, in mesh sizes: a single folded face makes no part smooth.
constexpr double longest_reach = 10;

// An acute edge and the distance at which its taper ends.
struct Taper {
  PlacedSimplex edge;
  Vec3 middle = Vec3::Zero();
  double angle = 0, reach = 0;
};

// From the edge into the face, across the edge.
Vec3 into_face(const JoinedSurfaces& joined, Index face, const std::array<Index, 2>& ends) {
  const Vec3& a = joined.positions[ends[0]];
  const Vec3 along = (joined.positions[ends[1]] - a).normalized();  // zero at a point of a curve
  Vec3 inward = Vec3::Zero();
  for (const Index vertex : joined.face(face)) inward += joined.positions[vertex] - a;
  return inward - along.dot(inward) * along;
}

double smallest_opening(const JoinedSurfaces& joined, Index edge) {
  const auto sides = joined.edges.edge(edge);
  double smallest = std::numbers::pi;
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 a = into_face(joined, sides[i].face, joined.edges.points[edge]);
      const Vec3 b = into_face(joined, sides[j].face, joined.edges.points[edge]);
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  return smallest;
}

// Of the surfaces at an edge, the largest of what a function says.
template <class Value>
double largest_at(const JoinedSurfaces& joined, Index edge, Value&& value) {
  double largest = 0;
  for (const Side& side : joined.edges.edge(edge))
    largest = std::max(largest, value(joined.surface_of_face[side.face]));
  return largest;
}

std::vector<Taper> find_tapers(std::span<const Surface> surfaces,
                               std::span<const EdgeOptions> options, std::span<const double> rms,
                               const JoinedSurfaces& joined) {
  const Sectors sectors = find_sectors(surfaces, options, joined);
  std::vector<Taper> tapers;
  for (Index e = 0; e < joined.edges.size(); ++e) {
    if (sectors.kind_of_edge[e] != EdgeKind::sharp) continue;
    const double angle = smallest_opening(joined, e);
    const double rq = largest_at(joined, e, [&](std::uint32_t s) {
      return options[s].rule == EdgeRule::offset ? rms[s] : 0;
    });
    if (!(angle < largest_angle) || !(rq > 0)) continue;
    const double h =
        largest_at(joined, e, [&](std::uint32_t s) { return surfaces[s].mesh_size.median; });
    const auto& [a, b] = joined.edges.points[e];
    const std::array<Vec3, 2> ends = {joined.positions[a], joined.positions[b]};
    tapers.push_back(
        {PlacedSimplex(std::span(ends).first(a == b ? 1 : 2)), (ends[0] + ends[1]) / 2, angle,
         std::min(whole_thickness * rq / (2 * std::tan(angle / 2)), longest_reach * h)});
  }
  return tapers;
}

// Cubes of space with the tapers whose middles are in them, large enough for a taper to end in the
// next cube.
class TaperCubes {
 public:
  explicit TaperCubes(std::span<const Taper> tapers) : tapers_(tapers) {
    for (const Taper& taper : tapers)
      size_ = std::max(size_, taper.reach + taper.edge.bounds().sizes().norm() / 2);
    for (std::size_t i = 0; i < tapers.size(); ++i)
      entries_.emplace_back(cube(tapers[i].middle), i);
    std::sort(entries_.begin(), entries_.end());
  }

  // Distance from the nearest edge over its reach; above 1 where there is none within reach.
  double distance(const Vec3& x) const {
    double nearest = 2;
    const Cube middle = cube(x);
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k)
          nearest =
              std::min(nearest, distance_in({middle[0] + i, middle[1] + j, middle[2] + k}, x));
    return nearest;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  using Entry = std::pair<Cube, std::size_t>;  // and the number of a taper

  Cube cube(const Vec3& x) const {
    const Vec3 c = ((x - tapers_[0].middle) / size_).array().floor();
    return {static_cast<std::int64_t>(c.x()), static_cast<std::int64_t>(c.y()),
            static_cast<std::int64_t>(c.z())};
  }
  double distance_in(const Cube& cube, const Vec3& x) const {
    double nearest = 2;
    const Entry first{cube, 0};
    for (auto at = std::lower_bound(entries_.begin(), entries_.end(), first);
         at != entries_.end() && at->first == cube; ++at) {
      const Taper& taper = tapers_[at->second];
      nearest = std::min(nearest, std::sqrt(squared_distance(taper.edge, x)) / taper.reach);
    }
    return nearest;
  }

  std::span<const Taper> tapers_;
  double size_ = 0;
  std::vector<Entry> entries_;
};

std::vector<double> factors_of(const Surface& surface, const TaperCubes& cubes) {
  std::vector<double> factors(surface.points.size());
  parallel_for(factors.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      factors[i] = smooth_step(cubes.distance(surface.points[i]));
  });
  const bool has_any =
      std::any_of(factors.begin(), factors.end(), [](double factor) { return factor < 1; });
  return has_any ? factors : std::vector<double>();
}

// Within reach of the surface; of equal angles the first.
AcuteEdge sharpest_of(std::span<const Taper> tapers) {
  const auto at =
      std::min_element(tapers.begin(), tapers.end(),
                       [](const Taper& a, const Taper& b) { return a.angle < b.angle; });
  return {at->angle, at->middle};
}

}  // namespace

EdgeTaper taper_acute_edges(std::span<const Surface> surfaces, std::span<const EdgeOptions> options,
                            std::span<const double> rms) {
  EdgeTaper taper{std::vector<std::vector<double>>(surfaces.size()),
                  std::vector<AcuteEdge>(surfaces.size())};
  const bool has_edges = surfaces.size() > 1 || surfaces.front().n_sharp_edges > 0 ||
                         surfaces.front().n_nonmanifold_edges > 0;
  if (!has_edges) return taper;
  const JoinedSurfaces joined = join_surfaces(surfaces, moved_nodes(surfaces));
  const std::vector<Taper> tapers = find_tapers(surfaces, options, rms, joined);
  if (tapers.empty()) return taper;
  const TaperCubes cubes(tapers);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (options[s].rule != EdgeRule::offset) continue;
    taper.factors[s] = factors_of(surfaces[s], cubes);
    if (!taper.factors[s].empty()) taper.sharpest[s] = sharpest_of(tapers);
  }
  return taper;
}

}  // namespace roughmesh::detail
