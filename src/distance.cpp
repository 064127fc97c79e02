// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "nearest_image.hpp"

namespace roughmesh {
namespace {

// Points about their mean, in units of their root mean square distance from it: neither a far
// origin nor the length unit costs digits.
struct NormalizedPoints {
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows;
  Vec3 mean = Vec3::Zero();
  double scale = 0;
};

NormalizedPoints normalized(std::span<const Vec3> points) {
  NormalizedPoints result;
  const auto n = static_cast<Eigen::Index>(points.size());
  result.rows.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) result.rows.row(i) = (points[i] - points[0]).transpose();
  const Vec3 mean = result.rows.colwise().mean().transpose();
  result.rows.rowwise() -= mean.transpose();
  result.mean = points[0] + mean;
  const double size = result.rows.cwiseAbs().maxCoeff();
  result.scale =
      size > 0 ? size * std::sqrt((result.rows / size).rowwise().squaredNorm().mean()) : 0.0;
  if (result.scale > 0) result.rows /= result.scale;
  return result;
}

// Rounded coordinates far from the origin leave a plane by their rounding error.
bool lie_in_a_plane(const NormalizedPoints& points) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const Eigen::Matrix3d moments = points.rows.transpose() * points.rows;
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors().col(0);
  const double thickness = (points.rows * normal).cwiseAbs().maxCoeff();
  return !(thickness > 1e-9 + 16 * epsilon * points.mean.norm() / points.scale);
}

// Least squares of |x|^2 = 2 c . x + k, which is linear in c and k.
Sphere algebraic_fit(const NormalizedPoints& points) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> matrix(points.rows.rows(), 4);
  matrix << 2 * points.rows, Eigen::VectorXd::Ones(points.rows.rows());
  const Eigen::Vector4d solution =
      matrix.colPivHouseholderQr().solve(points.rows.rowwise().squaredNorm());
  const Vec3 centre = solution.head<3>();
  return {centre, std::sqrt(std::max(0.0, solution[3] + centre.squaredNorm())), 0};
}

// Gauss-Newton on |x - c| - R (docs/math.md, eq. 13). The algebraic fit is exact for points on a
// sphere, so that few steps are needed for points near one.
Sphere geometric_fit(const NormalizedPoints& points) {
  constexpr int most_steps = 50;
  Sphere sphere = algebraic_fit(points);
  Eigen::Matrix<double, Eigen::Dynamic, 4> jacobian(points.rows.rows(), 4);
  Eigen::VectorXd residual(points.rows.rows());
  for (int step = 0; step < most_steps; ++step) {
    for (Eigen::Index i = 0; i < points.rows.rows(); ++i) {
      const Vec3 arm = points.rows.row(i).transpose() - sphere.centre;
      jacobian.row(i) << -arm.normalized().transpose(), -1;
      residual[i] = arm.norm() - sphere.radius;
    }
    const Eigen::Vector4d change = -jacobian.colPivHouseholderQr().solve(residual);
    sphere.centre += change.head<3>();
    sphere.radius += change[3];
    if (change.norm() <= 1e-14 * (1 + sphere.radius)) break;
  }
  return sphere;
}

void check_period(const Vec3& period) {
  for (const double length : period)
    if (!(length >= 0) || !std::isfinite(length))
      throw InputError(
          fmt::format("a period of {} along an axis; --period must be greater than 0, or 0 along "
                      "an axis that is not periodic",
                      length));
  if (period.isZero(0))
    throw InputError("no axis has a period; give --period or choose --distance euclidean");
}

double relative_length(double reference, double length) {
  return length == reference ? 1 : reference / length;
}

}  // namespace

Sphere fit_sphere(std::span<const Vec3> points) {
  if (points.size() < 4)
    throw InputError(
        fmt::format("a sphere through {} points is not unique; 4 are needed", points.size()));
  const NormalizedPoints scaled = normalized(points);
  if (!(scaled.scale > 0) || !std::isfinite(scaled.scale) || lie_in_a_plane(scaled))
    throw InputError(
        fmt::format("no sphere is unique through {} points of a plane; choose "
                    "--distance euclidean or a curved surface",
                    points.size()));
  Sphere sphere = geometric_fit(scaled);
  sphere.centre = scaled.mean + scaled.scale * sphere.centre;
  sphere.radius *= scaled.scale;
  for (const Vec3& x : points)
    sphere.deviation =
        std::max(sphere.deviation, std::abs((x - sphere.centre).norm() - sphere.radius));
  return sphere;
}

std::string_view name(DistanceKind kind) {
  switch (kind) {
    case DistanceKind::euclidean:
      break;
    case DistanceKind::great_circle:
      return "great-circle";
    case DistanceKind::periodic:
      return "periodic";
    case DistanceKind::minimum_image:
      return "minimum-image";
    case DistanceKind::curve:
      return "curve";
  }
  return "euclidean";
}

