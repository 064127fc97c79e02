// SPDX-License-Identifier: BSD-3-Clause
#include "options_json.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <type_traits>

#include <fmt/format.h>

#include "json_numbers.hpp"
#include "mask_json.hpp"

namespace roughmesh::detail {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// Thrown by the readers below; caught where the key is known.
struct WrongType {
  std::string expected;
};

double require_number(const json& value) {
  const std::optional<double> number = number_from_json(value);
  if (!number) throw WrongType{"a number"};
  return *number;
}

ordered_json to_json_value(const std::string& value) { return value; }
ordered_json to_json_value(bool value) { return value; }
ordered_json to_json_value(int value) { return value; }
ordered_json to_json_value(std::uint64_t value) { return value; }
ordered_json to_json_value(double value) { return number_to_json(value); }
ordered_json to_json_value(const std::optional<double>& value) {
  return value ? number_to_json(*value) : ordered_json();
}
ordered_json to_json_value(const std::vector<std::string>& value) { return value; }
ordered_json to_json_value(const std::vector<double>& value) {
  ordered_json list = ordered_json::array();
  for (const double number : value) list.push_back(number_to_json(number));
  return list;
}
ordered_json to_json_value(const std::vector<Vec3>& value) {
  ordered_json list = ordered_json::array();
  for (const Vec3& v : value) list.push_back({v.x(), v.y(), v.z()});
  return list;
}
ordered_json to_json_value(const std::vector<Mask>& value) {
  ordered_json list = ordered_json::array();
  for (const Mask& mask : value) list.push_back(mask_to_json(mask));
  return list;
}
template <class Enum>
requires std::is_enum_v<Enum> ordered_json to_json_value(Enum value) { return name(value); }
template <class Enum>
requires std::is_enum_v<Enum> ordered_json to_json_value(const std::optional<Enum>& value) {
  return value ? ordered_json(name(*value)) : ordered_json();
}

void from_json_value(const json& value, std::string& target) {
  if (!value.is_string()) throw WrongType{"a text"};
  target = value.get<std::string>();
}
void from_json_value(const json& value, bool& target) {
  if (!value.is_boolean()) throw WrongType{"true or false"};
  target = value.get<bool>();
}
void from_json_value(const json& value, int& target) {
  if (!value.is_number_integer()) throw WrongType{"a whole number"};
  const auto number = value.get<std::int64_t>();
  if (number < 0 || number > std::numeric_limits<int>::max()) throw WrongType{"a number from 0 on"};
  target = static_cast<int>(number);
}
void from_json_value(const json& value, std::uint64_t& target) {
  const bool fits =
      value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
  if (!fits) throw WrongType{"a whole number from 0 on"};
  target = value.get<std::uint64_t>();
}
void from_json_value(const json& value, double& target) { target = require_number(value); }
void from_json_value(const json& value, std::optional<double>& target) {
  target = value.is_null() ? std::nullopt : std::optional(require_number(value));
}
void from_json_value(const json& value, std::vector<std::string>& target) {
  target.clear();
  const auto add = [&](const json& item) {
    if (!item.is_string() && !item.is_number()) throw WrongType{"a list of names or numbers"};
    target.push_back(item.is_string() ? item.get<std::string>() : item.dump());
  };
  if (!value.is_array()) return add(value);
  for (const json& item : value) add(item);
}
void from_json_value(const json& value, std::vector<double>& target) {
  target.clear();
  if (!value.is_array()) return target.push_back(require_number(value));
  for (const json& item : value) target.push_back(require_number(item));
}
void from_json_value(const json& value, std::vector<Vec3>& target) {
  const WrongType wrong{"a list of directions [x, y, z]"};
  if (!value.is_array()) throw wrong;
  target.clear();
  for (const json& item : value) {
    if (!item.is_array() || item.size() != 3) throw wrong;
    target.emplace_back(require_number(item[0]), require_number(item[1]), require_number(item[2]));
  }
}
void from_json_value(const json& value, std::vector<Mask>& target) {
  if (!value.is_array()) throw WrongType{"tables, written [[mask]] in TOML"};
  target.clear();
  try {
    for (const json& table : value) target.push_back(mask_from_json(table));
  } catch (const WrongMask& wrong) {
    throw WrongType{wrong.what()};
  }
}
template <class Enum>
requires std::is_enum_v<Enum>
void from_json_value(const json& value, Enum& target) {
  std::string expected = "one of";
  for (const Enum choice : Choices<Enum>::values) {
    if (value.is_string() && value.get<std::string>() == name(choice)) {
      target = choice;
      return;
    }
    expected += fmt::format(" {}", name(choice));
  }
  throw WrongType{expected};
}

template <class Enum>
requires std::is_enum_v<Enum>
void from_json_value(const json& value, std::optional<Enum>& target) {
  if (value.is_null()) return target.reset();
  from_json_value(value, target.emplace());
}

/// For a message: short whatever it is.
std::string shown(const json& value) {
  constexpr std::size_t longest = 60;
  if (value.is_array()) return "a list";
  if (value.is_object()) return "a table";
  std::string text = value.dump();
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // whole UTF-8 signs only
  return text.substr(0, end) + "...";
}

/// Reads options from the keys of one table and remembers which keys there are.
class TableReader {
 public:
  TableReader(const json& table, const std::string& place) : table_(&table), place_(place) {
    if (!table.is_object())
      throw InputError(fmt::format("{}: not a job: expected a table of options", place));
  }

