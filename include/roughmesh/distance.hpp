// SPDX-License-Identifier: BSD-3-Clause
// Distances between points of a surface.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

enum class DistanceKind {
  euclidean,
  great_circle,
  periodic,       ///< that of the nearest image; Correlation sums over all images
  minimum_image,  ///< that of the nearest image, alone
  curve           ///< along a curve
};

std::string_view name(DistanceKind kind);  ///< "euclidean", "great-circle", "minimum-image"

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

  /// | S (x - y + nL) | of the nearest image, n being whole numbers on the axes with a period
  /// (docs/math.md, eq. 25 and 27). `periodic` is positive definite through the sum over images
  /// that Correlation makes; `minimum_image`, the distance of Loth et al. (2020), in general is
  /// not.
  /// @param period      L, a length for each axis; 0: not periodic along it
  /// @param anisotropy  lengths as in stretched(), along the coordinate axes
  /// @throws InputError  a period that is negative or not finite, no period at all, turned axes,
  ///                     and as stretched()
  static Distance periodic(const Vec3& period,
                           const Anisotropy& anisotropy = {.lengths = {1, 1, 1}});
  static Distance minimum_image(const Vec3& period,
                                const Anisotropy& anisotropy = {.lengths = {1, 1, 1}});

  /// Between places (arc length, number of the piece, 0), as curve_places() makes them: |s - t| on
  /// one piece, the shorter way round where it is closed, infinite between pieces (docs/math.md,
  /// eq. 28).
  /// @param closed_lengths  for each piece its length if it is closed, else infinity
  /// @throws InputError  no piece, or a length that is not above 0
  static Distance curve(std::vector<double> closed_lengths);

  double operator()(const Vec3& x, const Vec3& y) const;
  DistanceKind kind() const { return kind_; }
  const Eigen::Matrix3d& stretch() const { return stretch_; }  ///< S; identity unless stretched
  const Vec3& period() const { return period_; }   ///< L; 0 along axes that are not periodic
  std::span<const double> closed_lengths() const;  ///< one per piece of a curve, else empty

 private:
  static Distance with_period(DistanceKind kind, const Vec3& period, const Anisotropy& anisotropy);
  double along_curve(const Vec3& x, const Vec3& y) const;

  DistanceKind kind_ = DistanceKind::euclidean;
  Eigen::Matrix3d stretch_ = Eigen::Matrix3d::Identity();
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 0;
  Vec3 period_ = Vec3::Zero();
  std::shared_ptr<const std::vector<double>> closed_lengths_;
};

}  // namespace roughmesh
