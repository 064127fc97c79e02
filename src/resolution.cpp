// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/resolution.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "matching_points.hpp"
#include "parallel.hpp"
#include "polygon.hpp"

namespace roughmesh {
namespace {

constexpr std::size_t grain = 4096;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largest_h_over_l = 1 / sizes_per_length;
constexpr double largest_share_above_nyquist = 0.05;
constexpr double largest_rms_slope = 1;
// The largest edge may be this many times the median of the rule: the diagonals of squares (1.4)
// and the spread of usual triangulations must not warn.
constexpr double largest_edge_allowance = 2;

// ---- What the faces have in common: sums over triangles, or lines ----

// Sums over triangles or lines, per unit of Rq.
struct FaceSums {
  double area = 0;
  double slope_integral = 0;  ///< of the squared slope of the linear interpolant
  double field_area = 0;      ///< area (or length) in units of the field's own decorrelation
  double stretch_area = 0;    ///< area times squared tangential stretch, 2 where isotropic
};

FaceSums& operator+=(FaceSums& sums, const FaceSums& more) {
  sums.area += more.area;
  sums.slope_integral += more.slope_integral;
  sums.field_area += more.field_area;
  sums.stretch_area += more.stretch_area;
  return sums;
}

// Area of a triangle from the squares of its edges; 0 where they close no triangle.
double area_from_squares(const std::array<double, 3>& s) {
  const double sum = s[0] + s[1] + s[2];
  const double sum_of_squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
  return std::sqrt(std::max(0.0, sum * sum - 2 * sum_of_squares)) / 4;
}

FaceSums triangle_sums(const std::array<Index, 3>& corners, const Surface& surface,
                       const Correlation& correlation) {
  FaceSums sums;
  const Eigen::Matrix3d& stretch = correlation.distance().stretch();
  const std::array<Vec3, 3> x = {surface.points[corners[0]], surface.points[corners[1]],
                                 surface.points[corners[2]]};
  const Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]);
  const double twice_area = normal.norm();
  if (!(twice_area > 0)) return sums;
  std::array<double, 3> variogram{};  // E[(d_i - d_j)^2] over the edge opposite to each corner
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = x[(k + 1) % 3], &b = x[(k + 2) % 3];
    variogram[k] = 2 * (1 - correlation(corners[(k + 1) % 3], corners[(k + 2) % 3]));
    const double cotangent = (a - x[k]).dot(b - x[k]) / twice_area;
    sums.slope_integral += cotangent * variogram[k] / 2;
  }
  sums.area = twice_area / 2;
  sums.field_area = area_from_squares(variogram);
  sums.stretch_area =
      sums.area * (stretch.squaredNorm() - (stretch * normal / twice_area).squaredNorm());
  return sums;
}

// Along a line the interpolant has one slope (docs/math.md, eq. 39).
FaceSums line_sums(Index i, Index j, const Surface& surface, const Correlation& correlation) {
  FaceSums sums;
  const Vec3 line = surface.points[j] - surface.points[i];
  sums.area = line.norm();
  const double variogram = 2 * (1 - correlation(i, j));
  sums.slope_integral = variogram / sums.area;
  sums.field_area = std::sqrt(variogram);
  sums.stretch_area = (correlation.distance().stretch() * line).squaredNorm() / sums.area;
  return sums;
}

// Quadrangles count as the two triangles of a fan.
FaceSums face_sums(const Surface& surface, const Correlation& correlation) {
  const std::size_t n = surface.face_tags.size();
  std::vector<FaceSums> parts((n + grain - 1) / grain);
  detail::parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    FaceSums& part = parts[begin / grain];
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = surface.face(static_cast<Index>(f));
      if (surface.dimension == 1) part += line_sums(face[0], face[1], surface, correlation);
      for (std::size_t k = 2; k < face.size(); ++k)
        part += triangle_sums({face[0], face[k - 1], face[k]}, surface, correlation);
    }
  });
  FaceSums sums;
  for (const FaceSums& part : parts) sums += part;
  return sums;
}

// ---- Largest height ----

// Area and half the border of the surface, lengths being those of the field: the root mean square
// difference of two heights (docs/math.md, eq. 24). A curve has no area, and its whole length
// counts as the half border of a surface does (eq. 39).
struct FieldSize {
  double area = 0;
  double half_border = 0;
};

double half_border(const Surface& surface, const Correlation& correlation) {
  double sum = 0;
  for (const auto& [i, j] : surface.border_edges) sum += std::sqrt(2 * (1 - correlation(i, j)));
  return sum / 2;
}

FieldSize field_size(const Surface& surface, const FaceSums& sums, const Correlation& correlation) {
  if (surface.dimension == 1) return {0, sums.field_area};
  return {sums.field_area, half_border(surface, correlation)};
}

