// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <tuple>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "roughmesh/resolution.hpp"

#include "file_formats.hpp"
#include "job_syntax.hpp"
#include "json_numbers.hpp"
#include "options_json.hpp"

namespace roughmesh {
namespace {

using nlohmann::json;

/// Calls itself: the depth was checked before.
json toml_to_json(const toml::node& node, const std::string& source) {
  if (const auto* table = node.as_table()) {
    json object = json::object();
    for (const auto& [key, value] : *table)
      object[std::string(key.str())] = toml_to_json(value, source);
    return object;
  }
  if (const auto* array = node.as_array()) {
    json list = json::array();
    for (const toml::node& item : *array) list.push_back(toml_to_json(item, source));
    return list;
  }
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return number->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  if (const auto* number = node.as_floating_point()) {
    return detail::number_to_json(number->get());
  }
  throw InputError(fmt::format("{}: dates and times are no option values", source));
}

json parse_toml(const std::string& text, const std::string& source) {
  detail::check_toml_syntax(text, source);
  try {
    return toml_to_json(toml::parse(text), source);
  } catch (const toml::parse_error& error) {
    throw FormatError(
        fmt::format("{}:{}: not TOML: {}", source, error.source().begin.line, error.description()));
  }
}

json parse_json(const std::string& text, const std::string& source) {
  detail::check_json_syntax(text, source);
  json object = json::parse(text, nullptr, false);
  if (object.is_discarded())
    throw FormatError(fmt::format("{}: broken JSON; write it anew", source));
  if (object.is_object() && object.contains("request")) return object["request"];
  return object;
}

std::string read_text(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(fmt::format("{}: is a folder; give a job file", path.string()));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be read; check the path", path.string()));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void require(bool good, std::string_view option, double value, std::string_view range) {
  if (!good) throw InputError(fmt::format("{}: {:g}; must be {}", option, value, range));
}

/// A {realization} or {realization:0N} found in a template.
struct Placeholder {
  std::size_t begin = std::string::npos, end = 0;
  std::size_t width = 0;
};

Placeholder find_placeholder(const std::string& text, std::size_t from) {
  static const std::string opening = "{realization";
  for (std::size_t at = text.find(opening, from); at != std::string::npos;
       at = text.find(opening, at + 1)) {
    std::size_t end = at + opening.size();
    std::size_t width = 0;
    if (text.compare(end, 2, ":0") == 0) {
      for (end += 2; end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]));
           ++end)
        width = std::min<std::size_t>(width * 10 + static_cast<std::size_t>(text[end] - '0'), 20);
    }
    if (end < text.size() && text[end] == '}') return {at, end + 1, width};
  }
  return {};
}

template <class Replace>
std::string replace_placeholders(const std::string& text, Replace&& replacement) {
  std::string result;
  std::size_t from = 0;
  for (Placeholder found = find_placeholder(text, 0); found.begin != std::string::npos;
       found = find_placeholder(text, from)) {
    result += text.substr(from, found.begin - from) + replacement(found.width);
    from = found.end;
  }
  return result + text.substr(from);
}

bool has_placeholder(const std::string& text) {
  return find_placeholder(text, 0).begin != std::string::npos;
}

