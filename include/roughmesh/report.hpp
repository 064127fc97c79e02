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

/// One rough mesh. Lengths in the unit of the mesh.
struct RealizationReport {
  std::uint64_t index = 0;
  std::string path;  ///< empty when it was not written to a file
  HeightStatistics statistics;
  double sq_expected = 0;      ///< mean that Sq must have on this surface
  double sq_expected_std = 0;  ///< standard deviation that Sq must have on this surface
  std::int64_t inverted_elements = 0;
  double min_quality = 0;
  double min_quality_before = 0;
  std::optional<std::int64_t> self_intersections;  ///< absent: not counted
  VolumeMethod volume_method = VolumeMethod::none;
};

/// Seconds of wall-clock time, summed over realizations. `field` is preparation plus heights.
struct Timings {
  double read = 0, surface = 0, field = 0, audit = 0, displace = 0, volume = 0, check = 0,
         write = 0, total = 0;
};

struct Report {
  // input
  std::string format;
  std::int64_t n_nodes = 0;
  std::int64_t n_elements = 0;
  // request
  RoughenOptions request;
  // surface
  std::vector<std::string> surface_groups;
  std::int64_t surface_nodes = 0;
  std::int64_t surface_elements = 0;
  double surface_area = 0;
  MeshSize mesh_size;
  std::int64_t surface_components = 0, border_edges = 0, sharp_edges = 0, nonmanifold_edges = 0;
  // field
  FieldSummary field;
  Audit audit;
  EquivalentLengths lengths;
  Resolution resolution;

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
