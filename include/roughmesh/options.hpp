// SPDX-License-Identifier: BSD-3-Clause
// Everything a user can ask of `roughen`, declared once for C++, command line, job file and report.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"
#include "roughmesh/error.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// What the interior of a volume mesh does.
enum class VolumeChoice {
  move,  ///< it follows the surface
  none   ///< it stays; only nodes of the surface move
};

std::string_view name(VolumeChoice choice);

/// Lengths are in the unit of the mesh, angles in degrees (they are typed by people).
struct RoughenOptions {
  std::string input = {};
  std::string checksum = {};
  std::string output = {};
  std::vector<std::string> group = {};
  double rms = 0;
  std::vector<double> length = {};
  Family acf = Family::gaussian;
  LengthDefinition length_definition = LengthDefinition::formula;
  std::optional<double> nu = {}, hurst = {}, rolloff = {}, power = {}, alpha = {};
  double angle = 0;
  DistanceKind distance = DistanceKind::euclidean;
  std::string method = "auto";
  double tolerance = 1e-4;
  std::uint64_t seed = 0;
  std::uint64_t realizations = 1;
  std::uint64_t first = 0;
  VolumeChoice volume = VolumeChoice::move;
  double edge_angle = 40;
  bool flip = false;
  bool allow_invalid = false;
  std::string unit = {};
  std::string report = {};
  int threads = 0;
  bool quiet = false;
};

/// How an option is spelled and explained. The command line writes `-` for `_`.
struct OptionText {
  std::string_view name;   ///< key in job files and reports
  std::string_view value;  ///< placeholder of its value in --help; empty for a switch
  std::string_view help;
};

/// Calls visit(OptionText, member) for every option, in the order of --help. `Options` is
/// RoughenOptions, const or not.
template <class Options, class Visit>
void for_each_option(Options& options, Visit&& visit) {
  visit(OptionText{"input", "INPUT", "mesh to roughen: .msh (2.2, 4.1), .stl, .ply2"},
        options.input);
  visit(
      OptionText{"checksum", "HEX",
                 "checksum of INPUT, as reports have it; another file is roughened with a warning"},
      options.checksum);
  visit(
      OptionText{
          "output", "OUTPUT",
          "file to write, in the format of INPUT or .vtu; {realization} becomes the number of "
          "the realization, {realization:04} with leading zeros"},
      options.output);
  visit(
      OptionText{
          "group", "NAME|NUMBER|all",
          "physical group to roughen, repeatable; default: the only surface group, or the whole "
          "boundary of a mesh without groups"},
      options.group);
  visit(OptionText{"rms", "VALUE", "rms roughness Rq, in the length unit of the mesh; required"},
        options.rms);
  visit(
      OptionText{
          "length", "L[,LY[,LZ]]",
          "correlation length, in the length unit of the mesh; three for an anisotropic field "
          "(of two, the second counts for y and z; inf makes streaks)"},
      options.length);
  visit(OptionText{"acf", "FAMILY", "autocorrelation function"}, options.acf);
  visit(OptionText{"length_definition", "NAME", "what --length is"}, options.length_definition);
  visit(OptionText{"nu", "N", "smoothness of matern, > 0"}, options.nu);
  visit(OptionText{"hurst", "H", "Hurst exponent of self-affine, between 0 and 1"}, options.hurst);
  visit(OptionText{"rolloff", "LAMBDA",
                   "roll-off wavelength of self-affine, in the length unit of the mesh, instead of "
                   "--length"},
        options.rolloff);
  visit(OptionText{"power", "P", "exponent of stretched, > 0 and at most 2"}, options.power);
  visit(OptionText{"alpha", "A", "exponent of rational-quadratic, > 0"}, options.alpha);
  visit(OptionText{"angle", "DEG", "turns the axes of anisotropic lengths about z, in degrees"},
        options.angle);
  visit(OptionText{"distance", "KIND", "distance that correlation depends on"}, options.distance);
  visit(OptionText{"method", "NAME", "sampling method: auto, cholesky"}, options.method);
  visit(OptionText{"tolerance", "T", "covariance error that is accepted without a warning"},
        options.tolerance);
  visit(OptionText{"seed", "S", "seed of the ensemble"}, options.seed);
  visit(OptionText{"realizations", "N", "number of meshes to make"}, options.realizations);
  visit(OptionText{"first", "K", "number of the first realization"}, options.first);
  visit(OptionText{"volume", "HOW", "what the interior of a volume mesh does"}, options.volume);
  visit(OptionText{"edge_angle", "DEG",
                   "edges with a larger angle between normals are sharp, in degrees"},
        options.edge_angle);
  visit(OptionText{"flip", "", "turn the normals round: positive heights go inward"}, options.flip);
  visit(OptionText{"allow_invalid", "", "write meshes with inverted elements too, with a warning"},
        options.allow_invalid);
  visit(OptionText{"unit", "NAME", "name of the length unit, repeated in the report"},
        options.unit);
  visit(
      OptionText{
          "report", "FILE",
          "report to write (default: OUTPUT without {realization} and extension, + .report.json)"},
      options.report);
  visit(OptionText{"threads", "T", "number of threads; 0: one per core"}, options.threads);
  visit(OptionText{"quiet", "", "print nothing on success"}, options.quiet);
}

/// Every value of an enumeration among the options, in the order of --help. `name` spells each.
template <class Enum>
struct Choices;
template <>
struct Choices<Family> {
  static constexpr std::array values = {Family::gaussian,  Family::exponential,
                                        Family::matern,    Family::self_affine,
                                        Family::stretched, Family::rational_quadratic};
};
template <>
struct Choices<LengthDefinition> {
  static constexpr std::array values = {LengthDefinition::formula, LengthDefinition::one_over_e,
                                        LengthDefinition::integral, LengthDefinition::sal};
};
template <>
struct Choices<DistanceKind> {
  static constexpr std::array values = {DistanceKind::euclidean, DistanceKind::great_circle};
};
template <>
struct Choices<VolumeChoice> {
  static constexpr std::array values = {VolumeChoice::move, VolumeChoice::none};
};

/// Checks every option that can be checked without the mesh.
/// @throws InputError  names the option as on the command line, the value and the range
void check_options(const RoughenOptions& options);

/// Options from a job file: TOML, or JSON (an object of options, or the report of an earlier run,
/// whose "request" is taken). Options that the file does not name keep their defaults.
/// @throws InputError   unknown key, value of the wrong type
/// @throws FormatError  neither TOML nor JSON
RoughenOptions read_job(const std::filesystem::path& path);

/// Path of one realization: every {realization} and {realization:0N} in the template replaced.
std::string output_path(const std::string& output, std::uint64_t realization);

/// Where the report goes: `report`, or next to `output`.
std::string report_path(const RoughenOptions& options);

// What the stages need, taken from the options.
AutocorrelationOptions autocorrelation_options(const RoughenOptions& options);
SurfaceOptions surface_options(const RoughenOptions& options);
FieldOptions field_options(const RoughenOptions& options);

}  // namespace roughmesh
