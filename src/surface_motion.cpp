// SPDX-License-Identifier: BSD-3-Clause
#include "surface_motion.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "exact_predicates.hpp"
#include "opposite_sheet.hpp"
#include "parallel.hpp"
#include "polygon.hpp"

namespace roughmesh::detail {
namespace {

// Shares are found to a few parts in a thousand.
constexpr int n_halvings = 12;
// Below this part of the square of its longest edge the area of a face is round-off.
constexpr double no_area = 1e-14;

// The largest share, from below, up to which a defect that is there at 1 is not there.
template <class Fails>
double last_passing_share(Fails&& fails) {
  double passes = 0, failed = 1;
  for (int i = 0; i < n_halvings; ++i) {
    const double middle = (passes + failed) / 2;
    (fails(middle) ? failed : passes) = middle;
  }
  return passes;
}

// Sums the tallies of ranges in their order, so that threads do not matter.
template <class AddRange>
DefectTally tally(std::size_t n, std::size_t grain, AddRange&& add_range) {
  std::vector<DefectTally> parts((n + grain - 1) / grain);
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) add_range(i, parts[begin / grain]);
  });
  DefectTally total;
  for (const DefectTally& part : parts) total.add(part);
  return total;
}

Defect make_defect(const CheckedFaces& faces, SurfaceDefect kind, double share, Index a, Index b) {
  const Tag of_a = faces.sources[a].element, of_b = faces.sources[b].element;
  if (a == b) return {share, kind, {0, of_a}, a, a};
  return of_a <= of_b ? Defect{share, kind, {of_a, of_b}, a, b}
                      : Defect{share, kind, {of_b, of_a}, b, a};
}

// Area vector of a face, or vector along a line, at a share of the motion.
Vec3 extent_at(const SurfaceMotion& motion, std::size_t face, double share) {
  Corners corners;
  for (const Index point : motion.rest.faces.face(face))
    corners.positions[corners.n++] =
        motion.rest.faces.before[point] + share * motion.displacement(point);
  if (corners.n == 2) return corners.positions[1] - corners.positions[0];
  return area_vector(corners.span());
}

double longest_edge(const SurfaceMotion& motion, std::size_t face, std::span<const Vec3> places) {
  const auto points = motion.rest.faces.face(face);
  double longest = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
    longest =
        std::max(longest, (places[points[k]] - places[points[(k + 1) % points.size()]]).norm());
  return longest;
}

bool is_flat(const SurfaceMotion& motion, std::size_t face, const Vec3& extent,
             std::span<const Vec3> places) {
  const double edge = longest_edge(motion, face, places);
  const double full = motion.rest.faces.dimension == 1 ? edge : edge * edge;
  return !(extent.norm() > no_area * full);
}

void add_if_turned(const SurfaceMotion& motion, std::size_t face, DefectTally& result) {
  const auto points = motion.rest.faces.face(face);
  if (std::none_of(points.begin(), points.end(), [&](Index p) { return motion.has_moved[p]; }))
    return;
  const Vec3 before = extent_at(motion, face, 0);
  if (is_flat(motion, face, before, motion.rest.faces.before)) return;
  const Vec3 after = extent_at(motion, face, 1);
  const bool has_collapsed = is_flat(motion, face, after, motion.after);
  if (!has_collapsed && after.dot(before) > 0) return;
  const double share =
      last_passing_share([&](double s) { return !(extent_at(motion, face, s).dot(before) > 0); });
  const auto self = static_cast<Index>(face);
  result.add(make_defect(motion.rest.faces,
                         has_collapsed ? SurfaceDefect::collapsed : SurfaceDefect::folded, share,
                         self, self));
}

// Is the point on the other side of the facet than it was?
bool has_crossed(const SurfaceMotion& motion, Index point, const Facet& facet) {
  const auto side = [&](std::span<const Vec3> x) {
    return motion.rest.faces.dimension == 1
               ? turn(x[facet[0]], x[facet[1]], x[point], motion.rest.axis)
               : side_of_plane(x[facet[0]], x[facet[1]], x[facet[2]], x[point]);
  };
  return side(motion.rest.faces.before) * side(motion.after) < 0;
}

