// SPDX-License-Identifier: BSD-3-Clause
// Numbers in job files and reports. JSON has no infinity; "inf" and "-inf" stand for it.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

namespace roughmesh::detail {

inline nlohmann::ordered_json number_to_json(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

/// Nothing for what is no number.
inline std::optional<double> number_from_json(const nlohmann::json& value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (value.is_string() && value == "inf") return infinity;
  if (value.is_string() && value == "-inf") return -infinity;
  if (!value.is_number()) return std::nullopt;
  return value.get<double>();
}

}  // namespace roughmesh::detail
