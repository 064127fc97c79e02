// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "roughmesh/options.hpp"

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

}  // namespace

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

}  // namespace roughmesh
