// SPDX-License-Identifier: BSD-3-Clause
// Everything a user can ask of `roughen`, declared once for C++, command line, job file and report.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/cad.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/distance.hpp"
#include "roughmesh/error.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/mask.hpp"
#include "roughmesh/mesh_io.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// What the interior of a volume mesh does.
enum class VolumeChoice {
  move,    ///< it follows the surface
  remesh,  ///< it is meshed anew by gmsh, and a bare closed surface is filled
  none     ///< it stays; only nodes of the surface move
};

std::string_view name(VolumeChoice choice);

/// A mask of a job file.
using Mask = std::variant<BoxMask, SphereMask, FormulaMask>;

/// How one surface becomes rough. Lengths are in the unit of the mesh, angles in degrees (they are
/// typed by people).
struct Roughness {
  std::vector<std::string> group = {};
  double rms = 0;
  std::vector<double> length = {};
  Family acf = Family::gaussian;
  LengthDefinition length_definition = LengthDefinition::formula;
  std::optional<double> nu = {}, hurst = {}, rolloff = {}, power = {}, alpha = {};
  std::string table = {};
  double angle = 0;
  std::vector<Vec3> axes = {};  ///< directions of the lengths, of any size: two of them, or three
  std::optional<double> cutoff = {};
  std::optional<DistanceKind> distance = {};
  std::vector<double> period = {};
  std::uint64_t seed = 0;
  EdgeRule edges = EdgeRule::offset;
  double edge_angle = 40;
  bool flip = false;
  std::vector<std::string> fixed = {};
  std::vector<std::string> fade = {};  ///< "WIDTH" or "WIDTH:GROUP"
  std::vector<Mask> mask = {};
};

/// A whole run. Job files may give `surfaces` as several tables; the command line describes one.
struct RoughenOptions {
  std::string input = {};
  std::string checksum = {};
  std::string output = {};
  std::vector<Roughness> surfaces = {Roughness{}};  ///< at least one; no face may be in two
  Method method = Method::automatic;
  double tolerance = 1e-4;
  std::uint64_t realizations = 1;
  std::uint64_t first = 0;
  VolumeChoice volume = VolumeChoice::move;
  std::optional<double> box = {};
  bool allow_invalid = false;
  std::string unit = {};
  std::string report = {};
  std::optional<MeshFormat> format = {};
  bool ascii = false, binary = false;
  std::optional<double> mesh_size = {};
  std::optional<double> round = {};
  std::string gmsh = "gmsh";
  double timeout = 600;
  bool trust_scripts = false;
  int threads = 0;
  bool quiet = false;
};

/// How an option is spelled and explained. The command line writes `-` for `_`.
struct OptionText {
  std::string_view name;   ///< key in job files and reports
  std::string_view value;  ///< placeholder of its value in --help; empty for a switch
  std::string_view help;
};

/// Calls visit(OptionText, member) for every option of the autocorrelation function.
template <class Options, class Visit>
void for_each_autocorrelation_option(Options& o, Visit&& visit) {
  visit(OptionText{"rms", "VALUE", "rms roughness Rq, in the length unit of the mesh; required"},
        o.rms);
  visit(
      OptionText{
          "length", "L[,LY[,LZ]]",
          "correlation length, in the length unit of the mesh; three for an anisotropic field "
          "(of two, the second counts for y and z; inf makes streaks)"},
      o.length);
  visit(OptionText{"acf", "FAMILY", "autocorrelation function"}, o.acf);
  visit(OptionText{"length_definition", "NAME", "what --length is"}, o.length_definition);
  visit(OptionText{"nu", "N", "smoothness of matern, > 0"}, o.nu);
  visit(OptionText{"hurst", "H", "Hurst exponent of self-affine, between 0 and 1"}, o.hurst);
  visit(OptionText{"rolloff", "LAMBDA",
                   "roll-off wavelength of self-affine, in the length unit of the mesh, instead of "
                   "--length"},
        o.rolloff);
  visit(OptionText{"power", "P", "exponent of stretched, > 0 and at most 2"}, o.power);
  visit(OptionText{"alpha", "A", "exponent of rational-quadratic, > 0"}, o.alpha);
  visit(
      OptionText{"table", "FILE",
                 "two columns, distance and autocorrelation, for --acf table instead of --length"},
      o.table);
  visit(OptionText{"angle", "DEG", "turns the axes of anisotropic lengths about z, in degrees"},
        o.angle);
  visit(OptionText{"axes", "", "directions of anisotropic lengths; job files only"}, o.axes);
  visit(OptionText{"cutoff", "LENGTH",
                   "shortest scale of the roughness, in the length unit of the mesh: what is finer "
                   "is left out with its variance, and other meshes of the body get the same "
                   "heights at the same places (for equal seed, tolerance and options). Without it "
                   "only gaussian does, and by --method cholesky nothing"},
        o.cutoff);
  visit(OptionText{"distance", "KIND",
                   "distance that correlation depends on; default: euclidean, or periodic where "
                   "the mesh links moving nodes"},
        o.distance);
  visit(OptionText{"period", "LX,LY,LZ",
                   "periods of periodic and minimum-image, 0 for an axis without; default: those "
                   "of the mesh's periodic links"},
        o.period);
}