std::filesystem::path normal(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

/// Is this the path of one of the realizations of the run?
bool is_realization(const RoughenOptions& o, const std::filesystem::path& path) {
  const std::string text = path.string(), output = normal(o.output).string();
  const std::size_t begin = find_placeholder(output, 0).begin;
  if (begin == output.npos) return text == output;
  std::uint64_t number = 0;
  if (begin >= text.size() ||
      std::from_chars(text.data() + begin, text.data() + text.size(), number).ec != std::errc())
    return false;
  return number >= o.first && number - o.first < o.realizations &&
         normal(output_path(o.output, number)) == path;
}

/// The report must not take the place of a file of the same run.
void check_report(const RoughenOptions& o) {
  if (o.output.empty()) return;
  const std::filesystem::path report = normal(report_path(o));
  bool is_taken = is_realization(o, report) || (!o.input.empty() && normal(o.input) == report);
  for (const Roughness& surface : o.surfaces)
    is_taken |= !surface.table.empty() && normal(surface.table) == report;
  if (is_taken)
    throw InputError(
        fmt::format("--report: {}; is another file of this run, name a new one", report_path(o)));
}

void check_ensemble(const RoughenOptions& o) {
  const std::string rest =
      replace_placeholders(o.output, [](std::size_t) { return std::string(); });
  if (rest.find_first_of("{}") != std::string::npos)
    throw InputError(fmt::format(
        "OUTPUT: {}; braces hold {{realization}}, or {{realization:04}} for leading zeros",
        o.output));
  require(o.realizations >= 1, "--realizations", static_cast<double>(o.realizations), "at least 1");
  if (o.first > std::numeric_limits<std::uint64_t>::max() - o.realizations)
    throw InputError(
        fmt::format("--first: {}; --first plus --realizations must stay below 2^64", o.first));
  if (o.realizations > 1 && !o.output.empty() && !has_placeholder(o.output))
    throw InputError(
        fmt::format("OUTPUT: {}; must contain {{realization}} when --realizations is {}", o.output,
                    o.realizations));
}

void check_lengths(const Roughness& o) {
  if (o.length.size() > 3)
    throw InputError(fmt::format("--length: {} numbers; give one, two or three", o.length.size()));
  if (o.angle != 0 && o.length.size() < 2)
    throw InputError(
        fmt::format("--angle: {:g}; turns the axes of anisotropic lengths, give --length "
                    "L,LY,LZ",
                    o.angle));
  const DistanceKind distance = o.distance.value_or(DistanceKind::euclidean);
  if (o.length.size() > 1 &&
      (distance == DistanceKind::great_circle || distance == DistanceKind::curve))
    throw InputError(
        fmt::format("--length: {} numbers; anisotropic lengths do not go with "
                    "--distance {}",
                    o.length.size(), name(distance)));
}

void check_period(const Roughness& o) {
  if (o.period.empty()) return;
  const bool is_used = !o.distance || o.distance == DistanceKind::periodic ||
                       o.distance == DistanceKind::minimum_image;
  if (o.period.size() != 3)
    throw InputError(fmt::format("--period: {} numbers; give LX,LY,LZ with 0 for an axis without",
                                 o.period.size()));
  if (!is_used)
    throw InputError(fmt::format("--period: goes with --distance periodic or minimum-image, not {}",
                                 name(*o.distance)));
}

void check_roughness(const Roughness& o) {
  if (o.rms == 0)
    throw InputError("--rms: missing or 0; give the rms roughness, a positive number");
  require(std::isfinite(o.rms) && o.rms > 0, "--rms", o.rms, "a positive number");
  check_shape(o);
  // Throws for a parameter that is missing, foreign to the family or out of range.
  Autocorrelation{autocorrelation_options(o)};
}

/// Distances over one body or curve do not reach from one surface to another.
bool can_be_shared(const Roughness& o) {
  return o.distance != DistanceKind::great_circle && o.distance != DistanceKind::curve;
}

/// Two fields drawn from the same random numbers would resemble each other in no useful way.
void check_seeds(const std::vector<Roughness>& surfaces) {
  for (std::size_t j = 0; j < surfaces.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      if (surfaces[i].seed != surfaces[j].seed) continue;
      if (same_field(surfaces[i], surfaces[j]) && can_be_shared(surfaces[j])) continue;
      const std::string why =
          same_field(surfaces[i], surfaces[j])
              ? fmt::format("--distance {} does not reach from one to the other",
                            name(*surfaces[j].distance))
              : "different autocorrelation";
      throw InputError(fmt::format(
          "surfaces {} and {} have the same seed {}, but {}; give one of them another seed", i + 1,
          j + 1, surfaces[i].seed, why));
    }
}

void check_surfaces(const std::vector<Roughness>& surfaces) {
  if (surfaces.empty()) throw InputError("surface: an empty list; describe at least one surface");
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    try {
      check_roughness(surfaces[i]);
    } catch (const InputError& error) {
      if (surfaces.size() == 1) throw;
      throw InputError(fmt::format("surface {}: {}", i + 1, error.what()));
    }
    if (surfaces.size() > 1 && surfaces[i].group.empty())
      throw InputError(
          fmt::format("surface {}: no group; name one where there are several surfaces", i + 1));
  }
  check_seeds(surfaces);
}

