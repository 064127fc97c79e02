// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "roughmesh/pipeline.hpp"

#include "commands.hpp"
#include "interrupt.hpp"
#include "progress.hpp"

namespace roughmesh::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void require_files(const RoughenOptions& options) {
  if (options.input.empty())
    throw InputError(
        "INPUT: missing; give the mesh to roughen: roughmesh roughen INPUT -o OUTPUT --rms "
        "VALUE --length L");
  if (options.output.empty())
    throw InputError(
        "OUTPUT: missing; give the file to write with -o, e.g. -o rough_{realization}.msh");
}

void print_statistics(const SurfaceStatistics& s) {
  fmt::print("  Sq {:.4g} (expected {:.4g} +- {:.2g})", s.heights.sq, s.sq_expected,
             s.sq_expected_std);
  if (s.unfaded)
    fmt::print(", where not faded {:.4g} (expected {:.4g} +- {:.2g})", s.unfaded->sq,
               s.unfaded->expected, s.unfaded->expected_std);
  fmt::print("  Ssk {:.2f}  Sku {:.2f}", s.heights.ssk, s.heights.sku);
}

std::string method_in_words(const FieldSummary& field) {
  if (field.cholesky)
    return fmt::format("{} of rank {}", name(field.cholesky->factorization), field.cholesky->rank);
  const LatticeSummary& lattice = *field.lattice;
  const std::size_t n = lattice.terms.size();
  return fmt::format(
      "lattice of {} Gaussian{}{}{}", n, n == 1 ? "" : "s",
      lattice.lost_variance > 0
          ? fmt::format(", {:.2g} % of the variance below the cutoff", 100 * lattice.lost_variance)
          : "",
      lattice.same_on_other_meshes ? ", same heights on other meshes" : "");
}

void print_summary(const Report& report, const std::string& path_of_report) {
  for (const RealizationReport& r : report.realizations) {
    fmt::print("{}", r.path);
    for (std::size_t s = 0; s < r.surfaces.size(); ++s) {
      if (r.surfaces.size() > 1) fmt::print("  {}:", list_of(report.surfaces[s].groups));
      print_statistics(r.surfaces[s]);
    }
    fmt::print("  min quality {:.3g} (before {:.3g})\n", r.min_quality, r.min_quality_before);
  }
  for (const SurfaceReport& surface : report.surfaces)
    fmt::print("{}  {} nodes, {}, covariance error {:.2g}\n", list_of(surface.groups),
               surface.nodes, method_in_words(surface.field), surface.audit.covariance_error);
  fmt::print("{}  {:.2f} s\n", path_of_report, report.timings.total);
}

void print_warnings(const Report& report) {
  for (const std::string& warning : report.warnings)
    fmt::print(stderr, "warning: {}\n", printable(warning));
}

/// Keeps the report on disk up to date while realizations are made, so that after an interrupt or
/// an error the finished ones are described.
class ReportFile {
 public:
  ReportFile(std::string path, Clock::time_point start, double read_seconds)
      : path_(std::move(path)), start_(start), read_seconds_(read_seconds) {}

  /// Takes over what a report that only grows has more than the last time, and writes at most once
  /// a second: an ensemble of thousands would copy and write its report thousands of times.
  void update(const Report& report) {
    if (latest_.realizations.empty()) {
      latest_ = report;
    } else {
      append_rest(report.realizations, latest_.realizations);
      append_rest(report.warnings, latest_.warnings);
      latest_.timings = report.timings;
    }
    if (!written_ || seconds_since(*written_) > pause_) write();
  }

  void finish(Report report) {
    latest_ = std::move(report);
    write();
  }

  /// After an error: the realizations before it, and why there are no more.
  void stop(const std::string& reason) noexcept {
    if (latest_.realizations.empty()) return;
    try {
      latest_.warnings.push_back("stopped: " + reason);
      write();
    } catch (const std::exception&) {
      return;  // the error that stopped the run is the one to tell
    }
  }

  const std::string& path() const { return path_; }
  const Report& latest() const { return latest_; }

 private:
  template <class Item>
  static void append_rest(const std::vector<Item>& from, std::vector<Item>& to) {
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(to.size()), from.end());
  }

  void write() {
    const Clock::time_point begin = Clock::now();
    latest_.timings.read = read_seconds_;
    latest_.timings.total = seconds_since(start_);
    write_beside_meshes();
    written_ = Clock::now();
    // A long report takes long to write, which must stay a small part of the run.
    pause_ = std::max(1.0, 20 * seconds_since(begin));
  }

  void write_beside_meshes() {
    try {
      write_text(to_json(latest_), path_);
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("{}; the meshes up to realization {} are written, their report "
                      "is not",
                      error.what(), latest_.realizations.back().index));
    }
  }

  std::string path_;
  Clock::time_point start_;
  double read_seconds_;
  Report latest_;
  double pause_ = 0;  ///< seconds between two writes
  std::optional<Clock::time_point> written_;
};

/// Fields cost time to put together; most formats leave them out.
WriteOptions with_fields(WriteOptions options, const RoughMesh& rough, const std::string& path) {
  if (carries_fields(rough.mesh, path, options)) options.fields = point_fields(rough);
  return options;
}