/// Likewise for every option of one surface, in the order of --help. `Options` is Roughness, const
/// or not.
template <class Options, class Visit>
void for_each_surface_option(Options& o, Visit&& visit) {
  visit(OptionText{"group", "NAME|NUMBER|all",
                   "physical group to roughen, repeatable; default: the only group of faces (lines "
                   "of a planar mesh), or the whole boundary of a mesh without groups"},
        o.group);
  for_each_autocorrelation_option(o, visit);
  visit(OptionText{"seed", "S", "seed of the ensemble"}, o.seed);
  visit(OptionText{"edges", "RULE",
                   "sharp edges and corners: offset keeps the height of every face there, average "
                   "moves them along mean normals, fix holds them"},
        o.edges);
  visit(OptionText{"edge_angle", "DEG",
                   "edges with a larger angle between normals are sharp, in degrees"},
        o.edge_angle);
  visit(OptionText{"flip", "", "turn the normals round: positive heights go inward"}, o.flip);
  visit(OptionText{"fixed", "GROUP", "physical group whose nodes stay, repeatable"}, o.fixed);
  visit(OptionText{"fade", "WIDTH[:GROUP]",
                   "heights fall to zero over WIDTH towards the border of the surface, or towards "
                   "GROUP; repeatable"},
        o.fade);
  visit(OptionText{"mask", "", "weights by box, sphere or formula; job files only"}, o.mask);
}

/// Likewise for every option that says how files are read and written.
template <class Options, class Visit>
void for_each_file_option(Options& o, Visit&& visit) {
  visit(OptionText{"format", "NAME", "format of OUTPUT, where its extension does not tell it"},
        o.format);
  visit(OptionText{"ascii", "", "write OUTPUT as text"}, o.ascii);
  visit(OptionText{"binary", "", "write OUTPUT as binary"}, o.binary);
  visit(OptionText{"mesh_size", "H",
                   "mesh size for CAD input; default: correlation length / 2.5. Scripts keep their "
                   "own without it"},
        o.mesh_size);
  visit(OptionText{"round", "RADIUS",
                   "round the sharp edges of solids of a CAD file first (--edge-angle); best at "
                   "least two mesh sizes"},
        o.round);
  visit(OptionText{"gmsh", "PATH",
                   "the gmsh program, which meshes CAD files and scripts and fills volumes"},
        o.gmsh);
  visit(OptionText{"timeout", "S", "seconds that gmsh may take"}, o.timeout);
  visit(OptionText{"trust_scripts", "",
                   "run geometry scripts that call programs or read and write other files"},
        o.trust_scripts);
}

/// Likewise for every option of a run.
template <class Options, class Visit>
void for_each_run_option(Options& o, Visit&& visit) {
  visit(OptionText{"input", "INPUT",
                   "mesh to roughen (docs/files.md lists the formats), CAD file (.step, .brep) or "
                   "geometry script (.geo)"},
        o.input);
  visit(OptionText{"checksum", "HEX",
                   "checksum of INPUT, as reports have it; another file is roughened with a "
                   "warning"},
        o.checksum);
  visit(OptionText{"output", "OUTPUT",
                   "file to write, in the format of its extension; {realization} becomes the "
                   "number of the realization, {realization:04} with leading zeros"},
        o.output);
  visit(
      OptionText{"method", "NAME",
                 "sampling method (lattice: linear in the nodes, --distance euclidean or periodic; "
                 "cholesky: any distance, memory as the square of the nodes; auto: lattice for "
                 "those distances, but for a table that is no sum of Gaussians)"},
      o.method);
  visit(
      OptionText{"tolerance", "T",
                 "largest error of covariances over Rq^2, between 0 and 1 (lattice: 1e-8 or more): "
                 "lattice keeps it, and beyond it there is a warning"},
      o.tolerance);
  visit(OptionText{"realizations", "N", "number of meshes to make"}, o.realizations);
  visit(OptionText{"first", "K", "number of the first realization"}, o.first);
  visit(OptionText{"volume", "HOW",
                   "what the interior of a volume mesh does (move: it follows, and is meshed anew "
                   "if all else fails; remesh: gmsh meshes volumes beside the surface anew, and "
                   "fills a bare closed surface)"},
        o.volume);
  visit(
      OptionText{"box", "FACTOR",
                 "with --volume remesh of a bare closed surface: mesh the space around it too, up "
                 "to a box FACTOR times its bounding box, > 1"},
      o.box);
  visit(OptionText{"allow_invalid", "", "write meshes with inverted elements too, with a warning"},
        o.allow_invalid);
  visit(OptionText{"unit", "NAME", "name of the length unit, repeated in the report"}, o.unit);
  visit(OptionText{"report", "FILE",
                   "report to write (default: OUTPUT without {realization} and extension, + "
                   ".report.json)"},
        o.report);
  for_each_file_option(o, visit);
  visit(OptionText{"threads", "T", "number of threads; 0: one per core"}, o.threads);
  visit(OptionText{"quiet", "", "print nothing on success"}, o.quiet);
}

