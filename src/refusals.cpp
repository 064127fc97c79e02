// SPDX-License-Identifier: BSD-3-Clause
#include "refusals.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "warnings.hpp"

namespace roughmesh::detail {
namespace {

std::string describe_defects(const MeshCheck& check) {
  const Finding& worst = check.findings.front();
  if (check.inverted_elements == 0)
    return fmt::format("{}: a relative difference of {:.1e}", worst.what, worst.value);
  return fmt::format(
      "{} inverted elements, the worst is element {} ({}) at ({:.6g}, {:.6g}, {:.6g}) with "
      "quality {:.3g}",
      check.inverted_elements, worst.element, worst.what, worst.place.x(), worst.place.y(),
      worst.place.z(), worst.value);
}

void refuse(const std::string& defects, std::uint64_t realization, const std::string& remedy,
            Report& report) {
  const std::string found = fmt::format("realization {}: {}", realization, defects);
  if (!report.request.allow_invalid) throw CheckError(found + "; " + remedy);
  report.warnings.push_back(found + "; written because of --allow-invalid");
}

}  // namespace

std::string remedy(std::span<const FieldPlan> fields, const TornWalls& walls,
                   const std::string& lower) {
  const bool is_smooth = std::all_of(fields.begin(), fields.end(), [](const FieldPlan& field) {
    return field.correlation.autocorrelation().slope_variance().has_value();
  });
  std::string text = lower;
  text += is_smooth ? " or use a longer --length"
                    : " or take a smoother --acf (slopes of this one grow as the mesh is refined)";
  if (walls.n_nodes > 0)
    text += fmt::format(
        "; the rough surface ends on faces that stay, where elements invert first: --fade{}",
        walls.would_slide ? ", or --volume move, under which plane ones slide" : "");
  return text + "; --allow-invalid writes it all the same";
}

void refuse_invalid(const SurfaceCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report) {
  if (!check.valid()) refuse(describe_defects(check), realization, remedy, report);
}

void refuse_invalid(const MeshCheck& check, std::uint64_t realization, const std::string& remedy,
                    Report& report) {
  if (!check.valid()) refuse(describe_defects(check), realization, remedy, report);
}

}  // namespace roughmesh::detail