// Number of independent patches at the level u: expected Euler characteristic of the part above u
// over the probability that a single value is there, but no more than there are points.
double n_patches(double u, const FieldSize& size, double n_points) {
  const double exceedance = std::erfc(u / std::numbers::sqrt2) / 2;
  const double bell = std::exp(-u * u / 2) / (2 * std::numbers::pi);
  const double density =
      bell * (size.half_border + size.area * u / std::sqrt(2 * std::numbers::pi));
  return std::min(n_points, 1 + density / exceedance);
}

// E[max |d|] is the integral of P(max |d| > u) over u, here by Simpson's rule.
double expected_max_height(const FieldSize& size, double n_points) {
  constexpr int n_steps = 1200;
  constexpr double highest = 12;  // exceeded with probability 1e-20 among 1e12 patches
  constexpr double step = highest / n_steps;
  double sum = 1;  // u = 0, which is always exceeded
  for (int k = 1; k < n_steps; ++k) {
    const double u = k * step;
    const double below = std::log1p(-std::erfc(u / std::numbers::sqrt2));
    sum += -std::expm1(n_patches(u, size, n_points) * below) * (k % 2 == 1 ? 4 : 2);
  }
  return sum * step / 3;
}

// ---- Curvature ----

// Points with a face that leans away from their normal by more than 30 degrees stand on a sharp
// edge or corner, which has no radius of curvature.
std::vector<std::uint8_t> points_on_sharp_edges(const Surface& surface) {
  const double least_cosine = std::cos(std::numbers::pi / 6);
  std::vector<std::uint8_t> is_sharp(surface.points.size(), 0);
  detail::parallel_for(surface.face_tags.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = surface.face(static_cast<Index>(f));
      const Vec3 normal =
          detail::face_vector(detail::gather(face, surface.points).span(), surface.plane_normal);
      for (const Index i : face)
        if (surface.normals[i].dot(normal) < least_cosine * normal.norm())
          std::atomic_ref(is_sharp[i]).store(1, std::memory_order_relaxed);
    }
  });
  return is_sharp;
}

struct Curvature {
  double smooth = -1;  ///< over the edges without a sharp end
  double any = 0;      ///< over all edges

  void take(const Curvature& other) {
    smooth = std::max(smooth, other.smooth);
    any = std::max(any, other.any);
  }
};

Curvature curvature_of_face(const Surface& surface, Index number,
                            const std::vector<std::uint8_t>& is_sharp) {
  constexpr double flat = 1e-9;  // rounding of the normals of a plane
  Curvature result;
  const auto face = surface.face(number);
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Index i = face[k], j = face[(k + 1) % face.size()];
    const double turn = (surface.normals[i] - surface.normals[j]).norm();
    const double curvature =
        turn > flat ? turn / (surface.points[i] - surface.points[j]).norm() : 0;
    result.take({is_sharp[i] || is_sharp[j] ? -1 : curvature, curvature});
  }
  return result;
}

// Largest |n_i - n_j| / |x_i - x_j| over the edges without a sharp end; over all edges if none is
// left, as on an icosahedron. Exact on a sphere whose normals are.
double largest_curvature(const Surface& surface) {
  const std::vector<std::uint8_t> is_sharp = points_on_sharp_edges(surface);
  const std::size_t n = surface.face_tags.size();
  std::vector<Curvature> parts((n + grain - 1) / grain);
  detail::parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      parts[begin / grain].take(curvature_of_face(surface, static_cast<Index>(f), is_sharp));
  });
  Curvature largest;
  for (const Curvature& part : parts) largest.take(part);
  return largest.smooth >= 0 ? largest.smooth : largest.any;
}

// ---- Warnings ----

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

void warn_of_coarse_mesh(const Resolution& resolution, std::vector<std::string>& warnings) {
  const double length = *std::min_element(resolution.lengths.begin(), resolution.lengths.end());
  const double limit = largest_h_over_l * length;
  constexpr double rounding = 1 + 1e-9;
  if (resolution.mesh_size > limit * rounding)
    warnings.push_back(fmt::format(
        "the mesh is coarse for the correlation length: mesh size {:.3g} is above l/2.5 = {:.3g}, "
        "so linear elements miss {} of the roughness between the nodes; refine the surface to "
        "{:.3g} or take a correlation length of {:.3g} or more",
        resolution.mesh_size, limit, percent(resolution.interpolation_error), limit,
        resolution.mesh_size / largest_h_over_l));
  else if (resolution.largest_edge > largest_edge_allowance * limit)
    warnings.push_back(fmt::format(
        "the mesh is coarse in places: its median edge {:.3g} is fine for the correlation length, "
        "but its largest edge {:.3g} is above {:.3g}, twice what the length l asks for (l/2.5); "
        "refine "
        "the surface there",
        resolution.mesh_size, resolution.largest_edge, largest_edge_allowance * limit));
}

