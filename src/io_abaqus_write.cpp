// SPDX-License-Identifier: BSD-3-Clause
// Writes Abaqus input from arrays: *NODE, *ELEMENT for each block, *ELSET for each group.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "decimals.hpp"
#include "io_abaqus.hpp"
#include "io_patch.hpp"
#include "new_file.hpp"

namespace roughmesh::detail {
namespace {

constexpr Tag largest_number = 999'999'999;

std::string type_name(const ElementType& type, bool plane) {
  const bool first = type.order == 1;
  switch (type.shape) {
    case ElementShape::line:
      return fmt::format("T{}D{}", plane ? 2 : 3, type.n_nodes);
    case ElementShape::triangle:
      if (plane) return fmt::format("CPS{}", type.n_nodes);
      return first ? "S3" : "STRI65";
    case ElementShape::quadrangle:
      if (plane) return fmt::format("CPS{}", type.n_nodes);
      return first ? "S4" : "S8R";
    default:
      return fmt::format("C3D{}", type.n_nodes);
  }
}

// A name that may hold spaces and signs stands in quotes, which it cannot hold itself.
std::string quoted_name(std::string name) {
  std::erase_if(name, [](char c) { return c == '"'; });
  const bool is_plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
           c == '-';
  });
  return is_plain && !name.empty() ? name : '"' + name + '"';
}

// Groups of one dimension whose names differ in nothing that Abaqus sees get their tags.
std::vector<std::string> set_names(const Mesh& mesh) {
  std::set<std::pair<int, std::string>> taken;
  std::vector<std::string> names;
  for (const PhysicalGroup& group : mesh.groups) {
    const std::string label = group_name(group, GroupNames::of_all_dimensions);
    std::string name = quoted_name(label);
    if (!taken.emplace(group.dimension, upper(name)).second) {
      name = quoted_name(fmt::format("{}_{}", label, group.tag));
      taken.emplace(group.dimension, upper(name));
    }
    names.push_back(std::move(name));
  }
  return names;
}

void write_nodes(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  output.write("*NODE\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& x = mesh.nodes[i];
    output.write(fmt::format("{}, {}, {}, {}\n", numbers.nodes[i], shortest(x[0]), shortest(x[1]),
                             shortest(x[2])));
  }
}

// Numbers with commas between, at most 16 on a line, each line but the last ending in a comma.
void write_list(const std::vector<Tag>& numbers, OutputFile& output) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool is_last = i + 1 == numbers.size();
    const bool ends_line = is_last || i % 16 == 15;
    output.write(fmt::format("{}{}{}", numbers[i], is_last ? "" : ",", ends_line ? "\n" : " "));
  }
}

void write_blocks(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  const bool plane = is_plane(mesh);  // elements are those of plane stress
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    if (block.size() == 0 || block.type.shape == ElementShape::point) continue;
    output.write(fmt::format("*ELEMENT, TYPE={}\n", type_name(block.type, plane)));
    for (Index e = 0; e < block.size(); ++e) {
      std::vector<Tag> line = {numbers.elements[b][static_cast<std::size_t>(e)]};
      for (const int place : abaqus_node_orders().in_gmsh(block.type))
        line.push_back(numbers.nodes[static_cast<std::size_t>(
            block.element(e)[static_cast<std::size_t>(place)])]);
      write_list(line, output);
    }
  }
}

void write_sets(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  const std::vector<std::string> names = set_names(mesh);
  auto blocks = blocks_of_groups(mesh);
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    std::vector<Tag> elements;
    for (const std::size_t b : blocks[{mesh.groups[g].dimension, mesh.groups[g].tag}])
      elements.insert(elements.end(), numbers.elements[b].begin(), numbers.elements[b].end());
    if (elements.empty() || mesh.groups[g].dimension == 0) continue;
    output.write(fmt::format("*ELSET, ELSET={}\n", names[g]));
    write_list(elements, output);
  }
}

}  // namespace

void check_abaqus(const Mesh& mesh, const std::filesystem::path& path) {
  check_serendipity(mesh, path, true);
}

void write_new_abaqus(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  const NewNumbers numbers = new_numbers(mesh, largest_number);
  output.write("*HEADING\nwritten by roughmesh\n");
  write_nodes(mesh, numbers, output);
  write_blocks(mesh, numbers, output);
  write_sets(mesh, numbers, output);
}

}  // namespace roughmesh::detail
