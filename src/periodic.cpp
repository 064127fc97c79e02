// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/periodic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "disjoint_sets.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "surface_measures.hpp"

namespace roughmesh {
namespace {

constexpr double tolerance = 1e-9;  // of a period

struct Pair {
  Index slave = 0, master = 0;  ///< nodes of the mesh
};

/// The part of a link that touches the surface, and the vector by which it shifts the master side
/// if it is a translation.
struct SurfaceLink {
  const PeriodicLink* link = nullptr;
  std::vector<Pair> pairs;
  std::optional<Vec3> shift;
};

std::vector<Index> points_of_nodes(const Mesh& mesh, const Surface& surface) {
  std::vector<Index> point(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < surface.nodes.size(); ++i)
    point[surface.nodes[i]] = surface.point_of_node[i];
  return point;
}

Vec3 shift_of(const Mesh& mesh, const std::pair<Index, Index>& nodes) {
  return mesh.nodes[nodes.first] - mesh.nodes[nodes.second];
}

std::string describe(const PeriodicLink& link) {
  return fmt::format("periodic link of entity {} to {}", link.entity, link.master_entity);
}

/// Whether the affine map of the link is one, and moves nothing but the origin.
bool is_affine_translation(const PeriodicLink& link) {
  if (link.affine.size() != 16) return true;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      if (std::abs(link.affine[4 * row + column] - (row == column ? 1.0 : 0.0)) > tolerance)
        return false;
  return true;
}

/// The common shift of all node pairs of the link. Shifts that differ by a thousandth of their
/// length belong to some other transformation; smaller differences are faults of the mesh.
std::optional<Vec3> translation(const Mesh& mesh, const PeriodicLink& link) {
  constexpr double faulty = 1e-3;
  if (link.nodes.empty() || !is_affine_translation(link)) return {};
  const Vec3 shift = shift_of(mesh, link.nodes.front());
  double spread = 0;
  Index worst = link.nodes.front().first;
  for (const auto& nodes : link.nodes) {
    const double difference = (shift_of(mesh, nodes) - shift).norm();
    if (difference <= spread) continue;
    spread = difference;
    worst = nodes.first;
  }
  if (spread > faulty * shift.norm()) return {};
  if (spread > tolerance * shift.norm())
    throw InputError(fmt::format(
        "{}: node {} at {} is off by {:.3g} from where its partner puts it, and {:.3g} is allowed; "
        "make both sides of the mesh equal",
        describe(link), mesh.node_tags[worst], detail::place(mesh.nodes[worst]), spread,
        tolerance * shift.norm()));
  return shift;
}

std::vector<SurfaceLink> links_of_surface(const Mesh& mesh, const std::vector<Index>& point) {
  std::vector<SurfaceLink> links;
  for (const PeriodicLink& link : mesh.periodic_links) {
    SurfaceLink part{&link, {}, {}};
    for (const auto& [slave, master] : link.nodes)
      if (slave != master && (point[slave] >= 0 || point[master] >= 0))
        part.pairs.push_back({slave, master});
    if (part.pairs.empty()) continue;
    part.shift = translation(mesh, link);
    links.push_back(std::move(part));
  }
  return links;
}

/// The axis of a shift along one; -1 for an oblique one.
int axis_of(const Vec3& shift) {
  Eigen::Index axis = 0;
  const double length = shift.cwiseAbs().maxCoeff(&axis);
  Vec3 rest = shift;
  rest[axis] = 0;
  return length > 0 && rest.norm() <= tolerance * length ? static_cast<int>(axis) : -1;
}

/// A link that leads off the surface says nothing about the period of what is on it.
bool joins_points(const SurfaceLink& link, const std::vector<Index>& point) {
  return std::any_of(link.pairs.begin(), link.pairs.end(), [&](const Pair& pair) {
    return point[pair.slave] >= 0 && point[pair.master] >= 0;
  });
}

void set_period(const Mesh& mesh, const SurfaceLink& link, Vec3& period) {
  const int axis = link.shift ? axis_of(*link.shift) : -1;
  if (axis < 0) return;
  const double length = std::abs((*link.shift)[axis]);
  if (period[axis] == 0) period[axis] = length;
  if (std::abs(length - period[axis]) <= tolerance * period[axis]) return;
  throw InputError(
      fmt::format("{} has period {:.12g} along {}, another link {:.12g}, at {}; one surface needs "
                  "one period: choose its parts one at a time",
                  describe(*link.link), length, "xyz"[axis], period[axis],
                  detail::place(mesh.nodes[link.pairs.front().slave])));
}

/// Whether the shift is a sum of periods, as between opposite corners.
bool is_lattice_shift(const Vec3& shift, const Vec3& period) {
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = period[axis] > 0 ? std::nearbyint(shift[axis] / period[axis]) : 0;
    const double rest = std::abs(shift[axis] - cells * period[axis]);
    if (rest > tolerance * std::max(1.0, std::abs(cells)) * period.maxCoeff()) return false;
  }
  return true;
}

PeriodicPartners no_partners(const Surface& surface) {
  PeriodicPartners partners;
  partners.master.resize(surface.points.size());
  std::iota(partners.master.begin(), partners.master.end(), Index{0});
  partners.rotated.assign(surface.points.size(), 0);
  partners.unpaired.assign(surface.points.size(), 0);
  return partners;
}

/// Masters from classes; what one point of a class suffers, all of it do.
void take_classes(detail::DisjointSets& classes, PeriodicPartners& partners) {
  const auto n = static_cast<Index>(partners.master.size());
  for (Index point = 0; point < n; ++point) {
    const Index master = partners.master[point] = classes.smallest(point);
    partners.rotated[master] |= partners.rotated[point];
    partners.unpaired[master] |= partners.unpaired[point];
  }
  for (Index point = 0; point < n; ++point) {
    partners.rotated[point] = partners.rotated[partners.master[point]];
    partners.unpaired[point] = partners.unpaired[partners.master[point]];
  }
}

// ---- By position ----

void check_period(const Vec3& period) {
  for (const double length : period)
    if (!(length >= 0) || !std::isfinite(length))
      throw InputError(
          fmt::format("--period {} along an axis; it must be greater than 0, or 0 along an axis "
                      "that is not periodic",
                      length));
  if (period.isZero(0)) throw InputError("--period is 0 along every axis; give one");
}

using Key = std::array<std::int64_t, 3>;

/// Position modulo the period, in cells of twice the tolerance. Two equal positions share a cell in
/// one of two grids along each axis, half a cell apart, of which bit `axis` of `grids` chooses one.
Key key_of(const Vec3& x, const Vec3& corner, const Vec3& period, unsigned grids) {
  Key key{};
  for (int axis = 0; axis < 3; ++axis) {
    const double unit = period[axis] > 0 ? period[axis] : period.maxCoeff();
    const double cells = (x[axis] - corner[axis]) / unit / (2 * tolerance);
    const double cell = std::floor(cells + ((grids >> axis & 1U) != 0 ? 0.5 : 0.0));
    key[axis] = static_cast<std::int64_t>(
        std::clamp(period[axis] > 0 ? std::fmod(cell, 0.5 / tolerance) : cell, -9e18, 9e18));
  }
  return key;
}

bool are_images(const Vec3& x, const Vec3& y, const Vec3& period) {
  bool is_shifted = false;
  for (int axis = 0; axis < 3; ++axis)
    is_shifted |= period[axis] > 0 && std::abs(x[axis] - y[axis]) > period[axis] / 2;
  return is_shifted && is_lattice_shift(x - y, period);
}

/// Points that are at least a period away from an end of all of them, along some axis: no other can
/// be an image.
std::vector<Index> possible_images(std::span<const Vec3> places, const Vec3& period) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  const double rounding = tolerance * period.maxCoeff();
  std::vector<Index> points;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3& x = places[i];
    const Vec3 reach = (box.max() - x).cwiseMax(x - box.min());
    bool reaches_image = false;
    for (int axis = 0; axis < 3; ++axis)
      reaches_image |= period[axis] > 0 && reach[axis] >= period[axis] - 2 * rounding;
    if (reaches_image) points.push_back(static_cast<Index>(i));
  }
  return points;
}

