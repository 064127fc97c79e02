// SPDX-License-Identifier: BSD-3-Clause
// Boxes of cells of any shape, and ways to disturb a mesh that must not matter.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "meshes.hpp"

namespace roughmesh::test {

inline constexpr ElementType quadrangle_type{ElementShape::quadrangle, 1, 4};

inline ElementType first_order(ElementShape shape) { return {shape, 1, n_corners(shape)}; }

/// Corners of the ideal element of each shape of dimension 2 and 3, all edges of length 1.
inline std::vector<Vec3> ideal_corners(ElementShape shape) {
  const double h = std::sqrt(3.0) / 2;
  switch (shape) {
    case ElementShape::triangle:
      return {{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}};
    case ElementShape::quadrangle:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    case ElementShape::tetrahedron:
      return {{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0.5, h / 3, std::sqrt(2.0 / 3)}};
    case ElementShape::hexahedron:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
              {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    case ElementShape::prism:
      return {{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0, 0, 1}, {1, 0, 1}, {0.5, h, 1}};
    case ElementShape::pyramid:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, std::sqrt(0.5)}};
    default:
      return {};
  }
}

inline Mesh single_element(ElementShape shape, std::vector<Vec3> corners) {
  Mesh mesh;
  std::vector<Index> nodes(corners.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  mesh.nodes = std::move(corners);
  mesh.blocks = {make_block(first_order(shape), 1, {}, std::move(nodes), 1)};
  number_nodes(mesh);
  return mesh;
}

/// Cells that one cube of a box is cut into, from its corners 0 to 7 in the order of a hexahedron
/// and its centre 8 (used by pyramids only).
inline std::vector<std::vector<int>> cells_of_cube(ElementShape shape) {
  switch (shape) {
    case ElementShape::hexahedron:
      return {{0, 1, 2, 3, 4, 5, 6, 7}};
    case ElementShape::prism:
      return {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};
    case ElementShape::pyramid:
      return {{0, 1, 2, 3, 8}, {0, 4, 5, 1, 8}, {0, 3, 7, 4, 8},
              {1, 5, 6, 2, 8}, {2, 6, 7, 3, 8}, {4, 7, 6, 5, 8}};
    default:  // six tetrahedra of equal volume around the diagonal from 0 to 6
      return {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  }
}

/// Box [0, 1]^3 of `divisions` cubes along each side (even), each cut into cells of the shape. The
/// cells below z = 1/2 are volume 1, those above volume 2. Faces in the plane z = 1/2 are group
/// "middle" (1), those in z = 1 group "top" (2): quadrangles on hexahedra and pyramids, triangles
/// on the others, looking up.
inline Mesh cell_box(ElementShape shape, int divisions) {
  const int row = divisions + 1;
  Mesh mesh;
  for (int k = 0; k <= divisions; ++k)
    for (int j = 0; j <= divisions; ++j)
      for (int i = 0; i <= divisions; ++i) mesh.nodes.push_back(Vec3(i, j, k) / divisions);
  const bool quadrangles = shape == ElementShape::hexahedron || shape == ElementShape::pyramid;
  std::array<std::vector<Index>, 2> cells, faces;
  for (int k = 0; k < divisions; ++k)
    for (int j = 0; j < divisions; ++j)
      for (int i = 0; i < divisions; ++i) {
        const Index a = (k * row + j) * row + i, up = row * row;
        std::array<Index, 9> c = {
            a, a + 1, a + 1 + row, a + row, a + up, a + up + 1, a + up + 1 + row, a + up + row, 0};
        if (shape == ElementShape::pyramid) {
          c[8] = mesh.n_nodes();
          mesh.nodes.push_back((mesh.nodes[c[0]] + mesh.nodes[c[6]]) / 2);
        }
        for (const std::vector<int>& cell : cells_of_cube(shape))
          for (const int corner : cell) cells[2 * k < divisions ? 0 : 1].push_back(c[corner]);
        if (k + 1 != divisions / 2 && k + 1 != divisions) continue;
        auto& out = faces[k + 1 == divisions ? 1 : 0];
        if (quadrangles)
          out.insert(out.end(), {c[4], c[5], c[6], c[7]});
        else
          out.insert(out.end(), {c[4], c[5], c[6], c[4], c[6], c[7]});
      }
  const ElementType face_type = quadrangles ? quadrangle_type : triangle_type;
  mesh.blocks = {make_block(face_type, 1, {1}, faces[0], 1),
                 make_block(face_type, 2, {2}, faces[1], 1001),
                 make_block(first_order(shape), 1, {1}, cells[0], 10001),
                 make_block(first_order(shape), 2, {2}, cells[1], 20001)};
  mesh.groups = {{2, 1, "middle"}, {2, 2, "top"}, {3, 1, "below"}, {3, 2, "above"}};
  number_nodes(mesh);
  return mesh;
}

/// The mesh without its elements of dimension 2.
inline Mesh without_faces(Mesh mesh) {
  std::erase_if(mesh.blocks, [](const ElementBlock& b) { return dimension(b.type.shape) == 2; });
  std::erase_if(mesh.groups, [](const PhysicalGroup& g) { return g.dimension == 2; });
  return mesh;
}

/// Turns a face over; gives a tetrahedron the other sign of its volume.
inline void turn_element(ElementBlock& block, Index element) {
  const auto n = static_cast<std::ptrdiff_t>(block.type.n_nodes);
  const auto begin = block.nodes.begin() + element * n;
  if (block.type.shape == ElementShape::tetrahedron)
    std::iter_swap(begin, begin + 1);
  else
    std::reverse(begin, begin + n);
}

/// Turns every face but the very first, or not, at random.
inline void turn_some_faces(Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  bool first = true;
  for (ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != 2) continue;
    for (Index e = 0; e < block.size(); ++e) {
      if (!first && random() % 2 == 0) turn_element(block, e);
      first = false;
    }
  }
}

/// New numbers for all nodes and a new order for the elements of each block.
inline Mesh shuffled(const Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Index> place(mesh.nodes.size());
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  Mesh result = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) result.nodes[place[i]] = mesh.nodes[i];
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& from = mesh.blocks[b];
    ElementBlock& to = result.blocks[b];
    std::vector<Index> order(from.tags.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    to.nodes.clear();
    for (std::size_t i = 0; i < order.size(); ++i) {
      to.tags[i] = from.tags[order[i]];
      for (const Index node : from.element(order[i])) to.nodes.push_back(place[node]);
    }
  }
  return result;
}

inline Mesh transformed(Mesh mesh, const Eigen::Affine3d& map) {
  for (Vec3& x : mesh.nodes) x = map * x;
  return mesh;
}

/// Sum of the volumes of the tetrahedra of one volume entity, or of all (entity 0).
inline double tetrahedron_volume(const Mesh& mesh, const std::vector<Vec3>& nodes, Tag entity = 0) {
  double sum = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.type.shape != ElementShape::tetrahedron) continue;
    if (entity != 0 && block.entity != entity) continue;
    for (Index e = 0; e < block.size(); ++e) {
      const auto t = block.element(e);
      const Vec3 &a = nodes[t[0]], &b = nodes[t[1]], &c = nodes[t[2]], &d = nodes[t[3]];
      sum += (b - a).cross(c - a).dot(d - a) / 6;
    }
  }
  return sum;
}

}  // namespace roughmesh::test
