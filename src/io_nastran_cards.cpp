// SPDX-License-Identifier: BSD-3-Clause
// Entries of Nastran bulk data: lines to fields, and numbers to fields.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "decimals.hpp"
#include "fortran_real.hpp"
#include "io_nastran.hpp"
#include "io_patch.hpp"
#include "text.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t field_width = 8;
constexpr std::size_t first_data_end = 72;  // columns 73 to 80 only mark continuations

bool is_free_line(std::string_view line) { return line.substr(0, 10).find(',') != line.npos; }

std::string expand_tabs(std::string_view line) {
  std::string result;
  for (const char c : line) {
    if (c == '\t')
      result.append(field_width - result.size() % field_width, ' ');
    else
      result += c;
  }
  return result;
}

std::string_view first_field(std::string_view line) {
  if (is_free_line(line)) return trimmed(line.substr(0, line.find(',')));
  return trimmed(line.substr(0, std::min(line.find('\t'), field_width)));
}

bool is_continuation(std::string_view line) {
  const std::string_view first = first_field(line);
  return first.empty() || first.front() == '+' || first.front() == '*';
}

void add_free_fields(BulkCard& card, std::string_view line, std::size_t n) {
  std::size_t k = 0;
  line.remove_prefix(line.find(',') + 1);
  for (bool more = true; more && k < n; ++k) {
    const std::size_t comma = std::min(line.find(','), line.size());
    card.fields.push_back(trimmed(line.substr(0, comma)));
    more = comma < line.size();
    line.remove_prefix(more ? comma + 1 : comma);
  }
  for (; k < n; ++k) card.fields.emplace_back();
}

void add_fixed_fields(BulkCard& card, std::string_view line, std::size_t n, std::size_t width) {
  line = line.substr(0, first_data_end);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t column = field_width + k * width;
    card.fields.push_back(column < line.size() ? trimmed(line.substr(column, width))
                                               : std::string_view());
  }
}

// "1.5e-07" and "1.50000" to "1.5-7" and "1.5": a mantissa without zeros at its end, and an
// exponent that its sign alone begins.
std::string compact(const std::string& text) {
  const std::size_t e = std::min(text.find('e'), text.size());
  std::string mantissa = text.substr(0, e);
  if (mantissa.find('.') == mantissa.npos)
    mantissa += '.';
  else
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
  const std::size_t zero = mantissa.find("0.");
  const bool leads = zero == 0 || (zero == 1 && mantissa[0] == '-');
  if (leads && mantissa.size() > zero + 2) mantissa.erase(zero, 1);
  if (e == text.size()) return mantissa;
  std::string exponent = text.substr(e + 1);
  while (exponent.size() > 2 && exponent[1] == '0') exponent.erase(1, 1);
  return mantissa + exponent;
}

constexpr std::size_t large_width = 16;

template <typename Format>
std::string longest_that_fits(Format format) {
  for (int precision = 17; precision >= 0; --precision)
    if (std::string text = compact(format(precision)); text.size() <= large_width) return text;
  return {};
}

}  // namespace

std::string_view without_comment(std::string_view line) {
  return line.substr(0, std::min(line.find('$'), line.size()));
}

void BulkCard::clear() {
  fields.clear();
  lines.clear();
  is_large.clear();
  expanded.clear();
  has_free = has_fixed = false;
}

void BulkReader::move_to_bulk() {
  const std::size_t start = scanner_.offset();
  while (!scanner_.at_end()) {
    const std::string line = upper(trimmed(scanner_.line().substr(0, 80)));
    if (!line.starts_with("BEGIN")) continue;
    if (line.find("SUPER") != line.npos)
      scanner_.refuse("superelements (BEGIN SUPER) are not handled; save each as a file");
    if (line.find("BULK") != line.npos) return;
  }
  scanner_.move_to(start);
}

void BulkReader::add_line(BulkCard& card, std::string_view line) const {
  card.lines.push_back(line);
  std::string_view text = without_comment(line);
  const bool is_free = is_free_line(text);
  if (!is_free && text.find('\t') != text.npos)
    text = card.expanded.emplace_back(expand_tabs(text));
  (is_free ? card.has_free : card.has_fixed) = true;
  const std::string_view first = first_field(text);
  const bool is_first = card.lines.size() == 1;
  const bool is_large = is_first ? first.ends_with('*') : first.starts_with('*');
  if (is_first) {
    card.name = upper(first.substr(0, first.size() - (is_large ? 1 : 0)));
    card.fields.push_back(first);
  }
  card.is_large.push_back(is_large);
  if (is_free)
    add_free_fields(card, text, is_large ? 4 : 8);
  else
    add_fixed_fields(card, text, is_large ? 4 : 8, is_large ? large_width : field_width);
}

bool BulkReader::next(BulkCard& card) {
  card.clear();
  comments_.clear();
  while (!scanner_.at_end()) {
    const std::size_t start = scanner_.offset();
    const std::string_view line = scanner_.line();
    if (line.starts_with('$') && card.lines.empty()) comments_.push_back(line);
    if (trimmed(without_comment(line)).empty()) continue;
    const bool continues = is_continuation(without_comment(line));
    if (card.lines.empty() && continues) continue;  // of an entry that stands elsewhere
    if (!card.lines.empty() && !continues) {
      scanner_.move_to(start);
      return true;
    }
    if (card.lines.empty() && upper(first_field(line)) == "ENDDATA") return false;
    add_line(card, line);
  }
  return !card.lines.empty();
}

std::string nastran_real(double value) {
  std::string text = shortest(value);
  if (text.find('.') == text.npos) text.insert(std::min(text.find('e'), text.size()), 1, '.');
  return text;
}

std::string nastran_real_16(double value) {
  if (std::string exact = compact(shortest(value)); exact.size() <= large_width) return exact;
  std::string best = longest_that_fits(
      [value](int precision) { return fmt::format("{:.{}e}", value, precision); });
  if (std::abs(value) >= 1e15) return best;
  const std::string fixed = longest_that_fits(
      [value](int precision) { return fmt::format("{:.{}f}", value, precision); });
  const auto error = [value](const std::string& text) {
    return std::abs(fortran_real(text).value_or(0) - value);
  };
  return !fixed.empty() && error(fixed) <= error(best) ? fixed : best;
}

double spacing_16(double value) {
  if (value == 0) return 0;
  const int sign = value < 0 ? 1 : 0;
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int exponent_width = 1 + static_cast<int>(std::to_string(std::abs(exponent)).size());
  const double with_exponent = std::pow(10.0, exponent - (14 - sign - exponent_width));
  if (exponent > 14 - sign) return with_exponent;
  const int decimals = exponent >= 0 ? 14 - sign - exponent : 15 - sign;
  return std::min(with_exponent, std::pow(10.0, -decimals));
}

}  // namespace roughmesh::detail