/// Heights that the numbers of the file would round. Nothing else knows what file is written.
void warn_of_digits(const Mesh& mesh, const std::string& path, Report& report) {
  constexpr double fewest = 1000;  // spacings in Rq
  const RoughenOptions& request = report.request;
  const double spacing = coordinate_spacing(mesh, path, write_options(request));
  for (std::size_t s = 0; s < request.surfaces.size(); ++s) {
    const double rms = request.surfaces[s].rms;
    if (rms >= fewest * spacing) continue;
    report.warnings.push_back(
        fmt::format("{}--rms {:g} is only {:.3g} spacings of the numbers that OUTPUT can hold "
                    "({:.3g}): heights "
                    "are rounded; use a file with more digits",
                    request.surfaces.size() == 1
                        ? ""
                        : fmt::format("surface {}: ", list_of(report.surfaces[s].groups)),
                    rms, rms / spacing, spacing));
  }
}

/// Of the realizations from `first` on, beside the report of those before.
std::string next_report_path(const std::string& report, std::uint64_t first) {
  const std::string ending = report.ends_with(".report.json") ? ".report.json" : ".json";
  const std::string stem =
      report.ends_with(ending) ? report.substr(0, report.size() - ending.size()) : report;
  return fmt::format("{}.from{}{}", stem, first, ending);
}

/// After an interrupt, unless that was the last realization.
void stop_if_interrupted(const RoughenOptions& options, std::uint64_t realization) {
  const std::uint64_t n_done = realization - options.first + 1;
  if (interrupted() == 0 || n_done == options.realizations) return;
  throw Interrupt(fmt::format(
      "interrupted; realizations {} to {} are kept, go on with --first {} --realizations {} "
      "--report {}",
      options.first, realization, realization + 1, options.realizations - n_done,
      next_report_path(report_path(options), realization + 1)));
}

/// A report of earlier realizations of the same output is not replaced by that of later ones.
void keep_earlier_report(const RoughenOptions& options) {
  const std::string path = report_path(options);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  RoughenOptions earlier;
  try {
    earlier = read_job(path);
  } catch (const std::exception&) {
    return;  // none is there, or what is there is no report
  }
  if (earlier.output != options.output || earlier.first >= options.first) return;
  throw InputError(
      fmt::format("--report: {} describes realizations from {} on and would be lost; name another "
                  "one, such as --report {}",
                  path, earlier.first, next_report_path(path, options.first)));
}

void make_realizations(const Mesh& mesh, const RoughenOptions& options,
                       const std::vector<std::string>& losses, ReportFile& file,
                       ProgressBar& progress) {
  const GracePeriod grace;
  const auto deliver = [&](const RoughMesh& rough, Report& report) {
    const std::string path = output_path(options.output, rough.realization);
    write_mesh(rough.mesh, path, with_fields(write_options(options), rough, path));
    if (report.realizations.size() == 1) warn_of_digits(mesh, path, report);
    if (report.realizations.size() == 1 && !losses.empty())
      report.warnings.push_back(
          fmt::format("OUTPUT does not hold all of INPUT; left out: {}", list_of(losses)));
    report.realizations.back().path = path;
    note_finished_files();
    file.update(report);
    progress.finish_realization();
    stop_if_interrupted(options, rough.realization);
  };
  try {
    file.finish(roughen(mesh, options, deliver, [&](const Progress& p) { progress.begin(p); }));
  } catch (const std::exception& error) {
    file.stop(error.what());
    throw;
  }
}

}  // namespace

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return text;
}

std::string list_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

Mesh read_input(const RoughenOptions& options) {
  if (!is_geometry(options.input)) {
    if (options.round)
      throw InputError(
          fmt::format("--round: {:g}; {} is a mesh, and only CAD files are rounded; "
                      "leave it out",
                      *options.round, options.input));
    if (options.mesh_size)
      throw InputError(
          fmt::format("--mesh-size: {:g}; {} is a mesh, whose nodes move and whose size "
                      "stays; leave it out",
                      *options.mesh_size, options.input));
    return read_mesh(options.input);
  }
  return mesh_geometry(options.input, geometry_options(options));
}

namespace {

/// What the file at `path` will not hold, where it can be written at all.
/// @param sample  output_sample()
std::vector<std::string> output_losses(const Mesh& sample, const RoughenOptions& request) {
  const std::string path = output_path(request.output, request.first);
  const WriteOptions options = write_options(request);
  check_output(sample, path, options);
  if (n_elements(sample, 3) > 0 && request.volume == VolumeChoice::remesh &&
      !carries_volumes(sample, path, options))
    throw InputError(fmt::format(
        "{}: holds surfaces only, and --volume remesh makes volumes; name it .msh or .vtu", path));
  return conversion_losses(sample, path, options);
}

/// Everything until the last file is written.
ReportFile roughen_files(const RoughenOptions& options) {
  const Clock::time_point start = Clock::now();
  ProgressBar progress(options);
  const Mesh mesh = read_input(options);
  // Before the hours that a large surface may take.
  const std::vector<std::string> losses = output_losses(output_sample(mesh, options), options);
  if (options.first > 0) keep_earlier_report(options);
  check_text_output(report_path(options));
  ReportFile file(report_path(options), start, seconds_since(start));
  make_realizations(mesh, options, losses, file, progress);
  return file;
}

}  // namespace

void run_roughen(const RoughenOptions& options) {
  require_files(options);
  check_options(options);
  const ReportFile file = roughen_files(options);
  if (options.quiet) return;
  print_summary(file.latest(), file.path());
  print_warnings(file.latest());
}

}  // namespace roughmesh::app