/// Every value of an enumeration among the options, in the order of --help. `name` spells each.
template <class Enum>
struct Choices;
template <>
struct Choices<Family> {
  static constexpr std::array values = {
      Family::gaussian,  Family::exponential,        Family::matern, Family::self_affine,
      Family::stretched, Family::rational_quadratic, Family::table};
};
template <>
struct Choices<LengthDefinition> {
  static constexpr std::array values = {LengthDefinition::formula, LengthDefinition::one_over_e,
                                        LengthDefinition::integral, LengthDefinition::sal};
};
template <>
struct Choices<DistanceKind> {
  static constexpr std::array values = {DistanceKind::euclidean, DistanceKind::great_circle,
                                        DistanceKind::periodic, DistanceKind::minimum_image,
                                        DistanceKind::curve};
};
template <>
struct Choices<Method> {
  static constexpr std::array values = {Method::automatic, Method::cholesky, Method::lattice};
};
template <>
struct Choices<EdgeRule> {
  static constexpr std::array values = {EdgeRule::offset, EdgeRule::average, EdgeRule::fix};
};
template <>
struct Choices<VolumeChoice> {
  static constexpr std::array values = {VolumeChoice::move, VolumeChoice::remesh,
                                        VolumeChoice::none};
};
template <>
struct Choices<MeshFormat> {
  static constexpr std::array values = {MeshFormat::msh2, MeshFormat::msh4,   MeshFormat::stl,
                                        MeshFormat::ply,  MeshFormat::ply2,   MeshFormat::obj,
                                        MeshFormat::off,  MeshFormat::abaqus, MeshFormat::nastran,
                                        MeshFormat::unv,  MeshFormat::medit,  MeshFormat::su2,
                                        MeshFormat::vtk,  MeshFormat::vtu};
};

/// Checks every option that can be checked without the mesh.
/// @throws InputError  names the option as on the command line, the value and the range
void check_options(const RoughenOptions& options);

/// What of it concerns mesh and field; rms roughness and length may be missing.
void check_field_options(const RoughenOptions& options);

/// Options from a job file: TOML, or JSON (an object of options, or the report of an earlier run,
/// whose "request" is taken). Options that the file does not name keep their defaults. Options of a
/// surface stand at the top, or in one table `surface` for each of several; what such a table does
/// not name, it takes from the top. `gmsh` and `trust_scripts`, which could run programs, are for
/// the command line: refused in a job, left out of a report.
/// @throws InputError   unknown key, value of the wrong type
/// @throws FormatError  neither TOML nor JSON
RoughenOptions read_job(const std::filesystem::path& path);

/// Path of one realization: every {realization} and {realization:0N} in the template replaced.
std::string output_path(const std::string& output, std::uint64_t realization);

/// Where the report goes: `report`, or next to `output`.
std::string report_path(const RoughenOptions& options);

// What the stages need, taken from the options.
AutocorrelationOptions autocorrelation_options(const Roughness& roughness);
SurfaceOptions surface_options(const Roughness& roughness);
MaskOptions mask_options(const Roughness& roughness);  ///< @throws InputError  a fade without width
FieldOptions field_options(const RoughenOptions& options, const Roughness& roughness);
/// Orthonormal columns, from the axes or the angle that are given.
/// @throws InputError  axes that are not orthogonal to 1e-6
Eigen::Matrix3d length_axes(const Roughness& roughness);
WriteOptions write_options(const RoughenOptions& options);
GeometryOptions geometry_options(const RoughenOptions& options);

/// May two surfaces of a run carry one field, evaluated on both? True where all that the field
/// depends on is equal: seed, autocorrelation, cutoff, distance.
bool same_field(const Roughness& a, const Roughness& b);

}  // namespace roughmesh