void warn_of_rough_spectrum(const Resolution& resolution, std::vector<std::string>& warnings) {
  if (!(resolution.spectrum_share_above_nyquist > largest_share_above_nyquist)) return;
  const std::string share = percent(resolution.spectrum_share_above_nyquist);
  if (resolution.field_slope)
    warnings.push_back(
        fmt::format("{} of the variance lies above the Nyquist wavenumber of the "
                    "mesh, {:.3g}; refine the surface or take a larger --length",
                    share, std::numbers::pi / resolution.mesh_size));
  else
    warnings.push_back(fmt::format(
        "{} of the variance lies above the Nyquist wavenumber of the mesh, {:.3g}: this is the "
        "nature of an autocorrelation without slopes; heights at the nodes are exact, but slopes "
        "grow as the mesh is refined, so compare results on meshes of one size",
        share, std::numbers::pi / resolution.mesh_size));
}

void warn_of_folds(const Resolution& resolution, double rq, std::vector<std::string>& warnings) {
  if (!(rq > resolution.largest_safe_rq)) return;
  warnings.push_back(fmt::format(
      "heights of up to {:.3g} are to be expected where the radius of curvature is {:.3g}: the "
      "surface may fold; take --rms {:.3g} or less",
      rq * resolution.expected_max_height, resolution.min_curvature_radius,
      resolution.largest_safe_rq));
}

void warn_of_slopes(const Resolution& resolution, double rq, std::vector<std::string>& warnings) {
  const double slope = rq * resolution.rms_slope;
  if (!(slope > largest_rms_slope)) return;
  warnings.push_back(
      fmt::format("the rms slope on this mesh is {:.3g} (1 is 45 degrees): faces stand on end, and "
                  "elements behind them get thin or turn over; take --rms {:.3g} or less, or a "
                  "larger correlation length",
                  slope, largest_rms_slope / resolution.rms_slope));
}

}  // namespace

Resolution assess_resolution(const Surface& surface, const Correlation& correlation) {
  detail::require_points_of(surface, correlation);
  const Autocorrelation& autocorrelation = correlation.autocorrelation();
  const Distance& distance = correlation.distance();
  Resolution result;
  const double h = surface.mesh_size.median;
  result.mesh_size = h;
  result.largest_edge = surface.mesh_size.max;
  double largest_stretch = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double stretch = distance.stretch().row(static_cast<Eigen::Index>(axis)).norm();
    result.lengths[axis] = autocorrelation.length() / stretch;
    result.h_over_l[axis] = h / result.lengths[axis];
    largest_stretch = std::max(largest_stretch, stretch);
  }
  // rho along the axis of the shortest length, where everything is worst.
  const auto rho = [&](double r) { return autocorrelation.rho(largest_stretch * r); };
  result.spectrum_share_above_nyquist = autocorrelation.spectrum_share_above(
      std::numbers::pi / (h * largest_stretch), surface.dimension);
  result.interpolation_error = std::sqrt(std::max(0.0, 1 + (1 + rho(h)) / 2 - 2 * rho(h / 2)));

  const FaceSums sums = face_sums(surface, correlation);
  result.rms_slope = std::sqrt(std::max(0.0, sums.slope_integral) / sums.area);
  if (const auto variance = autocorrelation.slope_variance())
    result.field_slope = std::sqrt(*variance * sums.stretch_area / sums.area);
  result.expected_max_height = expected_max_height(field_size(surface, sums, correlation),
                                                   static_cast<double>(surface.n_points()));
  const double curvature = largest_curvature(surface);
  result.min_curvature_radius = curvature > 0 ? 1 / curvature : infinity;
  result.largest_safe_rq = result.min_curvature_radius / result.expected_max_height;
  return result;
}

std::vector<std::string> resolution_warnings(const Resolution& resolution, double rq) {
  std::vector<std::string> warnings;
  warn_of_coarse_mesh(resolution, warnings);
  warn_of_rough_spectrum(resolution, warnings);
  for (std::string& warning : height_warnings(resolution, rq))
    warnings.push_back(std::move(warning));
  return warnings;
}

std::vector<std::string> height_warnings(const Resolution& resolution, double rq) {
  std::vector<std::string> warnings;
  warn_of_folds(resolution, rq, warnings);
  warn_of_slopes(resolution, rq, warnings);
  return warnings;
}

}  // namespace roughmesh
