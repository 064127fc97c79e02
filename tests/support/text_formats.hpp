// SPDX-License-Identifier: BSD-3-Clause
// What tests of text formats of meshes share.
#pragma once

#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"

namespace roughmesh::test {

inline Mesh read_text(const TemporaryFolder& folder, std::string_view name,
                      const std::string& bytes) {
  write_bytes(folder / name, bytes);
  return read_mesh(folder / name);
}

inline std::string with(std::string bytes, const std::string& what, const std::string& by) {
  const std::size_t place = bytes.find(what);
  if (place == std::string::npos) throw std::logic_error("test: nothing to replace: " + what);
  return bytes.replace(place, what.size(), by);
}

inline std::string with_crlf(const std::string& bytes) {
  std::string result;
  for (const char c : bytes) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return result;
}

/// All but positions and the order of blocks within a dimension.
inline void expect_same_elements(const Mesh& mesh, const Mesh& expected) {
  EXPECT_EQ(mesh.node_tags, expected.node_tags);
  ASSERT_EQ(mesh.blocks.size(), expected.blocks.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    SCOPED_TRACE(b);
    EXPECT_EQ(mesh.blocks[b].type, expected.blocks[b].type);
    EXPECT_EQ(mesh.blocks[b].physical_groups.size(), expected.blocks[b].physical_groups.size());
    EXPECT_EQ(mesh.blocks[b].nodes, expected.blocks[b].nodes);
    EXPECT_EQ(mesh.blocks[b].tags, expected.blocks[b].tags);
  }
}

/// Elements in each group, by dimension and name.
inline std::map<std::pair<int, std::string>, std::vector<Tag>> members(const Mesh& mesh) {
  std::map<std::pair<int, std::string>, std::vector<Tag>> result;
  for (const PhysicalGroup& group : mesh.groups)
    for (const ElementBlock& block : mesh.blocks)
      if (dimension(block.type.shape) == group.dimension &&
          std::count(block.physical_groups.begin(), block.physical_groups.end(), group.tag) > 0) {
        auto& tags = result[{group.dimension, group.name}];
        tags.insert(tags.end(), block.tags.begin(), block.tags.end());
      }
  return result;
}

/// The first edge of each node of an element of order 2 behind its corners, in Gmsh's order, from
/// the manual's figures.
inline const std::vector<std::pair<int, int>>& second_order_edges(ElementShape shape) {
  using Edges = std::vector<std::pair<int, int>>;
  static const std::map<ElementShape, Edges> edges = {
      {ElementShape::point, {}},
      {ElementShape::line, {{0, 1}}},
      {ElementShape::triangle, {{0, 1}, {1, 2}, {2, 0}}},
      {ElementShape::quadrangle, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
      {ElementShape::tetrahedron, {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}},
      {ElementShape::hexahedron,
       {{0, 1},
        {0, 3},
        {0, 4},
        {1, 2},
        {1, 5},
        {2, 3},
        {2, 6},
        {3, 7},
        {4, 5},
        {4, 7},
        {5, 6},
        {6, 7}}},
      {ElementShape::prism,
       {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}},
      {ElementShape::pyramid, {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}}};
  return edges.at(shape);
}

/// Each node on an edge lies in its middle, to `tolerance`; the number of elements of order 2.
inline Index expect_middles(const Mesh& mesh, double tolerance) {
  Index n = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.order != 2) continue;
    const auto& edges = second_order_edges(block.type.shape);
    const auto n_corners = static_cast<std::size_t>(block.type.n_nodes) - edges.size();
    for (Index e = 0; e < block.size(); ++e, ++n)
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const auto x = [&](std::size_t i) { return mesh.nodes[block.element(e)[i]]; };
        const Vec3 middle = (x(edges[k].first) + x(edges[k].second)) / 2;
        EXPECT_LE((x(n_corners + k) - middle).norm(), tolerance)
            << name(block.type) << " node " << n_corners + k;
      }
  }
  return n;
}

/// One element of order 2 of each shape but points, each on nodes of its own, in a group of its
/// own.
inline Mesh second_order_zoo(bool with_pyramid) {
  const std::vector<std::pair<ElementShape, int>> shapes = {
      {ElementShape::line, 2},        {ElementShape::triangle, 3},   {ElementShape::quadrangle, 4},
      {ElementShape::tetrahedron, 4}, {ElementShape::hexahedron, 8}, {ElementShape::prism, 6},
      {ElementShape::pyramid, 5}};
  Mesh mesh;
  for (const auto& [shape, n_corners] : shapes) {
    if (shape == ElementShape::pyramid && !with_pyramid) continue;
    std::vector<Index> nodes;
    const auto add = [&](const Vec3& x) {
      nodes.push_back(mesh.n_nodes());
      mesh.nodes.push_back(x);
    };
    for (int k = 0; k < n_corners; ++k)
      add(Vec3(std::sin(1.0 + mesh.n_nodes()), std::cos(3.0 * k), k / 3.0));
    for (const auto& [a, b] : second_order_edges(shape))
      add((mesh.nodes[nodes[a]] + mesh.nodes[nodes[b]]) / 2);
    const auto tag = static_cast<Tag>(mesh.blocks.size()) + 1;
    mesh.blocks.push_back(
        make_block({shape, 2, static_cast<int>(nodes.size())}, 0, {tag}, nodes, 10 * tag));
    mesh.groups.push_back({dimension(shape), tag, "group " + std::to_string(tag)});
  }
  number_nodes(mesh);
  return mesh;
}

