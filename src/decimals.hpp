// SPDX-License-Identifier: BSD-3-Clause
// Numbers as text: the fewest decimals that read back exactly.
#pragma once

#include <charconv>
#include <string>

namespace roughmesh::detail {

inline constexpr std::size_t most_decimals = 31;  ///< characters of a double or whole number

/// @param to  room for most_decimals  @returns the end
template <typename T>
char* write_decimals(T value, char* to) {
  return std::to_chars(to, to + most_decimals, value).ptr;
}

inline std::string shortest(double value) {
  char text[most_decimals];
  return {text, write_decimals(value, text)};
}

}  // namespace roughmesh::detail
