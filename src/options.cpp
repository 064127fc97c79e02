// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "roughmesh/resolution.hpp"

#include "file_formats.hpp"

namespace roughmesh {

std::string_view name(VolumeChoice choice) {
  switch (choice) {
    case VolumeChoice::move:
      return "move";
    case VolumeChoice::remesh:
      return "remesh";
    default:
      return "none";
  }
}

AutocorrelationOptions autocorrelation_options(const Roughness& o) {
  AutocorrelationOptions result{.family = o.acf,
                                .length = std::nullopt,
                                .length_definition = o.length_definition,
                                .nu = o.nu,
                                .hurst = o.hurst,
                                .rolloff = o.rolloff,
                                .power = o.power,
                                .alpha = o.alpha,
                                .table = {}};
  if (o.acf == Family::table && o.table.empty())
    throw InputError("--table: missing; give the file with the two columns of --acf table");
  if (!o.table.empty()) result.table = read_correlation_table(o.table);
  // Anisotropic lengths scale the distance; rho belongs to the first finite one. A single length is
  // taken as it is, so that the family can refuse it by name.
  if (!o.length.empty()) result.length = o.length.front();
  if (o.length.size() > 1)
    for (const double length : o.length)
      if (std::isfinite(length)) {
        result.length = length;
        break;
      }
  return result;
}

SurfaceOptions surface_options(const Roughness& o) {
  return {
      .groups = o.group, .flip = o.flip, .sharp_angle = o.edge_angle / 180.0 * std::numbers::pi};
}

FieldOptions field_options(const RoughenOptions& options, const Roughness& roughness) {
  return {.method = options.method, .tolerance = options.tolerance, .cutoff = roughness.cutoff};
}

namespace {

/// Unit vector along one of the axes; a direction has any size.
Vec3 direction(const Vec3& axis) {
  const double size = axis.stableNorm();
  if (!axis.allFinite() || !(size > 0) || !std::isfinite(size))
    throw InputError(fmt::format("axes: [{:g}, {:g}, {:g}] is no direction; give a finite vector",
                                 axis.x(), axis.y(), axis.z()));
  return axis / size;
}

void require_orthogonal(const Vec3& a, const Vec3& b) {
  constexpr double largest_cosine = 1e-6;  // directions typed with seven digits
  const double cosine = std::abs(a.dot(b));
  if (cosine > largest_cosine)
    throw InputError(
        fmt::format("axes: two of them enclose {:.6g} degrees; must be orthogonal to 1e-6",
                    std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi));
}

}  // namespace

Eigen::Matrix3d length_axes(const Roughness& o) {
  if (o.axes.empty())
    return Eigen::AngleAxisd(o.angle / 180.0 * std::numbers::pi, Vec3::UnitZ()).toRotationMatrix();
  if (o.axes.size() != 2 && o.axes.size() != 3)
    throw InputError(
        fmt::format("axes: {} directions; give those of the first two lengths, or of all three",
                    o.axes.size()));
  const Vec3 first = direction(o.axes[0]), second = direction(o.axes[1]);
  require_orthogonal(first, second);
  Eigen::Matrix3d columns;
  columns.col(0) = first;
  columns.col(1) = (second - first.dot(second) * first).normalized();
  columns.col(2) = columns.col(0).cross(columns.col(1));
  if (o.axes.size() < 3) return columns;
  const Vec3 third = direction(o.axes[2]);  // whichever way round: lengths know no sign
  require_orthogonal(first, third);
  require_orthogonal(second, third);
  return columns;
}

namespace {

Fade parse_fade(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string number = text.substr(0, colon);
  Fade fade{.width = 0, .group = colon == text.npos ? "" : text.substr(colon + 1)};
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, fade.width);
  if (error != std::errc() || stop != end || !(fade.width > 0) || !std::isfinite(fade.width) ||
      (colon != text.npos && fade.group.empty()))
    throw InputError(fmt::format(
        "--fade: {}; must be a positive WIDTH or WIDTH:GROUP, such as 0.5:inlet", text));
  return fade;
}

}  // namespace

MaskOptions mask_options(const Roughness& o) {
  MaskOptions options;
  options.fixed = o.fixed;
  for (const std::string& text : o.fade) options.fade.push_back(parse_fade(text));
  for (const Mask& mask : o.mask) {
    if (const auto* box = std::get_if<BoxMask>(&mask)) options.boxes.push_back(*box);
    if (const auto* sphere = std::get_if<SphereMask>(&mask)) options.spheres.push_back(*sphere);
    if (const auto* formula = std::get_if<FormulaMask>(&mask)) options.formulas.push_back(*formula);
  }
  return options;
}

WriteOptions write_options(const RoughenOptions& o) {
  WriteOptions options{.format = o.format};
  if (o.ascii) options.encoding = Encoding::text;
  if (o.binary) options.encoding = Encoding::binary;
  return options;
}

namespace {

/// Along its shortest axis, in the sense of the formula; nothing without a length.
std::optional<double> shortest_length(const Roughness& o) {
  if (o.length.empty() && !o.rolloff && o.table.empty()) return std::nullopt;
  if (o.length.size() > 1) return *std::min_element(o.length.begin(), o.length.end());
  return Autocorrelation(autocorrelation_options(o)).length();
}

}  // namespace

GeometryOptions geometry_options(const RoughenOptions& o) {
  GeometryOptions options;
  options.gmsh = o.gmsh;
  options.timeout = o.timeout;
  options.trust_scripts = o.trust_scripts;
  if (o.round) options.round = *o.round;
  options.sharp_angle = o.surfaces.front().edge_angle / 180 * std::numbers::pi;
  if (o.mesh_size) options.mesh_size = *o.mesh_size;
  // A script knows its own sizes.
  if (o.mesh_size || detail::lower_extension(o.input) == ".geo") return options;
  double shortest = std::numeric_limits<double>::infinity();
  for (const Roughness& surface : o.surfaces)
    shortest = std::min(shortest, shortest_length(surface).value_or(shortest));
  if (!std::isfinite(shortest))
    throw InputError(
        "--mesh-size: missing; CAD files need it, or --length, of which it is 1 / 2.5");
  options.mesh_size = shortest / sizes_per_length;
  return options;
}

bool same_field(const Roughness& a, const Roughness& b) {
  const auto key = [](const Roughness& o) {
    return std::tie(o.seed, o.length, o.acf, o.length_definition, o.nu, o.hurst, o.rolloff, o.power,
                    o.alpha, o.table, o.angle, o.axes, o.cutoff, o.distance, o.period);
  };
  return key(a) == key(b);
}

}  // namespace roughmesh
