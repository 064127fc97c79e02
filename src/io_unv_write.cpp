// SPDX-License-Identifier: BSD-3-Clause
// Writes universal files from arrays: datasets 2411, 2412 and 2477.
#include <algorithm>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "io_unv.hpp"
#include "new_file.hpp"

namespace roughmesh::detail {
namespace {

constexpr Tag largest_number = std::numeric_limits<std::int32_t>::max();  // ten characters

// Fields of ten characters, eight to a line.
void write_numbers(const std::vector<Tag>& numbers, OutputFile& output) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    text += fmt::format("{:>10}", numbers[i]);
    if (i % 8 == 7 || i + 1 == numbers.size()) text += '\n';
  }
  output.write(text);
}

void write_nodes(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  output.write("    -1\n  2411\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& x = mesh.nodes[i];
    write_numbers({numbers.nodes[i], 1, 1, 11}, output);
    output.write(fmt::format("{:>25}{:>25}{:>25}\n", unv_real(x[0], 'D'), unv_real(x[1], 'D'),
                             unv_real(x[2], 'D')));
  }
  output.write("    -1\n");
}

void write_elements(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  const bool plane = is_plane(mesh);
  output.write("    -1\n  2412\n");
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    if (block.type.shape == ElementShape::point) continue;
    const Tag property = block.entity > 0 && block.entity <= largest_number ? block.entity : 0;
    for (Index e = 0; e < block.size(); ++e) {
      write_numbers({numbers.elements[b][static_cast<std::size_t>(e)],
                     unv_descriptor(block.type, plane), property, 0, 7, block.type.n_nodes},
                    output);
      if (block.type.shape == ElementShape::line) write_numbers({0, 0, 0}, output);
      std::vector<Tag> nodes;
      for (const int place : unv_node_orders().in_gmsh(block.type))
        nodes.push_back(numbers.nodes[static_cast<std::size_t>(
            block.element(e)[static_cast<std::size_t>(place)])]);
      write_numbers(nodes, output);
    }
  }
  output.write("    -1\n");
}

// Groups of all dimensions share their numbers in this format.
std::vector<Tag> group_numbers(const Mesh& mesh) {
  std::set<Tag> taken;
  std::vector<Tag> numbers;
  Tag last = 0;
  for (const PhysicalGroup& group : mesh.groups) {
    Tag number = group.tag;
    while (number < 1 || number > largest_number || taken.count(number) > 0) number = ++last;
    taken.insert(number);
    numbers.push_back(number);
  }
  return numbers;
}

void write_groups(const Mesh& mesh, const NewNumbers& numbers, OutputFile& output) {
  const std::vector<Tag> group_number = group_numbers(mesh);
  auto blocks = blocks_of_groups(mesh);
  output.write("    -1\n  2477\n");
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    std::vector<Tag> entities;
    for (const std::size_t b : blocks[{mesh.groups[g].dimension, mesh.groups[g].tag}])
      for (const Tag element : numbers.elements[b])
        entities.insert(entities.end(), {8, element, 0, 0});
    if (entities.empty() || mesh.groups[g].dimension == 0) continue;
    write_numbers({group_number[g], 0, 0, 0, 0, 0, 0, static_cast<Tag>(entities.size() / 4)},
                  output);
    output.write(group_name(mesh.groups[g], GroupNames::of_all_dimensions) + "\n");
    write_numbers(entities, output);
  }
  output.write("    -1\n");
}

}  // namespace

std::string unv_real(double value, char exponent_letter) {
  std::string text = fmt::format("{:.16e}", value);
  text[text.find('e')] = exponent_letter;
  return text;
}

void check_unv(const Mesh& mesh, const std::filesystem::path& path) {
  check_serendipity(mesh, path, false);
}

void write_new_unv(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  const NewNumbers numbers = new_numbers(mesh, largest_number);
  write_nodes(mesh, numbers, output);
  write_elements(mesh, numbers, output);
  if (std::any_of(mesh.groups.begin(), mesh.groups.end(),
                  [](const PhysicalGroup& group) { return group.dimension > 0; }))
    write_groups(mesh, numbers, output);
}

}  // namespace roughmesh::detail
