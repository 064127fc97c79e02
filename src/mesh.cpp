// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/mesh.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace roughmesh {
namespace {

struct ShapeFacts {
  const char* name;
  int dimension;
  int n_corners;
  std::vector<std::vector<int>> faces;
  std::vector<std::array<int, 2>> edges;
};

// Numbering of Gmsh ("Node ordering" in its manual); faces seen from outside run counter-clockwise.
const ShapeFacts& facts(ElementShape shape) {
  static const std::array<ShapeFacts, 8> table = {{
      {"point", 0, 1, {}, {}},
      {"line", 1, 2, {}, {{0, 1}}},
      {"triangle", 2, 3, {{0, 1}, {1, 2}, {2, 0}}, {{0, 1}, {1, 2}, {2, 0}}},
      {"quadrangle", 2, 4, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
      {"tetrahedron",
       3,
       4,
       {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
       {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}},
      {"hexahedron",
       3,
       8,
       {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}},
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
      {"prism",
       3,
       6,
       {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}},
       {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}},
      {"pyramid",
       3,
       5,
       {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
       {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}},
  }};
  return table[static_cast<std::size_t>(shape)];
}

}  // namespace

int dimension(ElementShape shape) { return facts(shape).dimension; }

int n_corners(ElementShape shape) { return facts(shape).n_corners; }

std::string name(const ElementType& type) {
  if (type.order == 1) return facts(type.shape).name;
  return fmt::format("{} of order {}", facts(type.shape).name, type.order);
}

std::span<const std::vector<int>> local_faces(ElementShape shape) { return facts(shape).faces; }

std::span<const std::array<int, 2>> local_edges(ElementShape shape) { return facts(shape).edges; }

std::string name(MeshFormat format) {
  static constexpr std::array names = {"none", "msh2",  "msh4", "stl",    "ply",
                                       "ply2", "obj",   "off",  "abaqus", "nastran",
                                       "unv",  "medit", "su2",  "vtk",    "vtu"};
  return names[static_cast<std::size_t>(format)];
}

int dimension(const Mesh& mesh) {
  int largest = -1;
  for (const ElementBlock& block : mesh.blocks)
    if (block.size() > 0) largest = std::max(largest, dimension(block.type.shape));
  return largest;
}

std::int64_t n_elements(const Mesh& mesh) {
  std::int64_t n = 0;
  for (const ElementBlock& block : mesh.blocks) n += block.size();
  return n;
}

std::int64_t n_elements(const Mesh& mesh, int dim) {
  std::int64_t n = 0;
  for (const ElementBlock& block : mesh.blocks)
    if (dimension(block.type.shape) == dim) n += block.size();
  return n;
}

}  // namespace roughmesh
