// SPDX-License-Identifier: BSD-3-Clause
#include "cad_scripts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace roughmesh::detail {
namespace {

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

// Solids that touch or lie in each other are cut along each other, so that their meshes fit.
constexpr std::string_view share_faces_script = R"(
solids() = Volume {:};
If (#solids() > 1)
  BooleanFragments{ Volume {solids()}; Delete; }{ }
EndIf
)";

// Labels become physical groups: gmsh gives them as "Shapes/" and the path of names. The lowest
// dimension of those that count comes before.
constexpr std::string_view group_script = R"(
For dimension In {lowest:3}
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

std::string rounding_script(const Rounding& rounding) {
  return fmt::format(R"(
solids() = Volume {{:}};
before = 0;
For i In {{0:#solids()-1}}
  before += Mass Volume {{solids(i)}};
EndFor
rounded() = Fillet{{solids()}}{{{:d}}}{{{:.17g}}};
after = 0;
For i In {{0:#rounded()-1}}
  after += Mass Volume {{rounded(i)}};
EndFor
If (#rounded() != #solids())
  Printf("{} failed");
  Exit;
EndIf
For i In {{0:#labelled()-1}}
  Physical Volume(Str(labels(i+1))) += {{labelled(i)}};
EndFor
Printf("{} %.17g %.17g", before, after);
)",
                     fmt::join(rounding.curves, ", "), rounding.radius, rounded_mark, rounded_mark);
}

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
  If (#solids() > 0 && highest == 3)
    Mesh 3;
  Else
    Mesh 2;
  EndIf
)";

// Its variables have names that no script uses.
constexpr std::string_view highest_dimension_script = R"(
roughmesh_3() = Physical Volume {:};
roughmesh_2() = Physical Surface {:};
roughmesh_1() = Physical Curve {:};
If (#roughmesh_3() + #roughmesh_2() + #roughmesh_1() == 0)
  roughmesh_3() = Volume {:};
  roughmesh_2() = Surface {:};
EndIf
If (#roughmesh_3() > 0)
  Mesh 3;
ElseIf (#roughmesh_2() > 0)
  Mesh 2;
Else
  Mesh 1;
EndIf
)";

}  // namespace

namespace {

std::string import_script(std::string_view file, std::optional<double> unit_in_mm) {
  return "SetFactory(\"OpenCASCADE\");\n" + unit_script(unit_in_mm) +
         fmt::format("Geometry.OCCImportLabels = 1;\nMerge \"{}\";\n", file);
}

std::string sized_mesh_script(const GeometryOptions& options, int highest_dimension) {
  std::string script = fmt::format("size = {:.17g};\nmost = {:.17g};\nhighest = {};\n",
                                   options.mesh_size, options.max_nodes, highest_dimension);
  script += size_script(options.mesh_size) + "Mesh.SaveAll = 1;\nMesh.Algorithm3D = 10;\n";
  script += mesh_script;
  script += write_mesh_script;
  return script + "EndIf\n";
}

}  // namespace

std::string survey_script(std::string_view file, std::optional<double> unit_in_mm,
                          const GeometryOptions& options) {
  return import_script(file, unit_in_mm) + sized_mesh_script(options, 2);
}

std::string cad_script(std::string_view file, std::optional<double> unit_in_mm,
                       const GeometryOptions& options, const Rounding* rounding) {
  std::string script = import_script(file, unit_in_mm);
  if (options.share_faces && rounding == nullptr) script += share_faces_script;
  // Solids keep their numbers when they are rounded, faces do not.
  script += fmt::format("lowest = {};", rounding == nullptr ? 2 : 3);
  script += group_script;
  if (rounding != nullptr) script += rounding_script(*rounding);
  return script + sized_mesh_script(options, 3);
}

std::string script_driver(bool keeps_mesh, const GeometryOptions& options) {
  std::string script = options.mesh_size > 0 ? size_script(options.mesh_size) : "";
  if (!keeps_mesh || options.mesh_size > 0) script += highest_dimension_script;
  script += "roughmesh_1() = Curve {:};\nroughmesh_2() = Surface {:};\n";
  script += "If (#roughmesh_1() + #roughmesh_2() > 0)\n" + std::string(write_mesh_script);
  return script + fmt::format("Else\n  Printf(\"{}\");\nEndIf\n", empty_mark);
}

}  // namespace roughmesh::detail
