// SPDX-License-Identifier: BSD-3-Clause
#include "new_file.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "node_orders.hpp"

namespace roughmesh::detail {
namespace {

bool are_usable(std::vector<Tag> tags, Tag largest) {
  std::sort(tags.begin(), tags.end());
  return !tags.empty() && tags.front() >= 1 && tags.back() <= largest &&
         std::adjacent_find(tags.begin(), tags.end()) == tags.end();
}

}  // namespace

NewNumbers new_numbers(const Mesh& mesh, Tag largest) {
  NewNumbers numbers{mesh.node_tags, {}};
  if (!are_usable(mesh.node_tags, largest))
    std::iota(numbers.nodes.begin(), numbers.nodes.end(), Tag{1});
  std::vector<Tag> all;
  for (const ElementBlock& block : mesh.blocks) {
    numbers.elements.push_back(block.tags);
    all.insert(all.end(), block.tags.begin(), block.tags.end());
  }
  if (are_usable(std::move(all), largest)) return numbers;
  Tag next = 0;
  for (std::vector<Tag>& tags : numbers.elements)
    for (Tag& tag : tags) tag = ++next;
  return numbers;
}

Tag first_group(const ElementBlock& block) {
  return block.physical_groups.empty() ? 0 : block.physical_groups.front();
}

std::string group_name(const PhysicalGroup& group, GroupNames names) {
  if (group.name.empty())
    return names == GroupNames::of_dimension
               ? fmt::format("group_{}", group.tag)
               : fmt::format("GROUP_{}_{}", group.dimension, group.tag);
  std::string text = group.name;
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  return text;
}

std::string group_name(const Mesh& mesh, int dimension, Tag tag) {
  const auto group = std::find_if(
      mesh.groups.begin(), mesh.groups.end(),
      [&](const PhysicalGroup& each) { return each.dimension == dimension && each.tag == tag; });
  return group_name(group != mesh.groups.end() ? *group : PhysicalGroup{dimension, tag, ""},
                    GroupNames::of_dimension);
}

bool is_plane(const Mesh& mesh) {
  return dimension(mesh) == 2 &&
         std::all_of(mesh.nodes.begin(), mesh.nodes.end(), [](const Vec3& x) { return x[2] == 0; });
}

std::map<std::pair<int, Tag>, std::vector<std::size_t>> blocks_of_groups(const Mesh& mesh) {
  std::map<std::pair<int, Tag>, std::vector<std::size_t>> result;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (const Tag group : mesh.blocks[b].physical_groups)
      result[{dimension(mesh.blocks[b].type.shape), group}].push_back(b);
  return result;
}

void check_serendipity(const Mesh& mesh, const std::filesystem::path& path, bool pyramids) {
  bool has_elements = false;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.size() == 0) continue;
    const bool is_missing = block.type.shape == ElementShape::pyramid && !pyramids;
    if (!is_serendipity(block.type) || is_missing)
      throw InputError(
          fmt::format("{}: a {} with {} nodes cannot be written to this format; write "
                      ".msh",
                      path.string(), name(block.type), block.type.n_nodes));
    has_elements |= block.type.shape != ElementShape::point;
  }
  if (!has_elements)
    throw InputError(
        fmt::format("{}: a mesh of points only cannot be written to this format; "
                    "write .msh",
                    path.string()));
}

}  // namespace roughmesh::detail
