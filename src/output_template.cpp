// SPDX-License-Identifier: BSD-3-Clause
#include "output_template.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "roughmesh/options.hpp"

namespace roughmesh {
namespace {

/// A {realization} or {realization:0N} found in a template.
struct Placeholder {
  std::size_t begin = std::string::npos, end = 0;
  std::size_t width = 0;
};

Placeholder find_placeholder(const std::string& text, std::size_t from) {
  static const std::string opening = "{realization";
  for (std::size_t at = text.find(opening, from); at != std::string::npos;
       at = text.find(opening, at + 1)) {
    std::size_t end = at + opening.size();
    std::size_t width = 0;
    if (text.compare(end, 2, ":0") == 0) {
      for (end += 2; end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]));
           ++end)
        width = std::min<std::size_t>(width * 10 + static_cast<std::size_t>(text[end] - '0'), 20);
    }
    if (end < text.size() && text[end] == '}') return {at, end + 1, width};
  }
  return {};
}

template <class Replace>
std::string replace_placeholders(const std::string& text, Replace&& replacement) {
  std::string result;
  std::size_t from = 0;
  for (Placeholder found = find_placeholder(text, 0); found.begin != std::string::npos;
       found = find_placeholder(text, from)) {
    result += text.substr(from, found.begin - from) + replacement(found.width);
    from = found.end;
  }
  return result + text.substr(from);
}

}  // namespace

std::size_t detail::placeholder_begin(const std::string& text) {
  return find_placeholder(text, 0).begin;
}

std::string detail::without_placeholders(const std::string& text) {
  return replace_placeholders(text, [](std::size_t) { return std::string(); });
}

std::string output_path(const std::string& output, std::uint64_t realization) {
  return replace_placeholders(
      output, [&](std::size_t width) { return fmt::format("{:0{}}", realization, width); });
}

std::string report_path(const RoughenOptions& options) {
  if (!options.report.empty()) return options.report;
  const std::filesystem::path output = options.output;
  // A folder of its own for each realization is no place for what they have in common.
  std::filesystem::path folder = output.parent_path();
  while (detail::placeholder_begin(folder.string()) != std::string::npos)
    folder = folder.parent_path();
  const std::filesystem::path file = detail::without_placeholders(output.filename().string());
  return (folder / (file.stem().string() + ".report.json")).string();
}

}  // namespace roughmesh