// The sheet ahead of a point may come towards it: both displacements count, along the ray.
void add_if_passed(const SurfaceMotion& motion, const TriangleTree& tree, Index point,
                   Index face_of_point, double longest, DefectTally& result) {
  const CheckedFaces& faces = motion.rest.faces;
  const Vec3 way = motion.displacement(point);
  const double length = way.norm();
  if (!(length > 0)) return;
  const Vec3 direction = way / length;
  const auto hit =
      opposite_sheet(faces, tree, point, direction, length + longest, motion.rest.plane_normal);
  if (!hit) return;
  const Facet& facet = faces.facets[hit->facet];
  double closing = length;
  for (std::size_t k = 0; k < 3; ++k)
    closing -= hit->weights[k] * motion.displacement(facet[k]).dot(direction);
  if (!(closing >= hit->distance) || !has_crossed(motion, point, facet)) return;
  result.add(make_defect(faces, SurfaceDefect::closed_wall, hit->distance / closing, face_of_point,
                         faces.face_of_facet[hit->facet]));
}

std::vector<Index> face_of_points(const CheckedFaces& faces) {
  std::vector<Index> face_of(faces.nodes.size(), -1);
  for (std::size_t f = faces.corners.size(); f-- > 0;)
    for (const Index point : faces.face(f)) face_of[point] = static_cast<Index>(f);
  return face_of;
}

bool is_worse(const Defect& x, const Defect& y) {
  return std::tie(x.passing_share, x.kind, x.elements, x.a, x.b) <
         std::tie(y.passing_share, y.kind, y.elements, y.a, y.b);
}

}  // namespace

SurfaceMotion move_faces(const FacesAtRest& rest, std::span<const Vec3> moved) {
  SurfaceMotion motion{rest, {}, {}, {}};
  for (std::size_t i = 0; i < rest.faces.nodes.size(); ++i) {
    motion.after.push_back(moved[rest.faces.nodes[i]]);
    motion.has_moved.push_back(motion.after[i] != rest.faces.before[i]);
  }
  motion.joined = joined_after(rest.faces, motion.after);
  return motion;
}

void DefectTally::add(const Defect& defect) {
  add_minor(defect.kind);
  worst_.insert(std::upper_bound(worst_.begin(), worst_.end(), defect, is_worse), defect);
  if (worst_.size() > most_kept) worst_.pop_back();
}

void DefectTally::add(const DefectTally& other) {
  for (const Defect& defect : other.worst_) add(defect);
  for (std::size_t k = 0; k < counts_.size(); ++k) counts_[k] += other.counts_[k];
  for (const Defect& defect : other.worst_) --counts_[static_cast<std::size_t>(defect.kind)];
}

double DefectTally::threshold() const {
  return worst_.size() < most_kept ? 1 : worst_.back().passing_share;
}

DefectTally turned_faces(const SurfaceMotion& motion) {
  constexpr std::size_t grain = 4096;
  return tally(motion.rest.faces.corners.size(), grain,
               [&](std::size_t f, DefectTally& part) { add_if_turned(motion, f, part); });
}

// Most pairs are tested at one share only: whether they are among the worst.
DefectTally new_intersections(const SurfaceMotion& motion, std::span<const FacePair> pairs) {
  constexpr std::size_t grain = 512;
  const FacesInPlace before = motion.rest.in_place(), after = motion.in_place();
  return tally(pairs.size(), grain, [&](std::size_t i, DefectTally& part) {
    const auto [a, b] = pairs[i];
    const auto fails = [&, a = a, b = b](double share) {
      return intersect_between(before, after, share, a, b);
    };
    if (part.threshold() < 1 && !fails(part.threshold()))
      part.add_minor(SurfaceDefect::intersection);
    else
      part.add(make_defect(motion.rest.faces, SurfaceDefect::intersection,
                           last_passing_share(fails), a, b));
  });
}

// Where a part of a sheet has passed another, both intersect at the border of that part. Only
// sheets that pass as a whole do not, and of those a sample of the points is enough.
DefectTally closed_walls(const SurfaceMotion& motion, const TriangleTree& tree) {
  const std::vector<Index> face_of = face_of_points(motion.rest.faces);
  double longest = 0;
  for (std::size_t i = 0; i < motion.after.size(); ++i)
    longest = std::max(longest, motion.displacement(static_cast<Index>(i)).norm());
  const auto every = [&](std::size_t step) {
    constexpr std::size_t grain = 1024;
    const std::vector<Index> points = motion.rest.faces.sample(step);
    return tally(points.size(), grain, [&](std::size_t i, DefectTally& part) {
      add_if_passed(motion, tree, points[i], face_of[points[i]], longest, part);
    });
  };
  const std::size_t step = 1 + motion.after.size() / most_sampled_points;
  DefectTally sample = every(step);
  return step == 1 || sample.count(SurfaceDefect::closed_wall) == 0 ? sample : every(1);
}

}  // namespace roughmesh::detail
