// SPDX-License-Identifier: BSD-3-Clause
// Writes MSH files of every kind, with nothing of the library: what its reader is tested against.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "roughmesh/mesh.hpp"

namespace roughmesh::test {

/// One kind of MSH file, and how odd its author was.
struct MshStyle {
  int version = 4;  ///< 2 for 2.2, 4 for 4.1
  bool binary = false;
  bool big_endian = false;      ///< of a binary file
  std::string space = " ";      ///< between numbers of a text file
  std::string end = "\n";       ///< of lines of a text file
  bool extra_sections = false;  ///< comments, data and sections nobody knows
  bool partitions = false;  ///< 2.2: partition tags, a ghost among them; 4.1: $PartitionedEntities
  bool parametric = false;  ///< 4.1: nodes with parameters
};

inline std::string name(const MshStyle& style) {
  return fmt::format("msh{}_{}{}", style.version, style.binary ? "binary" : "text",
                     style.big_endian ? "_big_endian" : "");
}

inline void PrintTo(const MshStyle& style, std::ostream* stream) { *stream << name(style); }

/// MSH 2.2 and 4.1, text and binary of both byte orders.
inline std::vector<MshStyle> all_msh_styles() {
  std::vector<MshStyle> styles;
  for (const int version : {2, 4}) {
    styles.push_back({.version = version});
    styles.push_back({.version = version, .binary = true});
    styles.push_back({.version = version, .binary = true, .big_endian = true});
  }
  return styles;
}

inline int gmsh_number_of(const ElementType& type) {
  const std::array<int, 8> first_order = {15, 1, 2, 3, 4, 5, 6, 7};
  if (type.order == 1) return first_order[static_cast<std::size_t>(type.shape)];
  return type == ElementType{ElementShape::tetrahedron, 2, 10} ? 11 : 0;
}

class MshWriter {
 public:
  /// How a coordinate is written in a text file; what tests replace to predict a moved node.
  using CoordinateText = std::function<std::string(std::size_t node, int axis)>;

  MshWriter(const Mesh& mesh, const MshStyle& style)
      : mesh_(mesh), style_(style), coordinate_text_([this](std::size_t node, int axis) {
          std::array<char, 40> text{};
          std::snprintf(text.data(), text.size(), "%.16g", mesh_.nodes[node][axis]);
          return std::string(text.data());
        }) {}

  void set_coordinate_text(CoordinateText text) { coordinate_text_ = std::move(text); }

  std::string bytes() {
    bytes_.clear();
    if (style_.extra_sections) section("Comments", "made by hand  \t 1 2 3");
    write_format();
    write_names();
    if (style_.version == 4) write_entities();
    if (style_.version == 4 && style_.partitions) write_partitioned_entities();
    if (style_.extra_sections) section("Nonsense", "0x00 $ \"quoted\" $End $EndNodesNot");
    style_.version == 4 ? write_nodes4() : write_nodes2();
    style_.version == 4 ? write_elements4() : write_elements2();
    if (!mesh_.periodic_links.empty()) write_periodic();
    if (style_.extra_sections) section("NodeData", "1\n\"height\"\n1\n0.0\n3\n0\n1\n1\n7 0.5");
    return bytes_;
  }

 private:
  void text(const std::string& text) { bytes_ += text; }
  void end() { bytes_ += style_.binary ? "\n" : style_.end; }  // of a line that is always text
  void end_of_numbers() {
    if (!style_.binary) bytes_ += style_.end;
  }
  void begin_section(const std::string& name) {
    text("$" + name);
    end();
  }
  void end_section(const std::string& name) {
    if (style_.binary) bytes_ += "\n";
    text("$End" + name);
    end();
  }
  void section(const std::string& name, const std::string& content) {
    begin_section(name);
    text(content);
    end();
    text("$End" + name);
    end();
  }

  template <typename T>
  void number(T value, const std::string& as_text) {
    if (!style_.binary) {
      bytes_ += as_text + style_.space;
      return;
    }
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (style_.big_endian != (std::endian::native == std::endian::big))
      std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
  }
  void i32(Tag value) { number(static_cast<std::int32_t>(value), std::to_string(value)); }
  void u64(Tag value) { number(static_cast<std::uint64_t>(value), std::to_string(value)); }
  void f64(double value) { number(value, std::to_string(value)); }
  void coordinates(std::size_t node) {
    for (int axis = 0; axis < 3; ++axis)
      number(mesh_.nodes[node][axis], style_.binary ? std::string() : coordinate_text_(node, axis));
  }

  void write_format() {
    begin_section("MeshFormat");
    text(std::string(style_.version == 4 ? "4.1" : "2.2") + (style_.binary ? " 1 8" : " 0 8"));
    end();
    if (style_.binary) i32(1);
    end_section("MeshFormat");
  }

