// SPDX-License-Identifier: BSD-3-Clause
// The geometry is handed over under a fixed name in a folder of its own, and gmsh is told what to
// do by a script that holds nothing of the input but numbers.
#include "roughmesh/cad.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cad_rounding.hpp"
#include "cad_scripts.hpp"
#include "file_formats.hpp"
#include "geo_script.hpp"
#include "gmsh_process.hpp"
#include "mesh_source.hpp"
#include "output_file.hpp"
#include "scanner.hpp"
#include "scratch_folder.hpp"
#include "step_file.hpp"

namespace roughmesh {
namespace {

using detail::FileBytes;
using detail::GmshOutcome;
using detail::ScratchFolder;

enum class Geometry { none, step, brep, script };

Geometry geometry_of(const std::filesystem::path& path) {
  const std::string extension = detail::lower_extension(path);
  if (extension == ".step" || extension == ".stp") return Geometry::step;
  if (extension == ".brep") return Geometry::brep;
  return extension == ".geo" ? Geometry::script : Geometry::none;
}

void write(const std::filesystem::path& path, std::string_view text) {
  detail::OutputFile file(path);
  file.write(text);
  file.commit();
}

GmshOutcome run(const ScratchFolder& folder, std::vector<std::string> files,
                const GeometryOptions& options, const std::filesystem::path& run_in = {}) {
  std::vector<std::string> arguments = {"-", "-nt", "1", "-v", "3"};
  arguments.insert(arguments.begin() + 1, files.begin(), files.end());
  return detail::run_gmsh(folder, {options.gmsh, std::move(arguments), options.timeout, run_in});
}

[[noreturn]] void fail_empty(const std::filesystem::path& path) {
  throw InputError(
      fmt::format("{}: gmsh made no element of it; is there a curve, surface or volume "
                  "in it?",
                  path.string()));
}

Mesh read_result(const ScratchFolder& folder, const std::filesystem::path& path) {
  if (!std::filesystem::exists(folder / "mesh.msh"))
    throw NumericalError(
        fmt::format("{}: gmsh ended well but wrote no mesh; try another gmsh "
                    "(--gmsh PATH)",
                    path.string()));
  try {
    Mesh mesh = read_mesh(folder / "mesh.msh");
    if (dimension(mesh) < 1) fail_empty(path);
    return mesh;
  } catch (const FormatError& error) {
    const std::string_view said = error.what();
    throw NumericalError(
        fmt::format("{}: gmsh wrote a mesh that cannot be read ({}); try another "
                    "gmsh (--gmsh PATH)",
                    path.string(), said.substr(folder.path().string().size() + 1)));
  }
}

// ---- CAD files

struct CadFile {
  const FileBytes& file;
  std::string name;  ///< in the scratch folder
  std::optional<double> unit_in_mm;
};

// What the generated script printed; empty if it did not come so far.
struct Contents {
  double n_solids = 0, n_surfaces = 0, n_nodes = 0;
};

std::optional<Contents> contents_in(std::string_view output) {
  constexpr std::string_view mark = "roughmesh: ";
  std::size_t begin = output.find(mark);
  if (begin == std::string_view::npos) return {};
  output.remove_prefix(begin + mark.size());
  Contents contents;
  for (double* const number : {&contents.n_solids, &contents.n_surfaces, &contents.n_nodes}) {
    while (!output.empty() && output.front() == ' ') output.remove_prefix(1);
    const auto [end, error] =
        std::from_chars(output.data(), output.data() + output.size(), *number);
    if (error != std::errc()) return {};
    output.remove_prefix(static_cast<std::size_t>(end - output.data()));
  }
  return contents;
}

void check_cad_options(const std::filesystem::path& path, const GeometryOptions& options) {
  if (!(options.round >= 0 && std::isfinite(options.round)))
    throw InputError(
        fmt::format("{}: a radius of {:g}; --round must be above 0", path.string(), options.round));
  if (options.mesh_size > 0 && std::isfinite(options.mesh_size)) return;
  throw InputError(
      fmt::format("{}: a CAD file needs the length of its mesh's edges, above 0; give "
                  "--mesh-size, in the unit of the file (here {:g})",
                  path.string(), options.mesh_size));
}

void check_header(const FileBytes& file, Geometry kind) {
  constexpr std::size_t longest_header = 200;
  const std::string_view beginning = file.view().substr(0, longest_header);
  if (kind == Geometry::step && !detail::is_step(file.view()))
    throw FormatError(fmt::format("{}: is no STEP file: it must begin with ISO-10303-21; (here {})",
                                  file.path.string(), detail::quoted(beginning)));
  if (kind == Geometry::brep && beginning.find("DBRep_DrawableShape") == std::string_view::npos &&
      beginning.find("CASCADE Topology") == std::string_view::npos)
    throw FormatError(
        fmt::format("{}: is no BREP file of OpenCASCADE: it must begin with "
                    "DBRep_DrawableShape or CASCADE Topology (here {})",
                    file.path.string(), detail::quoted(beginning)));
}

void check_cad_outcome(const GmshOutcome& outcome, const std::filesystem::path& path,
                       const GeometryOptions& options) {
  const std::optional<Contents> contents = contents_in(outcome.output);
  const std::string error = detail::first_error(outcome.output);
  const bool is_corrupt = outcome.output.find("ERR StepFile") != std::string::npos ||
                          outcome.output.find("Could not read file") != std::string::npos;
  if (is_corrupt || !contents)
    throw FormatError(fmt::format("{}: gmsh cannot read it: {}; export it again", path.string(),
                                  error.empty() ? "it gave no reason" : error));
  if (contents->n_surfaces == 0)
    throw InputError(fmt::format("{}: holds no solid and no surface; export the part as a solid",
                                 path.string()));
  if (contents->n_nodes > options.max_nodes)
    throw InputError(
        fmt::format("{}: mesh size {:g} would give about {:.2g} nodes, more than {:.2g}; give a "
                    "larger --mesh-size",
                    path.string(), options.mesh_size, contents->n_nodes, options.max_nodes));
  if (outcome.exit_status != 0)
    throw NumericalError(
        fmt::format("{}: gmsh could not mesh it: {}; try another --mesh-size or "
                    "heal the geometry",
                    path.string(), error));
}

// ---- Rounding

/// The volumes that the script printed behind the mark, before and after; none if the fillets
/// failed.
std::optional<std::array<double, 2>> volumes_in(std::string_view output) {
  std::size_t begin = output.find(detail::rounded_mark);
  if (begin == std::string_view::npos) return {};
  output.remove_prefix(begin + detail::rounded_mark.size());
  std::array<double, 2> volumes{};
  for (double& volume : volumes) {
    while (!output.empty() && output.front() == ' ') output.remove_prefix(1);
    const auto [end, error] = std::from_chars(output.data(), output.data() + output.size(), volume);
    if (error != std::errc()) return {};
    output.remove_prefix(static_cast<std::size_t>(end - output.data()));
  }
  return volumes;
}

void check_rounding(const detail::Rounding& rounding, const GmshOutcome& outcome,
                    const std::filesystem::path& path) {
  const auto volumes = volumes_in(outcome.output);
  if (!volumes)
    throw InputError(
        fmt::format("{}: gmsh could not round its {} sharp edges with a radius of {:g}; use a "
                    "smaller --round",
                    path.string(), rounding.curves.size(), rounding.radius));
  if (detail::is_plausible(rounding, volumes->front(), volumes->back())) return;
  throw InputError(fmt::format(
      "{}: rounding with a radius of {:g} gave a wrong solid: its volume changed by {:.3g} where "
      "{:.3g} is to be expected; use a smaller --round",
      path.string(), rounding.radius, volumes->back() - volumes->front(), rounding.volume_change));
}

detail::Rounding survey(const CadFile& cad, const GeometryOptions& options) {
  const ScratchFolder folder;
  write(folder / cad.name, cad.file.view());
  write(folder / "driver.geo", detail::survey_script(cad.name, cad.unit_in_mm, options));
  const GmshOutcome outcome = run(folder, {"driver.geo"}, options);
  check_cad_outcome(outcome, cad.file.path, options);
  detail::Rounding rounding =
      detail::plan_rounding(read_result(folder, cad.file.path), options.round, options.sharp_angle);
  if (rounding.curves.empty())
    throw InputError(
        fmt::format("{}: has no sharp edge to round; leave --round out", cad.file.path.string()));
  return rounding;
}

/// Fillets crash some versions.
GmshOutcome run_rounding(const ScratchFolder& folder, const detail::Rounding& rounding,
                         const GeometryOptions& options) {
  try {
    return run(folder, {"driver.geo"}, options);
  } catch (const NumericalError&) {
    throw NumericalError(
        fmt::format("gmsh: crashed while it rounded {} sharp edges with a radius of {:g}; use a "
                    "smaller --round, or leave it out",
                    rounding.curves.size(), rounding.radius));
  }
}

Mesh mesh_cad(const FileBytes& file, Geometry kind, const GeometryOptions& options) {
  check_cad_options(file.path, options);
  check_header(file, kind);
  const bool is_step = kind == Geometry::step;
  const CadFile cad{file, is_step ? "input.step" : "input.brep",
                    is_step ? detail::step_length_unit(file.view()) : std::nullopt};
  std::optional<detail::Rounding> rounding;
  if (options.round > 0) rounding = survey(cad, options);
  const ScratchFolder folder;
  write(folder / cad.name, file.view());
  write(folder / "driver.geo",
        detail::cad_script(cad.name, cad.unit_in_mm, options, rounding ? &*rounding : nullptr));
  const GmshOutcome outcome =
      rounding ? run_rounding(folder, *rounding, options) : run(folder, {"driver.geo"}, options);
  if (rounding) check_rounding(*rounding, outcome, file.path);
  check_cad_outcome(outcome, file.path, options);
  return read_result(folder, file.path);
}

// ---- Scripts

void check_script(const FileBytes& file) {
  constexpr std::size_t largest = std::size_t{1} << 26;
  if (file.size > largest)
    throw InputError(
        fmt::format("{}: a script of {} bytes is too long to be checked; give "
                    "--trust-scripts if you trust it",
                    file.path.string(), file.size));
  const auto finding = detail::find_unsafe(file.view());
  if (!finding) return;
  throw InputError(fmt::format("{}:{}: {}; give --trust-scripts if you trust it",
                               file.path.string(), finding->line, finding->what));
}

// "'input.geo', line 3: syntax error" becomes "PATH:3: syntax error".
std::string with_place(const std::filesystem::path& path, const std::string& error) {
  constexpr std::string_view mark = "', line ";
  const std::size_t begin = error.find(mark);
  if (begin == std::string::npos || error[0] != '\'') return path.string() + ": gmsh: " + error;
  return path.string() + ":" + error.substr(begin + mark.size());
}

void check_script_outcome(const GmshOutcome& outcome, const std::filesystem::path& path,
                          bool has_mesh) {
  const std::string error = detail::first_error(outcome.output);
  if (outcome.exit_status != 0 && error.starts_with("'"))
    throw FormatError(with_place(path, error) + "; correct the script");
  if (outcome.exit_status != 0)
    throw NumericalError(
        fmt::format("{}: gmsh could not mesh it: {}; try another --mesh-size or "
                    "correct the script",
                    path.string(), error));
  if (outcome.output.find(detail::empty_mark) != std::string::npos) fail_empty(path);
  if (!has_mesh)
    throw InputError(
        fmt::format("{}: the script ended before its mesh was written; take Exit or "
                    "Abort out of it",
                    path.string()));
}

Mesh mesh_script_file(const FileBytes& file, const GeometryOptions& options) {
  if (!options.trust_scripts) check_script(file);
  const ScratchFolder folder;
  std::filesystem::path input = folder / "input.geo";
  std::filesystem::path run_in = folder.path();
  if (options.trust_scripts) {  // in its own place, so that files and programs beside it are found
    input = std::filesystem::absolute(file.path);
    run_in = input.parent_path();
  } else {
    write(input, file.view());
  }
  write(folder / "driver.geo", detail::script_driver(detail::makes_mesh(file.view()), options));
  const std::string driver = (folder / "driver.geo").string();
  const GmshOutcome outcome = run(folder, {input.string(), driver}, options, run_in);
  check_script_outcome(outcome, file.path, std::filesystem::exists(folder / "mesh.msh"));
  return read_result(folder, file.path);
}

void check_script_options(const std::filesystem::path& path, const GeometryOptions& options) {
  if (options.round != 0)
    throw InputError(
        fmt::format("{}: is a script, and --round {:g} is for CAD files; use Fillet in "
                    "the script",
                    path.string(), options.round));
  if (options.mesh_size >= 0 && std::isfinite(options.mesh_size)) return;
  throw InputError(
      fmt::format("{}: mesh size {:g}: must be above 0, or left out for the script's own",
                  path.string(), options.mesh_size));
}

}  // namespace

bool is_geometry(const std::filesystem::path& path) { return geometry_of(path) != Geometry::none; }

Mesh mesh_geometry(const std::filesystem::path& path, const GeometryOptions& options) {
  const Geometry kind = geometry_of(path);
  if (kind == Geometry::none)
    throw InputError(
        fmt::format("{}: is no geometry by its extension; name it .step, .stp, .brep or "
                    ".geo",
                    path.string()));
  if (kind == Geometry::script) check_script_options(path, options);
  const FileBytes file = detail::read_file(path);
  return kind == Geometry::script ? mesh_script_file(file, options) : mesh_cad(file, kind, options);
}

}  // namespace roughmesh
