// SPDX-License-Identifier: BSD-3-Clause
// What was asked, done, measured and warned of: one JSON object per run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "roughmesh/move_volume.hpp"
#include "roughmesh/options.hpp"
#include "roughmesh/resolution.hpp"
#include "roughmesh/statistics.hpp"

namespace roughmesh {

/// What Sq is and should be over the part of a surface that a mask leaves whole.
struct UnfadedSq {
  double sq = 0;
  double expected = 0;
  double expected_std = 0;
};

/// Heights of one surface in one realization. Lengths in the unit of the mesh.
struct SurfaceStatistics {
  HeightStatistics heights;
  double sq_expected = 0;      ///< mean that Sq must have on this surface
  double sq_expected_std = 0;  ///< standard deviation that Sq must have on this surface
  /// Over the points of weight 1; absent where no mask lowers any, or leaves none.
  std::optional<UnfadedSq> unfaded;
};

/// One rough mesh.
struct RealizationReport {
  std::uint64_t index = 0;
  std::string path;                         ///< empty when it was not written to a file
  std::vector<SurfaceStatistics> surfaces;  ///< as Report::surfaces
  std::int64_t inverted_elements = 0;
  double min_quality = 0;
  double min_quality_before = 0;
  Index slid_nodes = 0;                 ///< along the surface, so that no face folds
  std::int64_t self_intersections = 0;  ///< pairs of faces that did not intersect in the input
  VolumeMethod volume_method = VolumeMethod::none;
};

/// One surface of the mesh, its field and what the mesh can carry of it.
struct SurfaceReport {
  int dimension = 2;
  std::vector<std::string> groups;
  std::int64_t nodes = 0, elements = 0;
  std::int64_t masked_nodes = 0;  ///< of weight below 1
  double area = 0;                ///< a length for a curve
  MeshSize mesh_size;
  std::int64_t components = 0, border_edges = 0, sharp_edges = 0, nonmanifold_edges = 0;

  FieldSummary field;
  Audit audit;
  EquivalentLengths lengths;
  std::optional<double> fit_residual;  ///< of a table, as Autocorrelation::fit_residual()
  Resolution resolution;
};

/// Seconds of wall-clock time, summed over realizations. `field` is preparation plus heights.
struct Timings {
  double read = 0, surface = 0, field = 0, audit = 0, displace = 0, volume = 0, check = 0,
         write = 0, total = 0;
};

/// Calls visit(name, seconds) for each member, in the order of the stages.
template <class Seconds, class Visit>
void for_each_timing(Seconds& timings, Visit&& visit) {
  visit("read", timings.read);
  visit("surface", timings.surface);
  visit("field", timings.field);
  visit("audit", timings.audit);
  visit("displace", timings.displace);
  visit("volume", timings.volume);
  visit("check", timings.check);
  visit("write", timings.write);
  visit("total", timings.total);
}

struct Report {
  // input
  std::string format;
  std::int64_t n_nodes = 0;
  std::int64_t n_elements = 0;
  // request
  RoughenOptions request;
  std::vector<SurfaceReport> surfaces;  ///< as request.surfaces
  std::vector<RealizationReport> realizations;
  std::vector<std::string> warnings;
  Timings timings;
  std::vector<std::string> citations;
};

/// The JSON text, indented, with the keys of docs/report.md. Numbers read back exactly; what was
/// not computed or does not exist is null.
std::string to_json(const Report& report);

/// Version of the library, "major.minor.patch".
std::string version();

}  // namespace roughmesh