Distance Distance::euclidean() { return {}; }

Distance Distance::stretched(const Anisotropy& anisotropy) {
  const auto& lengths = anisotropy.lengths;
  for (const double length : lengths)
    if (!(length > 0))
      throw InputError(
          fmt::format("a correlation length of {} along an axis; --length must be "
                      "greater than 0, or infinite beside a finite one",
                      length));
  const auto* reference =
      std::find_if(lengths.begin(), lengths.end(), [](double l) { return std::isfinite(l); });
  if (reference == lengths.end())
    throw InputError("all three lengths along the axes are infinite; give a finite one");
  const Eigen::Matrix3d defect =
      anisotropy.axes.transpose() * anisotropy.axes - Eigen::Matrix3d::Identity();
  if (!(defect.norm() <= 1e-12))
    throw InputError(
        fmt::format("the axes of the lengths are not orthonormal: off by {:.3g}; give "
                    "orthogonal unit vectors",
                    defect.norm()));
  Distance result;
  if (lengths[1] == lengths[0] && lengths[2] == lengths[0]) return result;  // whatever the axes
  const Vec3 scales(relative_length(*reference, lengths[0]),
                    relative_length(*reference, lengths[1]),
                    relative_length(*reference, lengths[2]));
  result.stretch_ = scales.asDiagonal() * anisotropy.axes.transpose();
  return result;
}

Distance Distance::great_circle(const Sphere& sphere) {
  if (!(sphere.radius > 0) || !std::isfinite(sphere.radius))
    throw InputError(
        fmt::format("the radius of the sphere is {}; great-circle distance needs one "
                    "greater than 0",
                    sphere.radius));
  Distance result;
  result.kind_ = DistanceKind::great_circle;
  result.centre_ = sphere.centre;
  result.radius_ = sphere.radius;
  return result;
}

Distance Distance::great_circle(std::span<const Vec3> points) {
  constexpr double largest_deviation = 1e-3;
  const Sphere sphere = fit_sphere(points);
  if (!(sphere.deviation <= largest_deviation * sphere.radius))
    throw InputError(
        fmt::format("the surface is not a sphere: its points leave the best one, of "
                    "radius {:.6g}, by up to {:.3g}, and {:.3g} is allowed; choose "
                    "--distance euclidean",
                    sphere.radius, sphere.deviation, largest_deviation * sphere.radius));
  return great_circle(sphere);
}

Distance Distance::with_period(DistanceKind kind, const Vec3& period,
                               const Anisotropy& anisotropy) {
  check_period(period);
  Distance result = stretched(anisotropy);
  Eigen::Matrix3d off_diagonal = result.stretch_;
  off_diagonal.diagonal().setZero();
  if (!off_diagonal.isZero(0))
    throw InputError(
        fmt::format("--angle or axes turn the directions of the lengths, but --distance {} needs "
                    "lengths along the axes of the period; leave them out",
                    name(kind)));
  result.kind_ = kind;
  result.period_ = period;
  return result;
}

Distance Distance::periodic(const Vec3& period, const Anisotropy& anisotropy) {
  return with_period(DistanceKind::periodic, period, anisotropy);
}

Distance Distance::minimum_image(const Vec3& period, const Anisotropy& anisotropy) {
  return with_period(DistanceKind::minimum_image, period, anisotropy);
}

Distance Distance::curve(std::vector<double> closed_lengths) {
  if (closed_lengths.empty())
    throw InputError("distance along a curve without pieces; select lines");
  for (const double length : closed_lengths)
    if (!(length > 0))
      throw InputError(
          fmt::format("a piece of the curve has length {}; it must be greater than 0", length));
  Distance result;
  result.kind_ = DistanceKind::curve;
  result.closed_lengths_ = std::make_shared<const std::vector<double>>(std::move(closed_lengths));
  return result;
}

std::span<const double> Distance::closed_lengths() const {
  return closed_lengths_ ? std::span<const double>(*closed_lengths_) : std::span<const double>();
}

double Distance::along_curve(const Vec3& x, const Vec3& y) const {
  if (x.y() != y.y()) return std::numeric_limits<double>::infinity();
  const double length = (*closed_lengths_)[static_cast<std::size_t>(x.y())];
  const double arc = std::abs(x.x() - y.x());
  return std::min(arc, std::abs(length - arc));
}

double Distance::operator()(const Vec3& x, const Vec3& y) const {
  if (kind_ == DistanceKind::euclidean) return (stretch_ * (x - y)).norm();
  if (kind_ == DistanceKind::curve) return along_curve(x, y);
  if (kind_ != DistanceKind::great_circle)
    return (stretch_ * detail::nearest_image(x - y, period_)).norm();
  const Vec3 a = x - centre_, b = y - centre_;
  return radius_ * std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace roughmesh
