// SPDX-License-Identifier: BSD-3-Clause
// Distances between points of a surface.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh {

/// Least-squares sphere through points: algebraic fit refined by Gauss-Newton on the radial
/// distance.
struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
  double deviation = 0;  ///< largest | |x - centre| - radius | over the points
};

/// @throws InputError  fewer than 4 points or points of a plane, through which no sphere is unique
Sphere fit_sphere(std::span<const Vec3> points);

/// Lengths of an anisotropic field along three orthogonal axes.
struct Anisotropy {
  std::array<double, 3> lengths{};  ///< each > 0; infinite only beside a finite one
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal columns
};

enum class DistanceKind { euclidean, great_circle };

std::string_view name(DistanceKind kind);  ///< "euclidean", "great-circle"

/// d(x, y), symmetric, d(x, x) = 0. A value; cheap to copy.
class Distance {
 public:
  static Distance euclidean();

  /// | S (x - y) | with S = diag(lengths[0..2])^-1 axes^T times the reference length, the first
  /// finite one, so that an Autocorrelation of the reference length gives the anisotropic field
  /// (docs/math.md, eq. 11).
  /// @throws InputError  lengths out of range, all infinite, axes that are not orthonormal to 1e-12
  static Distance stretched(const Anisotropy& anisotropy);

  /// Along the great circle of the sphere: radius times the angle between the directions from the
  /// centre. The angle comes from atan2(|a x b|, a . b), which has no domain to leave.
  static Distance great_circle(const Sphere& sphere);

  /// great_circle for the sphere fitted to the points.
  /// @throws InputError  deviation above 1e-3 of the radius: names the deviation
  static Distance great_circle(std::span<const Vec3> points);

  double operator()(const Vec3& x, const Vec3& y) const;
  DistanceKind kind() const { return kind_; }
  const Eigen::Matrix3d& stretch() const { return stretch_; }  ///< S; identity unless stretched

 private:
  DistanceKind kind_ = DistanceKind::euclidean;
  Eigen::Matrix3d stretch_ = Eigen::Matrix3d::Identity();
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 0;
};

}  // namespace roughmesh