/// @return  for each axis whether points differ along it
std::array<bool, 3> unite_equal_positions(const Surface& surface, const Vec3& period,
                                          detail::DisjointSets& classes) {
  std::array<bool, 3> is_used{};
  for (const auto& [i, j] : periodic_pairs(surface.points, period)) {
    classes.unite(i, j);
    const Vec3 shift = surface.points[i] - surface.points[j];
    for (int axis = 0; axis < 3; ++axis)
      is_used[axis] = is_used[axis] || std::abs(shift[axis]) > period[axis] / 2;
  }
  return is_used;
}

void unite_matches(const Surface& surface, const Vec3& period, detail::DisjointSets& classes) {
  const auto is_used = unite_equal_positions(surface, period, classes);
  for (int axis = 0; axis < 3; ++axis)
    if (period[axis] > 0 && !is_used[axis])
      throw InputError(
          fmt::format("--period is {:.12g} along {}, but no two points of the surface differ by it "
                      "(to 1e-9 of it); give the period of the mesh, or 0 along that axis",
                      period[axis], "xyz"[axis]));
}

void unite_links(const Mesh& mesh, const Surface& surface, detail::DisjointSets& classes,
                 PeriodicPartners& partners) {
  if (mesh.periodic_links.empty()) return;
  const std::vector<Index> point = points_of_nodes(mesh, surface);
  const std::vector<SurfaceLink> links = links_of_surface(mesh, point);
  for (const SurfaceLink& link : links)
    if (joins_points(link, point)) set_period(mesh, link, partners.period);
  for (const SurfaceLink& link : links) {
    const bool is_translation = link.shift && is_lattice_shift(*link.shift, partners.period);
    for (const Pair& pair : link.pairs) {
      const Index slave = point[pair.slave], master = point[pair.master];
      if (slave < 0 || master < 0) {
        partners.unpaired[std::max(slave, master)] = 1;
        continue;
      }
      if (!is_translation) partners.rotated[slave] = partners.rotated[master] = 1;
      classes.unite(slave, master);
    }
  }
}