void check_files(const RoughenOptions& o) {
  if (o.ascii && o.binary)
    throw InputError("--ascii: not together with --binary; give one of them");
  if (o.mesh_size)
    require(std::isfinite(*o.mesh_size) && *o.mesh_size > 0, "--mesh-size", *o.mesh_size,
            "a positive number");
  require(std::isfinite(o.timeout) && o.timeout > 0, "--timeout", o.timeout,
          "a positive number of seconds");
}

}  // namespace

std::string_view name(VolumeChoice choice) {
  return choice == VolumeChoice::move ? "move" : "none";
}

void check_shape(const Roughness& o) {
  require(o.edge_angle > 0 && o.edge_angle <= 180, "--edge-angle", o.edge_angle,
          "above 0 and at most 180 degrees");
  require(std::isfinite(o.angle), "--angle", o.angle, "a finite number of degrees");
  check_lengths(o);
  check_period(o);
  mask_options(o);
}

void check_options(const RoughenOptions& o) {
  require(std::isfinite(o.tolerance) && o.tolerance > 0, "--tolerance", o.tolerance,
          "a positive number");
  require(o.threads >= 0 && o.threads <= 4096, "--threads", o.threads, "from 0 to 4096");
  check_ensemble(o);
  check_report(o);
  check_files(o);
  method_from_name(o.method);
  check_surfaces(o.surfaces);
}

RoughenOptions read_job(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  const std::string source = path.string();
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  const bool is_json = start != std::string::npos && text[start] == '{';
  RoughenOptions options = detail::options_from_json(
      is_json ? parse_json(text, source) : parse_toml(text, source), source);
  // A file from elsewhere must not choose what runs here. The report of a run names both; who
  // trusts it says so again.
  const RoughenOptions defaults;
  const bool is_report = is_json && text.find("\"request\"") != text.npos;
  if (!is_report && (options.trust_scripts || options.gmsh != defaults.gmsh))
    throw InputError(fmt::format(
        "{}: {}; only the command line may say it, so that a job runs nothing of its own", source,
        options.trust_scripts ? "trust_scripts" : "gmsh"));
  options.gmsh = defaults.gmsh;
  options.trust_scripts = defaults.trust_scripts;
  return options;
}

std::string output_path(const std::string& output, std::uint64_t realization) {
  return replace_placeholders(
      output, [&](std::size_t width) { return fmt::format("{:0{}}", realization, width); });
}

std::string report_path(const RoughenOptions& options) {
  if (!options.report.empty()) return options.report;
  const std::filesystem::path output = options.output;
  // A folder of its own for each realization is no place for what they have in common.
  std::filesystem::path folder = output.parent_path();
  while (has_placeholder(folder.string())) folder = folder.parent_path();
  const std::filesystem::path file =
      replace_placeholders(output.filename().string(), [](std::size_t) { return std::string(); });
  return (folder / (file.stem().string() + ".report.json")).string();
}