  void write_names() {
    begin_section("PhysicalNames");
    const auto is_named = [](const PhysicalGroup& group) { return !group.name.empty(); };
    text(std::to_string(std::count_if(mesh_.groups.begin(), mesh_.groups.end(), is_named)));
    end();
    for (const PhysicalGroup& group : mesh_.groups) {
      if (!is_named(group)) continue;
      text(std::to_string(group.dimension) + " " + std::to_string(group.tag) + " \"" + group.name +
           "\"");
      end();
    }
    text("$EndPhysicalNames");
    end();
  }

  std::map<std::pair<int, Tag>, std::vector<Tag>> entities() const {
    std::map<std::pair<int, Tag>, std::vector<Tag>> result;
    for (const ElementBlock& block : mesh_.blocks)
      result[{dimension(block.type.shape), block.entity}] = block.physical_groups;
    return result;
  }

  void write_entity_lists(bool is_partitioned) {
    const auto all = entities();
    for (int dim = 0; dim < 4; ++dim)
      u64(std::count_if(all.begin(), all.end(),
                        [&](const auto& entity) { return entity.first.first == dim; }));
    end_of_numbers();
    for (const auto& [key, groups] : all) {
      i32(is_partitioned ? key.second + partition_offset : key.second);
      if (is_partitioned) {
        i32(key.first);
        i32(key.second);
        u64(1);
        i32(1);
      }
      for (int k = 0; k < (key.first == 0 ? 3 : 6); ++k) f64(k);
      u64(static_cast<Tag>(groups.size()));
      for (const Tag group : groups) i32(key.first == 2 ? -group : group);  // reversed orientation
      if (key.first > 0) {
        u64(2);
        i32(1);
        i32(-2);
      }
      end_of_numbers();
    }
  }

  void write_entities() {
    begin_section("Entities");
    write_entity_lists(false);
    end_section("Entities");
  }

  void write_partitioned_entities() {
    begin_section("PartitionedEntities");
    u64(2);
    u64(1);
    i32(1000);
    i32(2);
    end_of_numbers();
    write_entity_lists(true);
    end_section("PartitionedEntities");
  }

  void write_nodes2() {
    begin_section("Nodes");
    text(std::to_string(mesh_.nodes.size()));
    end();
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      i32(mesh_.node_tags[i]);
      coordinates(i);
      end_of_numbers();
    }
    end_section("Nodes");
  }

  void write_tag_range(const std::vector<Tag>& tags) {
    u64(*std::min_element(tags.begin(), tags.end()));
    u64(*std::max_element(tags.begin(), tags.end()));
    end_of_numbers();
  }

  // Two blocks of nodes, the second in an entity of dimension 2.
  void write_nodes4() {
    begin_section("Nodes");
    u64(2);
    u64(static_cast<Tag>(mesh_.nodes.size()));
    write_tag_range(mesh_.node_tags);
    const std::size_t half = mesh_.nodes.size() / 2;
    write_node_block(3, 0, half);
    write_node_block(2, half, mesh_.nodes.size());
    end_section("Nodes");
  }

  void write_node_block(int dim, std::size_t first, std::size_t last) {
    i32(dim);
    i32(1);
    i32(style_.parametric ? 1 : 0);
    u64(static_cast<Tag>(last - first));
    end_of_numbers();
    for (std::size_t i = first; i < last; ++i) {
      u64(mesh_.node_tags[i]);
      end_of_numbers();
    }
    for (std::size_t i = first; i < last; ++i) {
      coordinates(i);
      for (int k = 0; style_.parametric && k < dim; ++k) f64(0.25 * k);
      end_of_numbers();
    }
  }

  void write_elements2() {
    begin_section("Elements");
    text(std::to_string(n_elements(mesh_)));
    end();
    for (const ElementBlock& block : mesh_.blocks) {
      const int n_tags = style_.partitions ? 5 : 2;
      if (style_.binary) {
        i32(gmsh_number_of(block.type));
        i32(block.size());
        i32(n_tags);
      }
      for (Index e = 0; e < block.size(); ++e) write_element2(block, e, n_tags);
    }
    end_section("Elements");
  }

  void write_element2(const ElementBlock& block, Index e, int n_tags) {
    i32(block.tags[static_cast<std::size_t>(e)]);
    if (!style_.binary) {
      i32(gmsh_number_of(block.type));
      i32(n_tags);
    }
    i32(block.physical_groups.empty() ? 0 : block.physical_groups.front());
    i32(block.entity);
    if (style_.partitions) {
      i32(2);
      i32(1);
      i32(-2);
    }
    for (const Index node : block.element(e)) i32(mesh_.node_tags[static_cast<std::size_t>(node)]);
    end_of_numbers();
  }

  void write_elements4() {
    begin_section("Elements");
    u64(static_cast<Tag>(mesh_.blocks.size()));
    u64(n_elements(mesh_));
    write_tag_range({1, n_elements(mesh_)});
    for (const ElementBlock& block : mesh_.blocks) {
      i32(dimension(block.type.shape));
      i32(style_.partitions ? block.entity + partition_offset : block.entity);
      i32(gmsh_number_of(block.type));
      u64(block.size());
      end_of_numbers();
      for (Index e = 0; e < block.size(); ++e) {
        u64(block.tags[static_cast<std::size_t>(e)]);
        for (const Index node : block.element(e))
          u64(mesh_.node_tags[static_cast<std::size_t>(node)]);
        end_of_numbers();
      }
    }
    end_section("Elements");
  }

