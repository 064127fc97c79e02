// SPDX-License-Identifier: BSD-3-Clause
#include "step_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "scanner.hpp"

namespace roughmesh::detail {
namespace {

using Id = std::uint64_t;

constexpr double metre = 1000;  // in millimetres

// One `#id = ...;` of the data section, without spaces outside its strings.
struct Instance {
  Id id = 0;
  std::string text;  ///< behind the equals sign
};

// Goes from instance to instance; strings ('...', quotes doubled) and comments may hold anything.
class InstanceReader {
 public:
  explicit InstanceReader(std::string_view bytes) : bytes_(bytes) {}

  bool next(Instance& instance) {
    instance.text.clear();
    while (position_ < bytes_.size() && bytes_[position_] != ';') step(instance.text);
    if (position_ == bytes_.size()) return false;
    ++position_;
    split(instance);
    return true;
  }

 private:
  void step(std::string& text) {
    const char c = bytes_[position_];
    if (c == '\'')
      copy_string(text);
    else if (c == '/' && bytes_.substr(position_, 2) == "/*")
      position_ = end_of("*/", position_ + 2);
    else if (++position_; !is_space(c))
      text += c;
  }

  void copy_string(std::string& text) {
    const std::size_t end = end_of("'", position_ + 1);
    text += bytes_.substr(position_, end - position_);
    position_ = end;
  }

  std::size_t end_of(std::string_view closing, std::size_t from) const {
    const std::size_t found = bytes_.find(closing, from);
    return found == std::string_view::npos ? bytes_.size() : found + closing.size();
  }

  static void split(Instance& instance) {
    instance.id = 0;
    const std::size_t equals = instance.text.find('=');
    if (instance.text.empty() || instance.text[0] != '#' || equals == std::string::npos) return;
    std::from_chars(instance.text.data() + 1, instance.text.data() + equals, instance.id);
    instance.text.erase(0, equals + 1);
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
};

// What stands in the parentheses behind a name; empty where the name is missing.
std::string_view arguments(std::string_view text, std::string_view name) {
  const std::size_t begin = text.find(name);
  if (begin == std::string_view::npos) return {};
  text.remove_prefix(begin + name.size());
  std::size_t depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')' && --depth == 0) return text.substr(1, i - 1);
    if (depth == 0) break;
  }
  return {};
}

std::vector<Id> references(std::string_view text) {
  std::vector<Id> ids;
  for (std::size_t i = text.find('#'); i != std::string_view::npos; i = text.find('#', i + 1)) {
    Id id = 0;
    const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + text.size(), id);
    if (error == std::errc()) ids.push_back(id);
  }
  return ids;
}

std::optional<double> si_prefix(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, double>, 17> prefixes = {{{"$", 1},
                                                                             {".EXA.", 1e18},
                                                                             {".PETA.", 1e15},
                                                                             {".TERA.", 1e12},
                                                                             {".GIGA.", 1e9},
                                                                             {".MEGA.", 1e6},
                                                                             {".KILO.", 1e3},
                                                                             {".HECTO.", 1e2},
                                                                             {".DECA.", 1e1},
                                                                             {".DECI.", 1e-1},
                                                                             {".CENTI.", 1e-2},
                                                                             {".MILLI.", 1e-3},
                                                                             {".MICRO.", 1e-6},
                                                                             {".NANO.", 1e-9},
                                                                             {".PICO.", 1e-12},
                                                                             {".FEMTO.", 1e-15},
                                                                             {".ATTO.", 1e-18}}};
  const auto* const found = std::find_if(prefixes.begin(), prefixes.end(),
                                         [&](const auto& prefix) { return prefix.first == name; });
  return found == prefixes.end() ? std::nullopt : std::optional(found->second);
}

std::optional<double> first_number(std::string_view text) {
  while (!text.empty() && text.front() != '-' && (text.front() < '0' || text.front() > '9'))
    text.remove_prefix(1);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && value > 0 ? std::optional(value) : std::nullopt;
}

// The instances that say what a unit is, and which one the first context uses.
struct Units {
  std::unordered_map<Id, std::string> lengths;   ///< LENGTH_UNIT
  std::unordered_map<Id, std::string> measures;  ///< ..._MEASURE_WITH_UNIT
  std::vector<Id> used;
};

Units read_units(std::string_view bytes) {
  Units units;
  InstanceReader reader(bytes);
  Instance instance;
  while (reader.next(instance)) {
    const std::string_view context = arguments(instance.text, "GLOBAL_UNIT_ASSIGNED_CONTEXT");
    if (units.used.empty() && !context.empty()) units.used = references(context);
    if (instance.text.find("LENGTH_UNIT(") != std::string::npos)
      units.lengths.emplace(instance.id, instance.text);
    else if (instance.text.find("MEASURE_WITH_UNIT") != std::string::npos)
      units.measures.emplace(instance.id, instance.text);
  }
  return units;
}

std::optional<double> si_length(std::string_view text) {
  const std::string_view unit = arguments(text, "SI_UNIT");
  const std::size_t comma = unit.find(',');
  if (comma == std::string_view::npos || unit.substr(comma + 1) != ".METRE.") return {};
  const std::optional<double> prefix = si_prefix(unit.substr(0, comma));
  return prefix ? std::optional(*prefix * metre) : std::nullopt;
}

// CONVERSION_BASED_UNIT('INCH',#1), #1 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#2), and #2
// an SI_UNIT. Followed no further, so that a circle of references does no harm.
std::optional<double> converted_length(const Units& units, std::string_view text) {
  for (const Id id : references(arguments(text, "CONVERSION_BASED_UNIT"))) {
    const auto measure = units.measures.find(id);
    if (measure == units.measures.end()) continue;
    const std::optional<double> factor =
        first_number(arguments(measure->second, "(LENGTH_MEASURE"));
    for (const Id base : references(measure->second)) {
      const auto found = units.lengths.find(base);
      if (found == units.lengths.end() || !factor) continue;
      if (const std::optional<double> unit = si_length(found->second)) return *factor * *unit;
    }
  }
  return {};
}

}  // namespace

bool is_step(std::string_view bytes) {
  while (!bytes.empty() && is_space(bytes.front())) bytes.remove_prefix(1);
  return bytes.starts_with("ISO-10303-21;");
}

std::optional<double> step_length_unit(std::string_view bytes) {
  const Units units = read_units(bytes);
  for (const Id id : units.used) {
    const auto found = units.lengths.find(id);
    if (found == units.lengths.end()) continue;
    if (const auto length = si_length(found->second)) return length;
    if (const auto length = converted_length(units, found->second)) return length;
  }
  return {};
}

}  // namespace roughmesh::detail
