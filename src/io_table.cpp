// SPDX-License-Identifier: BSD-3-Clause
// Text files of pairs (r, rho).
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "roughmesh/autocorrelation.hpp"

#include "autocorrelation_table.hpp"
#include "mesh_source.hpp"
#include "scanner.hpp"

namespace roughmesh {
namespace {

bool is_separator(char c) { return detail::is_space(c) || c == ',' || c == ';'; }

/// The next word of a line, without the separators around it; empty at its end.
std::string_view take_word(std::string_view& line) {
  while (!line.empty() && is_separator(line.front())) line.remove_prefix(1);
  std::size_t length = 0;
  while (length < line.size() && !is_separator(line[length])) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

double take_number(const detail::Scanner& scanner, std::size_t start, std::string_view& line) {
  std::string_view word = take_word(line);
  if (word.empty()) scanner.fail_at(start, "two numbers are needed, r and rho");
  const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    scanner.fail_at(start, fmt::format("{} is not a number", detail::quoted(word)));
  return value;
}

}  // namespace

std::vector<CorrelationPair> read_correlation_table(const std::filesystem::path& path) {
  const detail::FileBytes file = detail::read_file(path);
  detail::Scanner scanner(file);
  scanner.set_section("table of r and rho");
  // Spreadsheets mark their UTF-8 files so.
  if (constexpr std::string_view mark = "\xef\xbb\xbf"; scanner.rest().starts_with(mark))
    scanner.skip(mark.size());
  std::vector<CorrelationPair> pairs;
  while (!scanner.at_end()) {
    const std::size_t start = scanner.offset();
    std::string_view line = scanner.line();
    std::string_view rest = line;
    const std::string_view first = take_word(rest);
    if (first.empty() || first.front() == '#') continue;
    const double r = take_number(scanner, start, line);
    pairs.push_back({r, take_number(scanner, start, line)});
    if (const std::string_view more = take_word(line); !more.empty() && more.front() != '#')
      scanner.fail_at(
          start, fmt::format("{} after two numbers; give r and rho alone", detail::quoted(more)));
    const std::string flaw = detail::flaw_of_pair(pairs, pairs.size() - 1);
    if (!flaw.empty()) scanner.fail_at(start, flaw);
  }
  if (pairs.size() < 3)
    scanner.fail(fmt::format("{} pairs of r and rho; at least 3 are needed", pairs.size()));
  return pairs;
}

}  // namespace roughmesh
