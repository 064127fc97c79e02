// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "roughmesh/options.hpp"

#include "output_template.hpp"

namespace roughmesh {
namespace {

void require(bool good, std::string_view option, double value, std::string_view range) {
  if (!good) throw InputError(fmt::format("{}: {:g}; must be {}", option, value, range));
}

/// Far beyond any mesh in any unit, and squares of these are still numbers.
void require_length(std::string_view option, double value) {
  require(value >= 1e-100 && value <= 1e100, option, value,
          "a positive number between 1e-100 and 1e100");
}

std::filesystem::path normal(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

/// Is this the path of one of the realizations of the run?
bool is_realization(const RoughenOptions& o, const std::filesystem::path& path) {
  const std::string text = path.string(), output = normal(o.output).string();
  const std::size_t begin = detail::placeholder_begin(output);
  if (begin == output.npos) return text == output;
  std::uint64_t number = 0;
  if (begin >= text.size() ||
      std::from_chars(text.data() + begin, text.data() + text.size(), number).ec != std::errc())
    return false;
  return number >= o.first && number - o.first < o.realizations &&
         normal(output_path(o.output, number)) == path;
}

/// The report must not take the place of a file of the same run.
void check_report(const RoughenOptions& o) {
  if (o.output.empty()) return;
  const std::filesystem::path report = normal(report_path(o));
  bool is_taken = is_realization(o, report) || (!o.input.empty() && normal(o.input) == report);
  for (const Roughness& surface : o.surfaces)
    is_taken |= !surface.table.empty() && normal(surface.table) == report;
  if (is_taken)
    throw InputError(
        fmt::format("--report: {}; is another file of this run, name a new one", report_path(o)));
}

void check_ensemble(const RoughenOptions& o) {
  if (detail::without_placeholders(o.output).find_first_of("{}") != std::string::npos)
    throw InputError(fmt::format(
        "OUTPUT: {}; braces hold {{realization}}, or {{realization:04}} for leading zeros",
        o.output));
  require(o.realizations >= 1, "--realizations", static_cast<double>(o.realizations), "at least 1");
  if (o.first > std::numeric_limits<std::uint64_t>::max() - o.realizations)
    throw InputError(
        fmt::format("--first: {}; --first plus --realizations must stay below 2^64", o.first));
  if (o.realizations > 1 && !o.output.empty() &&
      detail::placeholder_begin(o.output) == std::string::npos)
    throw InputError(
        fmt::format("OUTPUT: {}; must contain {{realization}} when --realizations is {}", o.output,
                    o.realizations));
}

bool is_along_surface(const Roughness& o) {
  return o.distance == DistanceKind::great_circle || o.distance == DistanceKind::curve;
}

void check_axes(const Roughness& o) {
  if (o.angle == 0 && o.axes.empty()) return;
  const std::string given = o.axes.empty() ? fmt::format("--angle: {:g}", o.angle) : "axes";
  if (o.length.size() < 2)
    throw InputError(
        fmt::format("{}; turns the axes of anisotropic lengths, give --length L,LY,LZ", given));
  if (!o.axes.empty() && o.angle != 0)
    throw InputError(
        fmt::format("axes: not together with --angle {:g}; give one of them", o.angle));
  length_axes(o);
}

void check_lengths(const Roughness& o) {
  if (o.length.size() > 3)
    throw InputError(fmt::format("--length: {} numbers; give one, two or three", o.length.size()));
  std::size_t n_infinite = 0;
  for (const double length : o.length) {
    if (length == std::numeric_limits<double>::infinity() && o.length.size() > 1)
      ++n_infinite;
    else
      require_length("--length", length);
  }
  if (n_infinite > 0 && n_infinite == o.length.size())
    throw InputError("--length: every one is infinite; give a finite one beside");
  if (o.rolloff) require_length("--rolloff", *o.rolloff);
  if (o.length.size() > 1 && is_along_surface(o))
    throw InputError(
        fmt::format("--length: {} numbers; anisotropic lengths do not go with "
                    "--distance {}",
                    o.length.size(), name(*o.distance)));
  check_axes(o);
}

void check_period(const Roughness& o) {
  if (o.period.empty()) return;
  const bool is_used = !o.distance || o.distance == DistanceKind::periodic ||
                       o.distance == DistanceKind::minimum_image;
  if (o.period.size() != 3)
    throw InputError(fmt::format("--period: {} numbers; give LX,LY,LZ with 0 for an axis without",
                                 o.period.size()));
  if (!is_used)
    throw InputError(fmt::format("--period: goes with --distance periodic or minimum-image, not {}",
                                 name(*o.distance)));
  for (const double period : o.period)
    if (period != 0) require_length("--period", period);
}

/// Method, cutoff and distance; what does not go together is told before the mesh is read.
void check_method(const RoughenOptions& o, const Roughness& surface) {
  if (surface.cutoff) require_length("--cutoff", *surface.cutoff);
  const bool has_lattice =
      !is_along_surface(surface) && surface.distance != DistanceKind::minimum_image;
  if (o.method == Method::lattice && !has_lattice)
    throw InputError(
        fmt::format("--method: lattice; knows --distance euclidean and periodic, not {}; take "
                    "--method cholesky",
                    name(*surface.distance)));
  if (surface.cutoff && o.method == Method::cholesky)
    throw InputError(fmt::format(
        "--cutoff: {:g}; only --method lattice leaves out short scales, not cholesky; leave one of "
        "them out",
        *surface.cutoff));
  if (surface.cutoff && !has_lattice)
    throw InputError(fmt::format(
        "--cutoff: {:g}; goes with --distance euclidean and periodic, not {}; leave it out",
        *surface.cutoff, name(*surface.distance)));
}

/// A measured autocorrelation that is no mixture of Gaussians.
void check_table(const RoughenOptions& o, const Roughness& surface, const Autocorrelation& rho) {
  if (rho.family() != Family::table || !rho.gaussian_terms().empty()) return;
  if (o.method != Method::lattice && !surface.cutoff) return;
  throw InputError(fmt::format(
      "--table: {}; no mixture of Gaussians meets it to better than {:.2g}, and {} needs one; {}",
      surface.table, *rho.fit_residual(), surface.cutoff ? "--cutoff" : "--method lattice",
      surface.cutoff ? "leave it out" : "take --method cholesky"));
}

/// One so short leaves out nothing that a number could tell.
void check_cutoff(const Roughness& surface, const Autocorrelation& rho) {
  constexpr double shortest = 1e-9;
  if (surface.cutoff && !(*surface.cutoff >= shortest * rho.length()))
    throw InputError(
        fmt::format("--cutoff: {:g}; is below {:g} of the correlation length {:g}, so that nothing "
                    "is left out; leave it away or check the unit",
                    *surface.cutoff, shortest, rho.length()));
}

void check_shape(const RoughenOptions& o, const Roughness& surface) {
  require(surface.edge_angle > 0 && surface.edge_angle <= 180, "--edge-angle", surface.edge_angle,
          "above 0 and at most 180 degrees");
  require(std::isfinite(surface.angle), "--angle", surface.angle, "a finite number of degrees");
  check_lengths(surface);
  check_period(surface);
  check_method(o, surface);
  mask_options(surface);
}

void check_roughness(const RoughenOptions& o, const Roughness& surface) {
  if (surface.rms == 0)
    throw InputError("--rms: missing or 0; give the rms roughness, a positive number");
  require_length("--rms", surface.rms);
  check_shape(o, surface);
  // Throws for a parameter that is missing, foreign to the family or out of range.
  const Autocorrelation rho(autocorrelation_options(surface));
  check_table(o, surface, rho);
  check_cutoff(surface, rho);
}

/// Distances over one body or curve do not reach from one surface to another.
bool can_be_shared(const Roughness& o) {
  return o.distance != DistanceKind::great_circle && o.distance != DistanceKind::curve;
}

/// Two fields drawn from the same random numbers would resemble each other in no useful way.
void check_seeds(const std::vector<Roughness>& surfaces) {
  for (std::size_t j = 0; j < surfaces.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      if (surfaces[i].seed != surfaces[j].seed) continue;
      if (same_field(surfaces[i], surfaces[j]) && can_be_shared(surfaces[j])) continue;
      const std::string why =
          same_field(surfaces[i], surfaces[j])
              ? fmt::format("--distance {} does not reach from one to the other",
                            name(*surfaces[j].distance))
              : "different autocorrelation";
      throw InputError(fmt::format(
          "surfaces {} and {} have the same seed {}, but {}; give one of them another seed", i + 1,
          j + 1, surfaces[i].seed, why));
    }
}

void check_surfaces(const RoughenOptions& o) {
  const std::vector<Roughness>& surfaces = o.surfaces;
  if (surfaces.empty()) throw InputError("surface: an empty list; describe at least one surface");
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    try {
      check_roughness(o, surfaces[i]);
    } catch (const InputError& error) {
      if (surfaces.size() == 1) throw;
      throw InputError(fmt::format("surface {}: {}", i + 1, error.what()));
    }
    if (surfaces.size() > 1 && surfaces[i].group.empty())
      throw InputError(
          fmt::format("surface {}: no group; name one where there are several surfaces", i + 1));
  }
  check_seeds(surfaces);
}

void check_tolerance(const RoughenOptions& o) {
  require(o.tolerance > 0 && o.tolerance < 1, "--tolerance", o.tolerance,
          "a number between 0 and 1, exclusive");
}

void check_volume(const RoughenOptions& o) {
  if (!o.box) return;
  if (o.volume != VolumeChoice::remesh)
    throw InputError(fmt::format(
        "--box: {:g}; the space up to the box is meshed by --volume remesh only; give that too",
        *o.box));
  require(std::isfinite(*o.box) && *o.box > 1, "--box", *o.box, "above 1");
}

void check_files(const RoughenOptions& o) {
  if (o.ascii && o.binary)
    throw InputError("--ascii: not together with --binary; give one of them");
  if (o.mesh_size) require_length("--mesh-size", *o.mesh_size);
  if (o.round) require_length("--round", *o.round);
  require(std::isfinite(o.timeout) && o.timeout > 0, "--timeout", o.timeout,
          "a positive number of seconds");
}

}  // namespace

void check_field_options(const RoughenOptions& o) {
  check_tolerance(o);
  for (const Roughness& surface : o.surfaces) check_shape(o, surface);
}

void check_options(const RoughenOptions& o) {
  require(o.threads >= 0 && o.threads <= 4096, "--threads", o.threads, "from 0 to 4096");
  check_ensemble(o);
  check_report(o);
  check_files(o);
  check_volume(o);
  check_tolerance(o);
  check_surfaces(o);
}

}  // namespace roughmesh
