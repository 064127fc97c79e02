// SPDX-License-Identifier: BSD-3-Clause
#include "mask_json.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "json_numbers.hpp"

namespace roughmesh::detail {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json vector_to_json(const Vec3& v) {
  return {number_to_json(v.x()), number_to_json(v.y()), number_to_json(v.z())};
}

// Reads the keys of one table, each at most once, and knows which are left over.
class MaskTable {
 public:
  explicit MaskTable(const json& table) : table_(&table) {
    if (!table.is_object()) throw WrongMask("a table with the key kind");
  }

  std::string text(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr || !value->is_string())
      throw WrongMask(fmt::format("a table with the text {}", key));
    return value->get<std::string>();
  }

  double number(const std::string& key, const double* otherwise = nullptr) {
    const json* value = find(key);
    if (value == nullptr && otherwise != nullptr) return *otherwise;
    return value == nullptr ? missing(key) : finite_or_infinite(*value, key);
  }

  Vec3 vector(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr || !value->is_array() || value->size() != 3)
      throw WrongMask(fmt::format("a table with three numbers {}", key));
    return {finite_or_infinite((*value)[0], key), finite_or_infinite((*value)[1], key),
            finite_or_infinite((*value)[2], key)};
  }

  bool truth(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr) return false;
    if (!value->is_boolean()) throw WrongMask(fmt::format("a table with {} true or false", key));
    return value->get<bool>();
  }

  void refuse_other_keys() const {
    for (const auto& [key, value] : table_->items())
      if (!known_.contains(key)) throw WrongMask(fmt::format("a mask without the key {}", key));
  }

 private:
  const json* find(const std::string& key) {
    known_.insert(key);
    const auto at = table_->find(key);
    return at == table_->end() ? nullptr : &*at;
  }
  [[noreturn]] static double missing(const std::string& key) {
    throw WrongMask(fmt::format("a table with the number {}", key));
  }
  static double finite_or_infinite(const json& value, const std::string& key) {
    const std::optional<double> number = number_from_json(value);
    return number ? *number : missing(key);
  }

  const json* table_;
  std::set<std::string> known_;
};

constexpr double no_fade = 0;

BoxMask box(MaskTable& table) {
  return {.min = table.vector("min"),
          .max = table.vector("max"),
          .fade = table.number("fade", &no_fade),
          .outside = table.truth("outside")};
}

SphereMask sphere(MaskTable& table) {
  return {.centre = table.vector("centre"),
          .radius = table.number("radius"),
          .fade = table.number("fade", &no_fade),
          .outside = table.truth("outside")};
}

Mask mask_of_kind(const std::string& kind, MaskTable& table) {
  if (kind == "box") return box(table);
  if (kind == "sphere") return sphere(table);
  if (kind == "formula") return FormulaMask{table.text("expression")};
  throw WrongMask("a table with kind box, sphere or formula");
}

struct ToJson {
  ordered_json operator()(const BoxMask& mask) const {
    return {{"kind", "box"},
            {"min", vector_to_json(mask.min)},
            {"max", vector_to_json(mask.max)},
            {"fade", number_to_json(mask.fade)},
            {"outside", mask.outside}};
  }
  ordered_json operator()(const SphereMask& mask) const {
    return {{"kind", "sphere"},
            {"centre", vector_to_json(mask.centre)},
            {"radius", number_to_json(mask.radius)},
            {"fade", number_to_json(mask.fade)},
            {"outside", mask.outside}};
  }
  ordered_json operator()(const FormulaMask& mask) const {
    return {{"kind", "formula"}, {"expression", mask.expression}};
  }
};

}  // namespace

ordered_json mask_to_json(const Mask& mask) { return std::visit(ToJson{}, mask); }

Mask mask_from_json(const json& table) {
  MaskTable keys(table);
  Mask mask = mask_of_kind(keys.text("kind"), keys);
  keys.refuse_other_keys();
  return mask;
}

}  // namespace roughmesh::detail
