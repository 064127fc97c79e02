// SPDX-License-Identifier: BSD-3-Clause
#include "element_nodes.hpp"

#include <algorithm>
#include <numeric>

#include "node_orders.hpp"

namespace roughmesh::detail {
namespace {

// What is worked out once for a type of order 1 or 2.
struct TypeFacts {
  std::vector<LocalFace> faces;
  std::vector<std::vector<int>> facets;
  std::vector<FollowingNode> following;
};

int n_serendipity_nodes(ElementShape shape) { return serendipity_type(shape, 2).n_nodes; }

bool has_middle_nodes(const ElementType& type) {
  return type.order == 2 && type.n_nodes > n_serendipity_nodes(type.shape);
}

// Nodes in the middle of faces come after those on edges, in the order of the quadrangles.
std::vector<LocalFace> make_faces(const ElementType& type) {
  std::vector<LocalFace> faces;
  int next_middle = n_serendipity_nodes(type.shape);
  for (const std::vector<int>& corners : local_faces(type.shape)) {
    LocalFace face{{shape_of_face(corners.size()), 1, 0}, {}};
    const auto add = [&](int node) { face.nodes[face.type.n_nodes++] = node; };
    for (const int corner : corners) add(corner);
    if (type.order == 2) {
      face.type.order = 2;
      const std::size_t n_edges = local_edges(face.type.shape).size();
      for (std::size_t k = 0; k < n_edges; ++k)
        add(middle_node(type.shape, corners[k], corners[(k + 1) % corners.size()]));
      if (corners.size() == 4 && dimension(type.shape) == 3 && has_middle_nodes(type))
        add(next_middle++);
    }
    faces.push_back(face);
  }
  return faces;
}

std::vector<int> consecutive(int begin, int end) {
  std::vector<int> numbers(static_cast<std::size_t>(end - begin));
  std::iota(numbers.begin(), numbers.end(), begin);
  return numbers;
}

std::vector<std::vector<int>> make_facets(const ElementType& type) {
  if (type.order == 2 && type.shape == ElementShape::line) return {{0, 2}, {2, 1}};
  if (type.order == 2 && type.shape == ElementShape::triangle)
    return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  if (type.order == 2 && has_middle_nodes(type))
    return {{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}};
  if (type.order == 2) return {{0, 4, 7}, {4, 1, 5}, {5, 2, 6}, {6, 3, 7}, {4, 5, 6, 7}};
  return {consecutive(0, n_corners(type.shape))};
}

// Serendipity interpolation at the middle: all corners alike and all nodes on edges alike, exact
// for quadratic functions.
FollowingNode middle_of(int node, std::span<const int> corners, std::span<const int> on_edges) {
  const bool is_face = corners.size() == 4;
  FollowingNode middle{node, {}};
  for (const int k : corners) middle.of_others.emplace_back(k, -0.25);
  for (const int k : on_edges) middle.of_others.emplace_back(k, is_face ? 0.5 : 0.25);
  return middle;
}

std::vector<FollowingNode> make_following(const ElementType& type,
                                          std::span<const LocalFace> faces) {
  std::vector<FollowingNode> following;
  const int corners = n_corners(type.shape), serendipity = n_serendipity_nodes(type.shape);
  const auto edges = local_edges(type.shape);
  for (std::size_t k = 0; k < edges.size(); ++k)
    following.push_back({corners + static_cast<int>(k), {{edges[k][0], 0.5}, {edges[k][1], 0.5}}});
  for (const LocalFace& face : faces)
    if (face.type.n_nodes == 9)
      following.push_back(middle_of(face.nodes[8], std::span(face.nodes).first(4),
                                    std::span(face.nodes).subspan(4, 4)));
  const bool has_own_middle =
      type.shape == ElementShape::quadrangle || type.shape == ElementShape::hexahedron;
  if (has_own_middle && has_middle_nodes(type))
    following.push_back(
        middle_of(type.n_nodes - 1, consecutive(0, corners), consecutive(corners, serendipity)));
  return following;
}

TypeFacts make_facts(const ElementType& type) {
  TypeFacts facts;
  facts.faces = make_faces(type);
  if (dimension(type.shape) == 1 || dimension(type.shape) == 2) facts.facets = make_facets(type);
  if (type.order == 2) facts.following = make_following(type, facts.faces);
  return facts;
}

// Order 1, order 2, order 2 with nodes in the middle of faces.
using ShapeTable = std::array<TypeFacts, 3>;

std::array<ShapeTable, 8> make_table() {
  std::array<ShapeTable, 8> table;
  for (std::size_t s = 0; s < table.size(); ++s) {
    const auto shape = static_cast<ElementShape>(s);
    const int n = n_serendipity_nodes(shape);
    int n_middles = shape == ElementShape::quadrangle || shape == ElementShape::hexahedron ? 1 : 0;
    if (dimension(shape) == 3)
      for (const std::vector<int>& face : local_faces(shape)) n_middles += face.size() == 4;
    table[s] = {make_facts({shape, 1, n_corners(shape)}), make_facts({shape, 2, n}),
                make_facts({shape, 2, n + n_middles})};
  }
  return table;
}

const TypeFacts& facts(const ElementType& type) {
  static const std::array<ShapeTable, 8> table = make_table();
  const ShapeTable& shape = table[static_cast<std::size_t>(type.shape)];
  if (type.order != 2) return shape[0];
  return shape[has_middle_nodes(type) ? 2 : 1];
}

}  // namespace

ElementShape shape_of_face(std::size_t n_corners) {
  if (n_corners == 2) return ElementShape::line;
  return n_corners == 3 ? ElementShape::triangle : ElementShape::quadrangle;
}

std::span<const LocalFace> element_faces(const ElementType& type) { return facts(type).faces; }

std::span<const std::vector<int>> facets(const ElementType& type) { return facts(type).facets; }

std::span<const FollowingNode> following_nodes(const ElementType& type) {
  return facts(type).following;
}

}  // namespace roughmesh::detail
