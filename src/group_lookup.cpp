// SPDX-License-Identifier: BSD-3-Clause
#include "group_lookup.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace roughmesh::detail {
namespace {

constexpr std::size_t most_listed = 10;

std::optional<Tag> number(const std::string& text) {
  Tag value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const bool digits_only = !text.empty() && text.front() != '-' && stop == end;
  return digits_only && error == std::errc{} ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<PhysicalGroup> find_group(const Mesh& mesh, const std::string& text,
                                        int preferred_dimension) {
  const auto best = [&](auto&& matches) -> std::optional<PhysicalGroup> {
    std::optional<PhysicalGroup> found;
    for (const PhysicalGroup& group : mesh.groups)
      if (matches(group) && (!found || (group.dimension == preferred_dimension &&
                                        found->dimension != preferred_dimension)))
        found = group;
    return found;
  };
  auto named = best([&](const PhysicalGroup& g) { return g.name == text; });
  if (named || !number(text)) return named;
  return best([tag = *number(text)](const PhysicalGroup& g) { return g.tag == tag; });
}

bool is_in_group(const ElementBlock& block, const PhysicalGroup& group) {
  const std::vector<Tag>& groups = block.physical_groups;
  return block.size() > 0 && dimension(block.type.shape) == group.dimension &&
         std::find(groups.begin(), groups.end(), group.tag) != groups.end();
}

bool has_elements(const Mesh& mesh, const PhysicalGroup& group) {
  return std::any_of(mesh.blocks.begin(), mesh.blocks.end(),
                     [&](const ElementBlock& block) { return is_in_group(block, group); });
}

std::string label(const PhysicalGroup& group) {
  if (group.name.empty()) return std::to_string(group.tag);
  return fmt::format("{} ({})", group.name, group.tag);
}

std::string list_of_labels(std::span<const PhysicalGroup> groups) {
  std::string list;
  for (std::size_t i = 0; i < std::min(groups.size(), most_listed); ++i)
    list += (i > 0 ? ", " : "") + label(groups[i]);
  if (groups.size() > most_listed) list += fmt::format(" and {} more", groups.size() - most_listed);
  return list;
}

}  // namespace roughmesh::detail
