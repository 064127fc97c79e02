// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/displace.hpp"

#include <algorithm>
#include <tuple>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "disjoint_sets.hpp"

namespace roughmesh {
namespace {

// A height that is asked for at a node, along a normal.
struct Demand {
  Vec3 normal;
  double height = 0;
};

// Singular values of the matrix of normals below this are cut (docs/math.md, eq. 36).
constexpr double least_singular_value = 0.5;

// The smallest u with normal . u = height for all demands, in the sense of least squares.
Vec3 smallest_displacement(std::span<const Demand> demands) {
  if (demands.size() == 1) return demands.front().height * demands.front().normal;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vec3 load = Vec3::Zero();
  for (const Demand& demand : demands) {
    matrix += demand.normal * demand.normal.transpose();
    load += demand.height * demand.normal;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(matrix);
  Vec3 u = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const double square = modes.eigenvalues()[k];  // of a singular value
    const Vec3 mode = modes.eigenvectors().col(k);
    if (square >= least_singular_value * least_singular_value) u += mode.dot(load) / square * mode;
  }
  return u;
}

// Moved nodes that move together: those at one point of a surface, and so on from each of them.
class Groups {
 public:
  Groups(std::span<const Surface> surfaces, std::span<const Index> moved) : sets_(moved.size()) {
    for (const Surface& surface : surfaces) {
      places_.push_back(places_of(surface, moved));
      std::vector<Index> first(surface.points.size(), -1);
      for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
        Index& of_point = first[surface.point_of_node[i]];
        if (of_point < 0)
          of_point = places_.back()[i];
        else
          sets_.unite(of_point, places_.back()[i]);
      }
    }
  }

  /// Group of node i of a surface, and of the moved node.
  Index of(std::size_t surface, std::size_t i) { return sets_.smallest(places_[surface][i]); }
  Index of(std::size_t moved) { return sets_.smallest(static_cast<Index>(moved)); }

 private:
  static std::vector<Index> places_of(const Surface& surface, std::span<const Index> moved) {
    std::vector<Index> places;
    places.reserve(surface.nodes.size());
    auto at = moved.begin();
    for (const Index node : surface.nodes) {
      while (*at != node) ++at;
      places.push_back(static_cast<Index>(at - moved.begin()));
    }
    return places;
  }

  detail::DisjointSets sets_;
  std::vector<std::vector<Index>> places_;  // of the nodes of each surface among the moved ones
};

// A point of a surface at which the nodes of a group are.
struct GroupPoint {
  Index group;
  std::size_t surface;
  Index point;

  friend bool operator==(const GroupPoint&, const GroupPoint&) = default;
  friend bool operator<(const GroupPoint& a, const GroupPoint& b) {
    return std::tie(a.group, a.surface, a.point) < std::tie(b.group, b.surface, b.point);
  }
};

// Sorted by group, each once.
std::vector<GroupPoint> collect(std::span<const Surface> surfaces, Groups& groups) {
  std::vector<GroupPoint> entries;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t i = 0; i < surfaces[s].nodes.size(); ++i)
      entries.push_back({groups.of(s, i), s, surfaces[s].point_of_node[i]});
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  return entries;
}

void require_size(const Surface& surface, std::size_t n_heights) {
  if (n_heights != surface.points.size())
    throw InputError(fmt::format("{} heights for a surface of {} points; give one per point",
                                 n_heights, surface.points.size()));
}

// At one surface no node has a choice.
std::vector<Vec3> displace_nodes_of(const Surface& surface, std::span<const double> heights) {
  const std::vector<Vec3> at_points = displace(surface, heights);
  std::vector<Vec3> at_nodes;
  at_nodes.reserve(surface.nodes.size());
  for (const Index point : surface.point_of_node) at_nodes.push_back(at_points[point]);
  return at_nodes;
}

}  // namespace

std::vector<Vec3> displace(const Surface& surface, std::span<const double> heights) {
  require_size(surface, heights.size());
  std::vector<Vec3> displacements(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    displacements[i] = heights[i] * surface.normals[i];
  return displacements;
}

std::vector<Index> moved_nodes(std::span<const Surface> surfaces) {
  if (surfaces.size() == 1) return surfaces.front().nodes;
  std::vector<Index> nodes;
  for (const Surface& surface : surfaces)
    nodes.insert(nodes.end(), surface.nodes.begin(), surface.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::vector<Vec3> displace_nodes(std::span<const Surface> surfaces,
                                 std::span<const std::vector<double>> heights) {
  if (surfaces.size() != heights.size())
    throw InputError(fmt::format("heights of {} surfaces for {}; give one list per surface",
                                 heights.size(), surfaces.size()));
  for (std::size_t s = 0; s < surfaces.size(); ++s) require_size(surfaces[s], heights[s].size());
  if (surfaces.size() == 1) return displace_nodes_of(surfaces.front(), heights.front());

  const std::vector<Index> moved = moved_nodes(surfaces);
  Groups groups(surfaces, moved);
  const std::vector<GroupPoint> entries = collect(surfaces, groups);
  std::vector<Vec3> of_group(moved.size(), Vec3::Zero());
  std::vector<Demand> demands;
  for (auto first = entries.begin(); first != entries.end();) {
    demands.clear();
    auto next = first;
    for (; next != entries.end() && next->group == first->group; ++next)
      // A height of exactly 0 is a mask's: it leaves the node to the other surfaces.
      if (const double height = heights[next->surface][next->point]; height != 0)
        demands.push_back({surfaces[next->surface].normals[next->point], height});
    of_group[first->group] = smallest_displacement(demands);
    first = next;
  }
  std::vector<Vec3> displacements(moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) displacements[i] = of_group[groups.of(i)];
  return displacements;
}

}  // namespace roughmesh