enum class Cells { tetrahedra, prisms, hexahedra };

/// A box of cells of order 2, as a file of gmsh's own writing.
inline std::filesystem::path gmsh_box(const TemporaryFolder& folder, const std::string& extension,
                                      Cells cells) {
  const std::string recombine = cells == Cells::tetrahedra ? "" : "Recombine; ";
  const std::string quadrangles = cells == Cells::hexahedra
                                      ? "Transfinite Surface{1};\nRecombine Surface{1};\n"
                                      : std::string();
  write_bytes(folder / "box.geo",
              "SetFactory(\"OpenCASCADE\");\nRectangle(1) = {0, 0, 0, 1, 2};\n" + quadrangles +
                  "a[] = Extrude {0, 0, 1} { Surface{1}; Layers{2}; " + recombine +
                  "};\nPhysical Volume(\"inside\", 7) = {a[1]};\n"
                  "Physical Surface(\"top\", 3) = {a[0]};\nPhysical Surface(\"base\", 4) = {1};\n"
                  "MeshSize {:} = 1;\n");
  const std::filesystem::path file = folder / ("box" + extension);
  run("gmsh -3 -order 2 -setnumber Mesh.SecondOrderIncomplete 1 " + (folder / "box.geo").string() +
      " -o " + file.string() + " > /dev/null 2>&1");
  return file;
}

/// Has the mesh cells of the kind, of order 2?
inline bool has_cells(const Mesh& mesh, Cells cells) {
  constexpr std::array shapes = {ElementShape::tetrahedron, ElementShape::prism,
                                 ElementShape::hexahedron};
  return std::any_of(mesh.blocks.begin(), mesh.blocks.end(), [&](const ElementBlock& block) {
    return block.type.shape == shapes[static_cast<std::size_t>(cells)] && block.type.order == 2;
  });
}

/// The mesh that gmsh makes of a file.
inline Mesh seen_by_gmsh(const TemporaryFolder& folder, const std::filesystem::path& file) {
  const std::string resaved = (folder / "resaved.msh").string();
  const std::string log = (folder / "log").string();
  EXPECT_EQ(run("gmsh -save -format msh41 -setnumber Mesh.SaveAll 1 -o " + resaved + " " +
                file.string() + " > " + log + " 2>&1"),
            0)
      << read_bytes(log);
  EXPECT_EQ(read_bytes(log).find("Error"), std::string::npos) << read_bytes(log);
  return read_mesh(resaved);
}

enum class Kind { format_error, input_error };

struct Refusal {
  std::string name;  ///< letters, digits and underscores
  std::string bytes;
  std::string part_of_message;
  Kind kind = Kind::format_error;
};

inline void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.name; }

/// Refused in one short line that begins with the path and holds `part`.
inline void expect_refused(const std::filesystem::path& path, Kind kind, const std::string& part) {
  std::string message = "no error";
  try {
    read_mesh(path);
  } catch (const FormatError& error) {
    EXPECT_EQ(kind, Kind::format_error) << error.what();
    message = error.what();
  } catch (const InputError& error) {
    EXPECT_EQ(kind, Kind::input_error) << error.what();
    message = error.what();
  }
  EXPECT_EQ(message.find(path.string()), 0) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << message;
  EXPECT_LT(message.size(), path.string().size() + 250) << message;
}

/// Refused in one line, or a mesh that comes out as it went in and whose nodes can all be moved.
inline void expect_read_or_refused(const TemporaryFolder& folder, const std::string& name,
                                   const std::string& bytes) {
  const std::filesystem::path out = folder / ("out_" + name);
  try {
    Mesh mesh = read_text(folder, name, bytes);
    write_mesh(mesh, out);
    EXPECT_EQ(read_bytes(out), bytes);
    for (Vec3& x : mesh.nodes) x += Vec3(0.25, -0.5, 0.125);
    write_mesh(mesh, out);
    const Mesh again = read_mesh(out);
    expect_same_elements(again, mesh);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)  // 16 characters hold 11 digits or more
      EXPECT_LE((again.nodes[i] - mesh.nodes[i]).norm(), 1e-11 * mesh.nodes[i].norm()) << bytes;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find_first_of("\n\r"), std::string::npos);
  }
}

inline void expect_survives_cuts(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  for (std::size_t size = 1; size < bytes.size(); ++size)
    expect_read_or_refused(folder, name, bytes.substr(0, size));
}

inline void expect_survives_damage(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string signs = "0123456789 -+.,*$\t\n\rEDeS=";
  std::mt19937 random(5);
  for (int k = 0; k < 2000; ++k) {
    std::string damaged = bytes;
    for (int damage = 0; damage < 1 + k % 4; ++damage)
      damaged[random() % damaged.size()] =
          k % 8 == 0 ? static_cast<char>(random()) : signs[random() % signs.size()];
    expect_read_or_refused(folder, name, damaged);
  }
}

}  // namespace roughmesh::test
