// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "roughmesh/pipeline.hpp"

#include "commands.hpp"

namespace roughmesh::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One line that rewrites itself, on a terminal only.
class ProgressBar {
 public:
  explicit ProgressBar(const RoughenOptions& options)
      : total_(options.realizations), visible_(!options.quiet && isatty(STDERR_FILENO) != 0) {
    show(0);
  }
  ~ProgressBar() {
    if (visible_) fmt::print(stderr, "\r{:60}\r", "");
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::uint64_t n_done) const {
    if (!visible_) return;
    const double elapsed = seconds_since(start_);
    const std::string remaining =
        n_done == 0 ? std::string("preparing")
                    : fmt::format("{:.0f} s left", elapsed / static_cast<double>(n_done) *
                                                       static_cast<double>(total_ - n_done));
    const auto filled =
        static_cast<std::size_t>(20.0 * static_cast<double>(n_done) / static_cast<double>(total_));
    fmt::print(stderr, "\r[{:<20}] {}/{} {:20}", std::string(filled, '#'), n_done, total_,
               remaining);
    std::fflush(stderr);
  }

 private:
  std::uint64_t total_;
  bool visible_;
  Clock::time_point start_ = Clock::now();
};

void require_files(const RoughenOptions& options) {
  if (options.input.empty())
    throw InputError(
        "INPUT: missing; give the mesh to roughen: roughmesh roughen INPUT -o OUTPUT --rms "
        "VALUE --length L");
  if (options.output.empty())
    throw InputError(
        "OUTPUT: missing; give the file to write with -o, e.g. -o rough_{realization}.msh");
}

void print_summary(const Report& report, const std::string& path_of_report) {
  for (const RealizationReport& r : report.realizations)
    fmt::print(
        "{}  Sq {:.4g} (expected {:.4g} +- {:.2g})  Ssk {:.2f}  Sku {:.2f}  min quality {:.3g} "
        "(before {:.3g})\n",
        r.path, r.statistics.sq, r.sq_expected, r.sq_expected_std, r.statistics.ssk,
        r.statistics.sku, r.min_quality, r.min_quality_before);
  fmt::print("{}  {} nodes, {} of rank {}, covariance error {:.2g}, {:.2f} s\n", path_of_report,
             report.surface_nodes, name(report.field.factorization), report.field.rank,
             report.audit.covariance_error, report.timings.total);
}

void print_warnings(const Report& report) {
  for (const std::string& warning : report.warnings) fmt::print(stderr, "warning: {}\n", warning);
}

}  // namespace

void run_roughen(const RoughenOptions& options) {
  const Clock::time_point start = Clock::now();
  require_files(options);
  check_options(options);
  const Mesh mesh = read_mesh(options.input);
  const double read_seconds = seconds_since(start);

  const std::string path_of_report = report_path(options);
  const auto finish = [&](Report& report) {
    report.timings.read = read_seconds;
    report.timings.total = seconds_since(start);
    write_text(to_json(report), path_of_report);
  };
  Report finished;  // what is known once a realization is on disk
  try {
    ProgressBar progress(options);
    finished = roughen(mesh, options, [&](const RoughMesh& rough, Report& report) {
      const std::string path = output_path(options.output, rough.realization);
      write_mesh(rough.mesh, path, point_fields(rough));
      report.realizations.back().path = path;
      finished = report;
      progress.show(report.realizations.size());
    });
  } catch (const Error&) {
    if (!finished.realizations.empty()) finish(finished);
    throw;
  }
  finish(finished);
  if (options.quiet) return;
  print_summary(finished, path_of_report);
  print_warnings(finished);
}

}  // namespace roughmesh::app
