// SPDX-License-Identifier: BSD-3-Clause
// XXH3 (64 bits) of bytes: the same number on every machine.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace roughmesh::detail {

std::uint64_t hash(std::string_view bytes);

/// Of the bytes of an array, which depend on the machine's byte order.
template <typename T, std::size_t extent>
std::uint64_t hash(std::span<T, extent> values) {
  static_assert(std::is_arithmetic_v<T>, "padding would count");
  return hash({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

}  // namespace roughmesh::detail
