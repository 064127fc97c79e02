// SPDX-License-Identifier: BSD-3-Clause
#include "fortran_real.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace roughmesh::detail {
namespace {

constexpr std::size_t longest = 120;  // characters of a number

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_exponent_letter(char c) { return c == 'e' || c == 'E' || c == 'd' || c == 'D'; }

// The number with its exponent behind an "e", as std::from_chars reads it.
struct Plain {
  std::array<char, longest + 1> text;  // at most one "e" is added
  std::size_t size = 0;
  bool is_small = false;  // its exponent is negative

  void add(char c) { text[size++] = c; }
};

// Nothing where a sign follows that of the exponent.
std::optional<Plain> plain(std::string_view text) {
  Plain result;
  bool has_exponent_sign = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_sign = c == '+' || c == '-';
    if (is_sign && i > 0) {
      if (has_exponent_sign) return {};
      has_exponent_sign = true;
      result.is_small = c == '-';
      if (!is_exponent_letter(text[i - 1])) result.add('e');
    }
    if (c == '+') continue;
    result.add(is_exponent_letter(c) ? 'e' : c);
  }
  return result;
}

}  // namespace

std::optional<double> fortran_real(std::string_view text) {
  if (text.empty() || text.size() > longest) return {};
  // What std::from_chars knows besides digits are words such as "nan".
  const std::size_t digits = text.front() == '+' || text.front() == '-' ? 1 : 0;
  if (digits == text.size() || !(is_digit(text[digits]) || text[digits] == '.')) return {};
  const std::optional<Plain> number = plain(text);
  if (!number) return {};
  double value = 0;
  const char* const end = number->text.data() + number->size;
  const auto [stop, error] = std::from_chars(number->text.data(), end, value);
  if (stop != end) return {};
  if (error == std::errc::result_out_of_range && number->is_small) return 0.0;
  if (error != std::errc() || !std::isfinite(value)) return {};
  return value;
}

std::optional<Tag> whole_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Tag value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return {};
  return value;
}

}  // namespace roughmesh::detail
