// SPDX-License-Identifier: BSD-3-Clause
// Points of a surface that are images of each other and carry one height.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

struct PeriodicPartners {
  /// n points: the first of all points, in canonical order, that this one is an image of; itself
  /// where it is none. Master of a master is itself.
  std::vector<Index> master;
  /// n flags: an image by something other than a translation by periods (a rotation, an oblique
  /// lattice). Such points keep normals of their own, so equal heights do not make equal
  /// displacements: heights must fade to zero there.
  std::vector<char> rotated;
  /// n flags: linked to a node that is on no chosen face and so stays: heights must fade to zero.
  std::vector<char> unpaired;
  Vec3 period = Vec3::Zero();  ///< 0 along axes that are not periodic
};

/// Partners by the links of the mesh between nodes of the surface, whatever side they call the
/// master, chains followed to the end. A link whose nodes differ by one vector along a coordinate
/// axis sets the period of that axis. Without a link to the surface no point is an image.
///
/// Where a period is given, also partners by position: points equal to 1e-9 of the period, modulo
/// that period and those of the links. Sorts: n log n.
///
/// @param period  for each axis, 0: not periodic along it, or as the links say
/// @throws InputError  nodes that differ by 1e-9 of the period from where their link puts them; two
///                     periods along one axis; a period that is negative or not finite, 0 along all
///                     axes, one that no two points differ by, or not that of the links
PeriodicPartners periodic_partners(const Mesh& mesh, const Surface& surface,
                                   const std::optional<Vec3>& period = {});

/// Pairs of points that differ by whole periods, to 1e-9 of the largest, enough of them to join all
/// images of each point. Sorts: n log n.
/// @param period  0 along axes that are not periodic; not 0 along all
std::vector<std::array<Index, 2>> periodic_pairs(std::span<const Vec3> points, const Vec3& period);

std::vector<Index> masters(const PeriodicPartners& partners);  ///< ascending points

/// Values for all n points.
/// @param values  of the masters, in the order of masters()
/// @throws InputError  another number of values than of masters
std::vector<double> expand(const PeriodicPartners& partners, std::vector<double> values);

/// The surface with one normal for each point and its images: from the faces of all of them
/// together (docs/math.md, eq. 31). Rotated points keep their own.
///
/// @throws InputError  partners of another surface; normals that cancel
Surface with_partner_normals(const Surface& surface, const PeriodicPartners& partners);

}  // namespace roughmesh