/// The period that is given, with those of the links along the other axes.
Vec3 common_period(const Vec3& given, const Vec3& linked) {
  check_period(given);
  Vec3 period = given;
  for (int axis = 0; axis < 3; ++axis) {
    if (linked[axis] == 0) continue;
    if (given[axis] > 0 && std::abs(given[axis] - linked[axis]) > tolerance * linked[axis])
      throw InputError(
          fmt::format("--period is {:.12g} along {}, but the links of the mesh have {:.12g}; leave "
                      "--period out",
                      given[axis], "xyz"[axis], linked[axis]));
    period[axis] = linked[axis];
  }
  return period;
}

void require_partners_of(const Surface& surface, const PeriodicPartners& partners) {
  if (partners.master.size() == surface.points.size() &&
      partners.rotated.size() == surface.points.size())
    return;
  throw InputError(fmt::format("partners of {} points for a surface of {}; make them of it",
                               partners.master.size(), surface.points.size()));
}

}  // namespace

PeriodicPartners periodic_partners(const Mesh& mesh, const Surface& surface,
                                   const std::optional<Vec3>& period) {
  PeriodicPartners partners = no_partners(surface);
  detail::DisjointSets classes(surface.points.size());
  unite_links(mesh, surface, classes, partners);
  if (period) {
    partners.period = common_period(*period, partners.period);
    unite_matches(surface, partners.period, classes);
  }
  take_classes(classes, partners);
  return partners;
}

std::vector<std::array<Index, 2>> periodic_pairs(std::span<const Vec3> points, const Vec3& period) {
  std::vector<std::array<Index, 2>> pairs;
  if (points.empty()) return pairs;
  Vec3 corner = points.front();
  for (const Vec3& x : points) corner = corner.cwiseMin(x);
  const std::vector<Index> possible = possible_images(points, period);
  std::vector<std::pair<Key, Index>> keys(possible.size());
  for (unsigned grids = 0; grids < 8; ++grids) {
    for (std::size_t i = 0; i < keys.size(); ++i)
      keys[i] = {key_of(points[possible[i]], corner, period, grids), possible[i]};
    detail::parallel_sort(std::span(keys), std::less<>());
    for (std::size_t i = 1, first = 0; i < keys.size(); ++i) {
      if (keys[i].first != keys[first].first) first = i;
      const Index a = keys[first].second, b = keys[i].second;
      if (are_images(points[b], points[a], period)) pairs.push_back({b, a});
    }
  }
  return pairs;
}

std::vector<Index> masters(const PeriodicPartners& partners) {
  std::vector<Index> result;
  for (std::size_t point = 0; point < partners.master.size(); ++point)
    if (partners.master[point] == static_cast<Index>(point))
      result.push_back(static_cast<Index>(point));
  return result;
}

// In the vector that comes: masters move to their points from the last on.
std::vector<double> expand(const PeriodicPartners& partners, std::vector<double> values) {
  const std::vector<Index>& master = partners.master;
  const auto is_master = [&](std::size_t i) { return master[i] == static_cast<Index>(i); };
  std::size_t n_masters = 0;
  for (std::size_t i = 0; i < master.size(); ++i) n_masters += is_master(i) ? 1 : 0;
  if (n_masters != values.size())
    throw InputError(
        fmt::format("{} values for {} masters; give one for each", values.size(), n_masters));
  values.resize(master.size());
  for (std::size_t i = master.size(); i-- > 0;)
    if (is_master(i)) values[i] = values[--n_masters];
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[master[i]];
  return values;
}

Surface with_partner_normals(const Surface& surface, const PeriodicPartners& partners) {
  require_partners_of(surface, partners);
  std::vector<Index> sharer = partners.master;
  for (std::size_t i = 0; i < sharer.size(); ++i)
    if (partners.rotated[i] != 0) sharer[i] = static_cast<Index>(i);
  Surface result = surface;
  detail::measure_shared_normals(result, sharer);
  return result;
}

}  // namespace roughmesh
