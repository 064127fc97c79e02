// SPDX-License-Identifier: BSD-3-Clause
// The geometry is handed over under a fixed name in a folder of its own, and gmsh is told what to
// do by a script that holds nothing of the input but numbers.
#include "roughmesh/cad.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

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

// What gmsh is asked to write, whatever a script or an option file says: MSH 4.1, binary, one file.
constexpr std::string_view write_mesh_script = R"(
Mesh.Format = 1;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
Mesh.SaveParametric = 0;
Mesh.PartitionSplitMeshFiles = 0;
Save "mesh.msh";
)";

std::string size_script(double mesh_size) {
  return fmt::format(
      "Mesh.MeshSizeMin = {0:.17g};\nMesh.MeshSizeMax = {0:.17g};\nMesh.MeshSizeFactor = 1;\n"
      "Mesh.MeshSizeFromCurvature = 0;\nMesh.MeshSizeExtendFromBoundary = 1;\n",
      mesh_size);
}

// OpenCASCADE converts lengths on reading to a unit that it has a name for, and what remains is a
// factor.
std::string unit_script(std::optional<double> unit_in_mm) {
  constexpr std::array<std::pair<std::string_view, double>, 9> named = {{{"UM", 1e-3},
                                                                         {"MM", 1},
                                                                         {"CM", 10},
                                                                         {"M", 1e3},
                                                                         {"KM", 1e6},
                                                                         {"MIL", 0.0254},
                                                                         {"INCH", 25.4},
                                                                         {"FT", 304.8},
                                                                         {"MI", 1609344}}};
  const double unit = unit_in_mm.value_or(1);
  const auto is_nearer = [unit](const auto& a, const auto& b) {
    return std::abs(std::log(a.second / unit)) < std::abs(std::log(b.second / unit));
  };
  const auto* const nearest = std::min_element(named.begin(), named.end(), is_nearer);
  const double factor = nearest->second / unit;
  const bool is_exact = std::abs(factor - 1) < 1e-9;
  return fmt::format("Geometry.OCCTargetUnit = \"{}\";\nGeometry.OCCScaling = {:.17g};\n",
                     nearest->first, is_exact ? 1 : factor);
}