  // 2.2 writes links as text in binary files too.
  void write_periodic() {
    if (style_.version == 2) return write_periodic2();
    begin_section("Periodic");
    u64(static_cast<Tag>(mesh_.periodic_links.size()));
    end_of_numbers();
    for (const PeriodicLink& link : mesh_.periodic_links) {
      i32(link.dimension);
      i32(link.entity);
      i32(link.master_entity);
      end_of_numbers();
      u64(static_cast<Tag>(link.affine.size()));
      for (const double value : link.affine) f64(value);
      end_of_numbers();
      u64(static_cast<Tag>(link.nodes.size()));
      end_of_numbers();
      for (const auto& [slave, master] : link.nodes) {
        u64(mesh_.node_tags[static_cast<std::size_t>(slave)]);
        u64(mesh_.node_tags[static_cast<std::size_t>(master)]);
        end_of_numbers();
      }
    }
    end_section("Periodic");
  }

  void write_periodic2() {
    std::string content = std::to_string(mesh_.periodic_links.size());
    for (const PeriodicLink& link : mesh_.periodic_links) {
      content += fmt::format("\n{} {} {}\n", link.dimension, link.entity, link.master_entity);
      if (!link.affine.empty()) {
        content += "Affine";
        for (const double value : link.affine) content += fmt::format(" {}", value);
        content += "\n";
      }
      content += std::to_string(link.nodes.size());
      for (const auto& [slave, master] : link.nodes)
        content += fmt::format("\n{} {}", mesh_.node_tags[static_cast<std::size_t>(slave)],
                               mesh_.node_tags[static_cast<std::size_t>(master)]);
    }
    section("Periodic", content);
  }

  static constexpr Tag partition_offset = 500;

  const Mesh& mesh_;
  MshStyle style_;
  CoordinateText coordinate_text_;
  std::string bytes_;
};

inline std::string msh_bytes(const Mesh& mesh, const MshStyle& style) {
  return MshWriter(mesh, style).bytes();
}

/// One element of each shape of order 1 and a tetrahedron of order 2, on shared nodes with numbers
/// far apart; named, unnamed and no groups; a periodic link.
inline Mesh zoo() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0},   {1, 0, 0},   {1, 1, 0},    {0, 1, 0},       {0, 0, 1},
                {1, 0, 1},   {1, 1, 1},   {0, 1, 1},    {0.5, 0.5, 2},   {-1e-5, 1.0 / 3, 1e20},
                {0.1, 0, 0}, {0, 0.2, 0}, {-0.0, 0, 3}, {0.7, -0.7, 0.3}};
  mesh.node_tags = {7, 3, 1000000007, 12, 5, 6, 1, 8, 9, 2000000000, 11, 4, 13, 99};
  Tag tag = 1;
  const auto add = [&](ElementType type, Tag entity, std::vector<Tag> groups,
                       std::vector<Index> nodes) {
    mesh.blocks.push_back({type, entity, std::move(groups), std::move(nodes), {}});
    auto& block = mesh.blocks.back();
    block.tags.resize(block.nodes.size() / static_cast<std::size_t>(type.n_nodes));
    for (Tag& number : block.tags) number = 10 * tag++;
  };
  add({ElementShape::point, 1, 1}, 1, {}, {0});
  add({ElementShape::line, 1, 2}, 1, {4}, {0, 1, 1, 2});
  add({ElementShape::triangle, 1, 3}, 1, {2}, {0, 1, 2, 0, 2, 3});
  add({ElementShape::quadrangle, 1, 4}, 2, {5}, {0, 1, 2, 3});
  add({ElementShape::tetrahedron, 1, 4}, 1, {7}, {0, 1, 3, 4});
  add({ElementShape::hexahedron, 1, 8}, 2, {8}, {0, 1, 2, 3, 4, 5, 6, 7});
  add({ElementShape::prism, 1, 6}, 3, {9}, {0, 1, 3, 4, 5, 7});
  add({ElementShape::pyramid, 1, 5}, 4, {}, {4, 5, 6, 7, 8});
  add({ElementShape::tetrahedron, 2, 10}, 5, {7}, {0, 1, 3, 4, 8, 9, 10, 11, 12, 13});
  mesh.groups = {{1, 4, ""},     {2, 2, "lower side"}, {2, 5, ""}, {2, 6, "nobody's"},
                 {3, 7, "gold"}, {3, 8, "air"},        {3, 9, ""}};
  mesh.periodic_links = {
      {2, 1, 2, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1}, {{4, 0}, {5, 1}}},
      {1, 1, 1, {}, {{1, 0}}}};
  return mesh;
}

}  // namespace roughmesh::test