  template <class Member>
  void operator()(const OptionText& text, Member& member) {
    const std::string key(text.name);
    known_.insert(key);
    const auto found = table_->find(key);
    if (found == table_->end()) return;
    try {
      from_json_value(*found, member);
    } catch (const WrongType& wrong) {
      throw InputError(
          fmt::format("{}: {} = {}; must be {}", place_, key, shown(*found), wrong.expected));
    }
  }

  void allow(const std::string& key) { known_.insert(key); }

  void refuse_unknown_keys() const {
    for (const auto& [key, value] : table_->items())
      if (!known_.contains(key))
        throw InputError(
            fmt::format("{}: unknown key {}; `roughmesh roughen --help` lists the options, "
                        "written with _ for -",
                        place_, key));
  }

 private:
  const json* table_;
  std::string place_;
  std::set<std::string> known_;
};

const char* const surfaces_key = "surface";

/// One for each table of the list, on top of what stands above them.
std::vector<Roughness> surfaces_from_json(const json& list, const Roughness& above,
                                          const std::string& source) {
  if (!list.is_array() || list.empty())
    throw InputError(
        fmt::format("{}: surface; must be tables, written [[surface]] in TOML", source));
  std::vector<Roughness> surfaces;
  for (const json& table : list) {
    surfaces.push_back(above);
    TableReader reader(table, fmt::format("{}: surface {}", source, surfaces.size()));
    for_each_surface_option(surfaces.back(), reader);
    reader.refuse_unknown_keys();
  }
  return surfaces;
}

template <class Object>
auto writer_to(Object& object) {
  return [&object](const OptionText& text, const auto& member) {
    object[std::string(text.name)] = to_json_value(member);
  };
}

}  // namespace

ordered_json options_to_json(const RoughenOptions& options) {
  ordered_json object;
  for_each_run_option(options, writer_to(object));
  if (options.surfaces.size() == 1) {
    for_each_surface_option(options.surfaces.front(), writer_to(object));
    return object;
  }
  object[surfaces_key] = ordered_json::array();
  for (const Roughness& roughness : options.surfaces)
    for_each_surface_option(roughness, writer_to(object[surfaces_key].emplace_back()));
  return object;
}

RoughenOptions options_from_json(const json& object, const std::string& source) {
  RoughenOptions options;
  TableReader reader(object, source);
  for_each_run_option(options, reader);
  for_each_surface_option(options.surfaces.front(), reader);
  reader.allow(surfaces_key);
  reader.refuse_unknown_keys();
  if (object.contains(surfaces_key))
    options.surfaces = surfaces_from_json(object[surfaces_key], options.surfaces.front(), source);
  return options;
}

}  // namespace roughmesh::detail