// Labels become physical groups: gmsh gives them as "Shapes/" and the path of names.
constexpr std::string_view group_script = R"(
For dimension In {2:3}
  tags() = {};
  If (dimension == 3)
    tags() = Volume {:};
  Else
    tags() = Surface {:};
  EndIf
  labelled() = {};
  labels() = Str("");
  For i In {0:#tags()-1}
    If (dimension == 3)
      label = Str(Volume {tags(i)});
    Else
      label = Str(Surface {tags(i)});
    EndIf
    If (StrLen(label) > 7)
      labelled() += tags(i);
      labels() += Str(StrSub(label, 7, 10000));
    EndIf
  EndFor
  is_done() = {};
  For i In {0:#labelled()-1}
    is_done(i) = 0;
  EndFor
  For i In {0:#labelled()-1}
    If (!is_done(i))
      group() = {};
      For j In {i:#labelled()-1}
        If (StrCmp(labels(j+1), labels(i+1)) == 0)
          is_done(j) = 1;
          group() += labelled(j);
        EndIf
      EndFor
      If (dimension == 3)
        Physical Volume(Str(labels(i+1))) = group();
      Else
        Physical Surface(Str(labels(i+1))) = group();
      EndIf
    EndIf
  EndFor
EndFor
)";

// Counts solids and surfaces, predicts the number of nodes, and meshes where that is bearable.
// Elements of edge h fill space at about sqrt(2)/h^3 nodes, a surface at 2/sqrt(3)/h^2.
constexpr std::string_view mesh_script = R"(
solids() = Volume {:};
surfaces() = Surface {:};
volume = 0;
area = 0;
For i In {0:#solids()-1}
  volume += Abs(Mass Volume {solids(i)});
EndFor
For i In {0:#surfaces()-1}
  area += Abs(Mass Surface {surfaces(i)});
EndFor
predicted = 1.41 * volume / size^3 + 1.15 * area / size^2;
Printf("roughmesh: %g %g %.6g", #solids(), #surfaces(), predicted);
If (#surfaces() > 0 && predicted <= most)
  If (#solids() > 0)
    Mesh 3;
  Else
    Mesh 2;
  EndIf
)";

std::string cad_script(std::string_view file, std::optional<double> unit,
                       const GeometryOptions& options) {
  std::string script = "SetFactory(\"OpenCASCADE\");\n" + unit_script(unit);
  script += fmt::format("Geometry.OCCImportLabels = 1;\nMerge \"{}\";\n", file);
  script += group_script;
  script += fmt::format("size = {:.17g};\nmost = {:.17g};\n", options.mesh_size, options.max_nodes);
  script += size_script(options.mesh_size) + "Mesh.SaveAll = 1;\nMesh.Algorithm3D = 10;\n";
  script += mesh_script;
  script += write_mesh_script;
  return script + "EndIf\n";
}

constexpr std::string_view highest_dimension_script = R"(
groups3() = Physical Volume {:}; groups2() = Physical Surface {:}; groups1() = Physical Curve {:};
entities3() = Volume {:}; entities2() = Surface {:};
If (#groups3() + #groups2() + #groups1() > 0)
  has3 = #groups3(); has2 = #groups2();
Else
  has3 = #entities3(); has2 = #entities2();
EndIf
If (has3 > 0)
  Mesh 3;
ElseIf (has2 > 0)
  Mesh 2;
Else
  Mesh 1;
EndIf
)";

std::string script_driver(bool keeps_mesh, const GeometryOptions& options) {
  std::string script = options.mesh_size > 0 ? size_script(options.mesh_size) : "";
  if (!keeps_mesh || options.mesh_size > 0) script += highest_dimension_script;
  return script + std::string(write_mesh_script);
}

void write(const std::filesystem::path& path, std::string_view text) {
  detail::OutputFile file(path);
  file.write(text);
  file.commit();
}

GmshOutcome run(const ScratchFolder& folder, std::vector<std::string> files,
                const GeometryOptions& options) {
  std::vector<std::string> arguments = {"-", "-nt", "1", "-v", "3"};
  arguments.insert(arguments.begin() + 1, files.begin(), files.end());
  return detail::run_gmsh(folder, {options.gmsh, std::move(arguments), options.timeout});
}

Mesh read_result(const ScratchFolder& folder, const std::filesystem::path& path) {
  try {
    return read_mesh(folder / "mesh.msh");
  } catch (const FormatError& error) {
    throw NumericalError(fmt::format(
        "{}: gmsh wrote a mesh that cannot be read ({}); try another "
        "gmsh (--gmsh PATH)",
        path.string(), std::string_view(error.what()).substr(folder.path().string().size() + 1)));
  }
}

void require_elements(const Mesh& mesh, const std::filesystem::path& path) {
  if (dimension(mesh) >= 1) return;
  throw InputError(
      fmt::format("{}: gmsh made no element of it; is there a curve, surface or volume "
                  "in it?",
                  path.string()));
}

// ---- CAD files

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

Mesh mesh_cad(const FileBytes& file, Geometry kind, const GeometryOptions& options) {
  check_cad_options(file.path, options);
  check_header(file, kind);
  const bool is_step = kind == Geometry::step;
  const std::string name = is_step ? "input.step" : "input.brep";
  const ScratchFolder folder;
  write(folder / name, file.view());
  const auto unit = is_step ? detail::step_length_unit(file.view()) : std::optional<double>();
  write(folder / "driver.geo", cad_script(name, unit, options));
  const GmshOutcome outcome = run(folder, {"driver.geo"}, options);
  check_cad_outcome(outcome, file.path, options);
  Mesh mesh = read_result(folder, file.path);
  require_elements(mesh, file.path);
  return mesh;
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
  if (!has_mesh)
    throw InputError(
        fmt::format("{}: the script ended before its mesh was written; take Exit or "
                    "Abort out of it",
                    path.string()));
}

Mesh mesh_script_file(const FileBytes& file, const GeometryOptions& options) {
  if (!options.trust_scripts) check_script(file);
  const ScratchFolder folder;
  std::string input = "input.geo";
  if (options.trust_scripts)  // in its own place, so that what it includes is found
    input = std::filesystem::absolute(file.path).string();
  else
    write(folder / input, file.view());
  write(folder / "driver.geo", script_driver(detail::makes_mesh(file.view()), options));
  const GmshOutcome outcome = run(folder, {input, "driver.geo"}, options);
  check_script_outcome(outcome, file.path, std::filesystem::exists(folder / "mesh.msh"));
  Mesh mesh = read_result(folder, file.path);
  require_elements(mesh, file.path);
  return mesh;
}

void check_script_options(const std::filesystem::path& path, const GeometryOptions& options) {
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
