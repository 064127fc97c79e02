// SPDX-License-Identifier: BSD-3-Clause
// Legacy VTK: types of numbers, and lists of them.
#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "io_vtk.hpp"

namespace roughmesh::detail {

const VtkType* vtk_type(std::string_view name) {
  static constexpr std::array types = {VtkType{"float", 4, false},
                                       VtkType{"double", 8, false},
                                       VtkType{"int", 4, true},
                                       VtkType{"unsigned_int", 4, true},
                                       VtkType{"long", 8, true},
                                       VtkType{"unsigned_long", 8, true},
                                       VtkType{"vtkIdType", 4, true},
                                       VtkType{"vtktypeint64", 8, true},
                                       VtkType{"vtktypeuint64", 8, true},
                                       VtkType{"short", 2, true},
                                       VtkType{"unsigned_short", 2, true},
                                       VtkType{"char", 1, true},
                                       VtkType{"signed_char", 1, true},
                                       VtkType{"unsigned_char", 1, true},
                                       VtkType{"bit", 0, true}};
  const auto found = std::find_if(types.begin(), types.end(), [&](const VtkType& type) {
    return equal_ignoring_case(type.name, name);
  });
  return found == types.end() ? nullptr : &*found;
}

std::size_t VtkReader::n_cells() const {
  std::size_t n = 0;
  for (const auto& [name, array] : cells) n += array.size();
  return n;
}

const VtkType& VtkReader::read_type() {
  scanner.skip_space();
  const std::size_t start = scanner.offset();
  const std::string_view name = scanner.text_token();
  const VtkType* const type = vtk_type(name);
  if (type == nullptr && equal_ignoring_case(name, "string"))
    scanner.refuse("arrays of strings are not read; save the file without them");
  if (type == nullptr)
    scanner.fail_at(start, fmt::format("{} is no type of numbers: the file is damaged or cut short",
                                       quoted(name)));
  return *type;
}

Tag VtkReader::product(Tag a, Tag b) const {
  if (a < 0 || b < 0) scanner.fail("a count is negative: the file is damaged");
  if (a != 0 && b > std::numeric_limits<Tag>::max() / a)
    scanner.fail(fmt::format("{} times {} numbers do not fit into any file", a, b));
  return a * b;
}

std::size_t VtkReader::start_numbers(const VtkType& type, Tag n) {
  if (!is_text()) scanner.line();
  const bool is_bits = type.n_bytes == 0;
  return scanner.count(n, is_text() ? 2 : is_bits ? 1 : type.n_bytes, "numbers");
}

std::vector<Tag> VtkReader::read_integers(const VtkType& type, Tag n) {
  const std::size_t size = start_numbers(type, n);
  std::vector<Tag> values;
  values.reserve(size);
  const auto next = [&]() -> Tag {
    if (is_text()) return scanner.text_integer();
    if (type.n_bytes == 8) return scanner.bytes<std::int64_t>();
    if (type.n_bytes == 4)
      return type.name.starts_with('u') ? Tag{scanner.bytes<std::uint32_t>()}
                                        : Tag{scanner.bytes<std::int32_t>()};
    if (type.n_bytes == 2)
      return type.name.starts_with('u') ? Tag{scanner.bytes<std::uint16_t>()}
                                        : Tag{scanner.bytes<std::int16_t>()};
    return type.name.starts_with('u') ? Tag{scanner.bytes<std::uint8_t>()}
                                      : Tag{scanner.bytes<std::int8_t>()};
  };
  for (std::size_t i = 0; i < size; ++i) values.push_back(next());
  return values;
}

void VtkReader::skip_numbers(const VtkType& type, Tag n) {
  if (!is_text() && type.n_bytes == 0) {  // eight bits in a byte
    scanner.line();
    return scanner.skip(scanner.count(n / 8 + (n % 8 != 0), 1, "bytes of bits"));
  }
  const std::size_t size = start_numbers(type, n);
  if (!is_text()) return scanner.skip(size * type.n_bytes);
  for (std::size_t i = 0; i < size; ++i) scanner.skip_number(0);
}

}  // namespace roughmesh::detail
