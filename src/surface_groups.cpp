// SPDX-License-Identifier: BSD-3-Clause
// The elements that a list of physical groups means.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "group_lookup.hpp"
#include "messages.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"

namespace roughmesh::detail {
namespace {

constexpr int surface_dimension = 2;

bool is_surface(const ElementBlock& block) {
  return block.size() > 0 && dimension(block.type.shape) == surface_dimension;
}

bool contains(std::span<const Tag> tags, Tag tag) {
  return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

std::vector<PhysicalGroup> surface_groups(const Mesh& mesh) {
  std::vector<PhysicalGroup> groups;
  for (const PhysicalGroup& group : mesh.groups)
    if (group.dimension == surface_dimension && has_elements(mesh, group)) groups.push_back(group);
  return groups;
}

std::string list_of_choices(const Mesh& mesh) {
  const std::vector<PhysicalGroup> groups = surface_groups(mesh);
  if (groups.empty()) return "the mesh has no surface group; leave the group out or use all";
  return "surface groups: " + list_of_labels(groups);
}

PhysicalGroup require_group(const Mesh& mesh, const std::string& text) {
  const auto group = text.empty() ? std::nullopt : find_group(mesh, text, surface_dimension);
  if (!group)
    throw InputError(
        fmt::format("there is no physical group '{}'; {}", text, list_of_choices(mesh)));
  if (group->dimension != surface_dimension)
    throw InputError(fmt::format("physical group '{}' has dimension {}, not 2; {}", text,
                                 group->dimension, list_of_choices(mesh)));
  if (!has_elements(mesh, *group))
    throw InputError(
        fmt::format("physical group '{}' has no element; {}", text, list_of_choices(mesh)));
  return *group;
}

// What a choice of groups comes to.
struct Choice {
  enum class Kind { groups, all_elements, boundary } kind = Kind::groups;
  std::vector<Tag> tags;  // of Kind::groups
  std::vector<std::string> names;

  void add(const PhysicalGroup& group) {
    if (contains(tags, group.tag)) return;
    tags.push_back(group.tag);
    names.push_back(group.name.empty() ? std::to_string(group.tag) : group.name);
  }
};

Choice everything(const Mesh& mesh) {
  if (n_elements(mesh, surface_dimension) > 0) return {Choice::Kind::all_elements, {}, {"all"}};
  return {Choice::Kind::boundary, {}, {"boundary"}};
}

Choice default_choice(const Mesh& mesh) {
  const std::vector<PhysicalGroup> groups = surface_groups(mesh);
  if (groups.size() > 1)
    throw InputError("several groups could become rough, choose among them; " +
                     list_of_choices(mesh));
  if (groups.empty() && dimension(mesh) == 3) return {Choice::Kind::boundary, {}, {"boundary"}};
  if (groups.empty()) return everything(mesh);
  Choice choice;
  choice.add(groups.front());
  return choice;
}

Choice make_choice(const Mesh& mesh, std::span<const std::string> texts) {
  if (texts.empty()) return default_choice(mesh);
  Choice choice;
  for (const std::string& text : texts) {
    const auto group = find_group(mesh, text, surface_dimension);
    if (text == "all" && (!group || group->dimension != surface_dimension)) return everything(mesh);
    choice.add(require_group(mesh, text));
  }
  return choice;
}

bool is_chosen(const ElementBlock& block, const Choice& choice) {
  if (!is_surface(block)) return false;
  return choice.kind == Choice::Kind::all_elements ||
         std::any_of(choice.tags.begin(), choice.tags.end(),
                     [&](Tag tag) { return contains(block.physical_groups, tag); });
}

Faces elements_of(const Mesh& mesh, const Choice& choice) {
  Faces faces;
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_chosen(block, choice)) continue;
    require_first_order(block.type, block.tags.front());
    for (Index e = 0; e < block.size(); ++e)
      faces.add(block.element(e), block.tags[e], faces.size());
  }
  return faces;
}

Faces boundary_of(const Mesh& mesh) {
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0 && dimension(block.type.shape) == 3)
      require_first_order(block.type, block.tags.front());
  Faces faces;
  for (const VolumeFace& face : boundary_faces(mesh)) faces.add(face.corners(), 0, faces.size());
  return faces;
}

}  // namespace

ChosenFaces choose_faces(const Mesh& mesh, std::span<const std::string> groups) {
  if (dimension(mesh) < surface_dimension)
    throw InputError(
        "the mesh has neither surface nor volume elements; give a mesh of dimension 2 or 3");
  Choice choice = make_choice(mesh, groups);
  Faces faces =
      choice.kind == Choice::Kind::boundary ? boundary_of(mesh) : elements_of(mesh, choice);
  if (faces.size() == 0)
    throw InputError("the volume has no boundary; choose a physical group of dimension 2");
  return {std::move(faces), std::move(choice.names)};
}

}  // namespace roughmesh::detail
