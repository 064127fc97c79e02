// SPDX-License-Identifier: BSD-3-Clause
// The elements that a list of physical groups means.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "group_lookup.hpp"
#include "messages.hpp"
#include "plane.hpp"
#include "surface_faces.hpp"
#include "volume_faces.hpp"
#include "wall_faces.hpp"

namespace roughmesh::detail {
namespace {

constexpr int faces_dimension = 2;
constexpr int lines_dimension = 1;

// What can become rough in a mesh.
struct Candidates {
  const Mesh& mesh;
  PlaneFit plane;
  int dimension = faces_dimension;  // of the elements meant unless another group is chosen

  bool are_lines() const { return dimension == lines_dimension; }
};

// The one decision between faces and lines: a planar mesh with line elements has a boundary or
// interfaces to roughen within its plane, everything else becomes rough by its faces.
Candidates find_candidates(const Mesh& mesh) {
  const int largest = dimension(mesh);
  if (largest < lines_dimension)
    throw InputError(
        "the mesh has no elements beside points; give a mesh of lines, faces or "
        "volumes");
  if (largest > faces_dimension) return {mesh, {}, faces_dimension};
  Candidates candidates{mesh, fit_plane(mesh), faces_dimension};
  if (candidates.plane.is_planar() && n_elements(mesh, lines_dimension) > 0)
    candidates.dimension = lines_dimension;
  return candidates;
}

// Why lines of this mesh cannot become rough.
std::string reason_against_lines(const Candidates& candidates) {
  const Mesh& mesh = candidates.mesh;
  if (dimension(mesh) > faces_dimension)
    return "lines become rough in planar meshes only, and this one has volumes";
  const Index node = candidates.plane.farthest_node;
  return fmt::format(
      "lines become rough in planar meshes only, and node {} of this one is {:.3g} out of the "
      "plane "
      "of the others",
      mesh.node_tags[node], candidates.plane.distance);
}

bool contains(std::span<const Tag> tags, Tag tag) {
  return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

std::vector<PhysicalGroup> groups_of(const Mesh& mesh, int dimension) {
  std::vector<PhysicalGroup> groups;
  for (const PhysicalGroup& group : mesh.groups)
    if (group.dimension == dimension && has_elements(mesh, group)) groups.push_back(group);
  return groups;
}

std::string list_of_choices(const Candidates& candidates) {
  const std::vector<PhysicalGroup> faces = groups_of(candidates.mesh, faces_dimension);
  if (!candidates.are_lines()) {
    if (faces.empty()) return "the mesh has no surface group; leave the group out or use all";
    return "surface groups: " + list_of_labels(faces);
  }
  const std::vector<PhysicalGroup> lines = groups_of(candidates.mesh, lines_dimension);
  std::string list = lines.empty() ? "the mesh has no group of lines; use all for every line"
                                   : "groups of lines: " + list_of_labels(lines);
  if (!faces.empty())
    list += "; surface groups, which move out of the plane: " + list_of_labels(faces);
  return list;
}

[[noreturn]] void refuse_dimension(const Candidates& candidates, const std::string& text,
                                   const PhysicalGroup& group) {
  const std::string reason =
      group.dimension == lines_dimension ? ": " + reason_against_lines(candidates) : "";
  throw InputError(fmt::format("physical group '{}' has dimension {}, not {}{}; {}", text,
                               group.dimension, candidates.dimension, reason,
                               list_of_choices(candidates)));
}

PhysicalGroup require_group(const Candidates& candidates, const std::string& text) {
  const auto group =
      text.empty() ? std::nullopt : find_group(candidates.mesh, text, candidates.dimension);
  if (!group)
    throw InputError(
        fmt::format("there is no physical group '{}'; {}", text, list_of_choices(candidates)));
  // The faces of a planar mesh are a plate, if they are asked for.
  const bool can_be_rough =
      group->dimension == candidates.dimension || group->dimension == faces_dimension;
  if (!can_be_rough) refuse_dimension(candidates, text, *group);
  if (!has_elements(candidates.mesh, *group))
    throw InputError(
        fmt::format("physical group '{}' has no element; {}", text, list_of_choices(candidates)));
  return *group;
}

// What a choice of groups comes to.
struct Choice {
  enum class Kind { groups, all_elements, boundary } kind = Kind::groups;
  int dimension = faces_dimension;
  std::vector<Tag> tags;  // of Kind::groups
  std::vector<std::string> names;

  void add(const PhysicalGroup& group) {
    if (!tags.empty() && group.dimension != dimension)
      throw InputError(fmt::format(
          "physical groups {} and {} have dimensions {} and {}; choose groups of one dimension",
          names.front(), label(group), dimension, group.dimension));
    dimension = group.dimension;
    if (contains(tags, group.tag)) return;
    tags.push_back(group.tag);
    names.push_back(group.name.empty() ? std::to_string(group.tag) : group.name);
  }
};

Choice everything(const Candidates& candidates) {
  const Mesh& mesh = candidates.mesh;
  if (std::any_of(mesh.blocks.begin(), mesh.blocks.end(), [&](const ElementBlock& block) {
        return block.size() > 0 && dimension(block.type.shape) == candidates.dimension &&
               !is_between_partitions(mesh, block);
      }))
    return {Choice::Kind::all_elements, candidates.dimension, {}, {"all"}};
  if (dimension(candidates.mesh) == lines_dimension)
    throw InputError(fmt::format("a mesh of lines only: {}; give a planar one",
                                 reason_against_lines(candidates)));
  return {Choice::Kind::boundary, faces_dimension, {}, {"boundary"}};
}

Choice default_choice(const Candidates& candidates) {
  const std::vector<PhysicalGroup> groups = groups_of(candidates.mesh, candidates.dimension);
  if (groups.size() > 1)
    throw InputError(
        "several groups could become rough; choose with --group, more than once or `all`; " +
        list_of_choices(candidates));
  if (groups.empty()) {
    const int largest = dimension(candidates.mesh);
    if (largest > faces_dimension)
      return {Choice::Kind::boundary, faces_dimension, {}, {"boundary"}};
    if (candidates.are_lines() && largest > lines_dimension)
      throw InputError("lines or faces of this planar mesh could become rough, choose; " +
                       list_of_choices(candidates));
    return everything(candidates);
  }
  Choice choice;
  choice.add(groups.front());
  return choice;
}

Choice make_choice(const Candidates& candidates, std::span<const std::string> texts) {
  if (texts.empty()) return default_choice(candidates);
  Choice choice;
  for (const std::string& text : texts) {
    const auto group = find_group(candidates.mesh, text, candidates.dimension);
    if (text == "all" && (!group || group->dimension != candidates.dimension))
      return everything(candidates);
    choice.add(require_group(candidates, text));
  }
  return choice;
}

bool is_chosen(const Mesh& mesh, const ElementBlock& block, const Choice& choice) {
  if (block.size() == 0 || dimension(block.type.shape) != choice.dimension) return false;
  return (choice.kind == Choice::Kind::all_elements && !is_between_partitions(mesh, block)) ||
         std::any_of(choice.tags.begin(), choice.tags.end(),
                     [&](Tag tag) { return contains(block.physical_groups, tag); });
}

// An element as its linear facets.
void add_element(const ElementType& type, std::span<const Index> nodes, Tag tag, Index order,
                 Faces& faces) {
  for (const std::vector<int>& facet : facets(type)) {
    std::array<Index, 4> corners{};
    for (std::size_t k = 0; k < facet.size(); ++k) corners[k] = nodes[facet[k]];
    faces.add({corners.data(), facet.size()}, tag, order);
  }
}

void reserve(const Mesh& mesh, const Choice& choice, Faces& faces) {
  std::size_t n_faces = 0, n_corners = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_chosen(mesh, block, choice)) continue;
    for (const std::vector<int>& facet : facets(block.type)) {
      n_faces += block.tags.size();
      n_corners += block.tags.size() * facet.size();
    }
  }
  faces.reserve(n_faces, n_corners);
}

void add_elements(const Mesh& mesh, const Choice& choice, Faces& faces) {
  reserve(mesh, choice, faces);
  Index order = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (!is_chosen(mesh, block, choice)) continue;
    require_movable_order(block.type, block.tags.front());
    for (Index e = 0; e < block.size(); ++e)
      add_element(block.type, block.element(e), block.tags[e], order++, faces);
  }
}

void add_boundary(const Mesh& mesh, Faces& faces) {
  constexpr int volume_dimension = 3;
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0 && dimension(block.type.shape) == volume_dimension)
      require_movable_order(block.type, block.tags.front());
  Index order = 0;
  for (const CellFace& face : boundary_faces(mesh, volume_dimension))
    add_element(face.type, face.all(), 0, order++, faces);
}

}  // namespace

ChosenFaces choose_faces(const Mesh& mesh, std::span<const std::string> groups) {
  const Candidates candidates = find_candidates(mesh);
  Choice choice = make_choice(candidates, groups);
  Faces faces;
  faces.dimension = choice.dimension;
  if (choice.dimension == lines_dimension) faces.plane_normal = *candidates.plane.normal;
  if (choice.kind == Choice::Kind::boundary)
    add_boundary(mesh, faces);
  else
    add_elements(mesh, choice, faces);
  if (faces.size() == 0)
    throw InputError("the volume has no boundary; choose a physical group of dimension 2");
  return {std::move(faces), std::move(choice.names)};
}

}  // namespace roughmesh::detail