AutocorrelationOptions autocorrelation_options(const Roughness& o) {
  AutocorrelationOptions result{.family = o.acf,
                                .length = std::nullopt,
                                .length_definition = o.length_definition,
                                .nu = o.nu,
                                .hurst = o.hurst,
                                .rolloff = o.rolloff,
                                .power = o.power,
                                .alpha = o.alpha,
                                .table = {}};
  if (o.acf == Family::table && o.table.empty())
    throw InputError("--table: missing; give the file with the two columns of --acf table");
  if (!o.table.empty()) result.table = read_correlation_table(o.table);
  // Anisotropic lengths scale the distance; rho belongs to the first finite one. A single length is
  // taken as it is, so that the family can refuse it by name.
  if (!o.length.empty()) result.length = o.length.front();
  if (o.length.size() > 1)
    for (const double length : o.length)
      if (std::isfinite(length)) {
        result.length = length;
        break;
      }
  return result;
}

SurfaceOptions surface_options(const Roughness& o) {
  return {
      .groups = o.group, .flip = o.flip, .sharp_angle = o.edge_angle / 180.0 * std::numbers::pi};
}

FieldOptions field_options(const RoughenOptions& o) {
  return {.method = method_from_name(o.method), .tolerance = o.tolerance};
}

namespace {

Fade parse_fade(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string number = text.substr(0, colon);
  Fade fade{.width = 0, .group = colon == text.npos ? "" : text.substr(colon + 1)};
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, fade.width);
  if (error != std::errc() || stop != end || !(fade.width > 0) || !std::isfinite(fade.width) ||
      (colon != text.npos && fade.group.empty()))
    throw InputError(fmt::format(
        "--fade: {}; must be a positive WIDTH or WIDTH:GROUP, such as 0.5:inlet", text));
  return fade;
}

}  // namespace

MaskOptions mask_options(const Roughness& o) {
  MaskOptions options;
  options.fixed = o.fixed;
  for (const std::string& text : o.fade) options.fade.push_back(parse_fade(text));
  for (const Mask& mask : o.mask) {
    if (const auto* box = std::get_if<BoxMask>(&mask)) options.boxes.push_back(*box);
    if (const auto* sphere = std::get_if<SphereMask>(&mask)) options.spheres.push_back(*sphere);
    if (const auto* formula = std::get_if<FormulaMask>(&mask)) options.formulas.push_back(*formula);
  }
  return options;
}

WriteOptions write_options(const RoughenOptions& o) {
  WriteOptions options{.format = o.format};
  if (o.ascii) options.encoding = Encoding::text;
  if (o.binary) options.encoding = Encoding::binary;
  return options;
}

namespace {

/// Along its shortest axis, in the sense of the formula; nothing without a length.
std::optional<double> shortest_length(const Roughness& o) {
  if (o.length.empty() && !o.rolloff && o.table.empty()) return std::nullopt;
  if (o.length.size() > 1) return *std::min_element(o.length.begin(), o.length.end());
  return Autocorrelation(autocorrelation_options(o)).length();
}

}  // namespace

GeometryOptions geometry_options(const RoughenOptions& o) {
  GeometryOptions options;
  options.gmsh = o.gmsh;
  options.timeout = o.timeout;
  options.trust_scripts = o.trust_scripts;
  if (o.mesh_size) options.mesh_size = *o.mesh_size;
  // A script knows its own sizes.
  if (o.mesh_size || detail::lower_extension(o.input) == ".geo") return options;
  double shortest = std::numeric_limits<double>::infinity();
  for (const Roughness& surface : o.surfaces)
    shortest = std::min(shortest, shortest_length(surface).value_or(shortest));
  if (!std::isfinite(shortest))
    throw InputError(
        "--mesh-size: missing; CAD files need it, or --length, of which it is 1 / 2.5");
  options.mesh_size = shortest / sizes_per_length;
  return options;
}

bool same_field(const Roughness& a, const Roughness& b) {
  const auto key = [](const Roughness& o) {
    return std::tie(o.seed, o.length, o.acf, o.length_definition, o.nu, o.hurst, o.rolloff, o.power,
                    o.alpha, o.table, o.angle, o.distance, o.period);
  };
  return key(a) == key(b);
}

}  // namespace roughmesh
