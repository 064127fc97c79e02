// SPDX-License-Identifier: BSD-3-Clause
#include "node_orders.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

namespace roughmesh::detail {
namespace {

// Gmsh's order (its manual, "Node ordering"). Elements of fewer nodes are these cut short.
std::string_view gmsh_nodes(ElementShape shape) {
  constexpr std::array<std::string_view, 8> table = {
      "0",
      "0 1 01",
      "0 1 2 01 12 02",
      "0 1 2 3 01 12 23 03 0123",
      "0 1 2 3 01 12 02 03 23 13",
      "0 1 2 3 4 5 6 7 01 03 04 12 15 23 26 37 45 47 56 67 0123 0145 0347 1256 2367 4567 01234567",
      "0 1 2 3 4 5 01 02 03 12 14 25 34 35 45 0134 0235 1245",
      "0 1 2 3 4 01 03 04 12 14 23 24 34 0123"};
  return table[static_cast<std::size_t>(shape)];
}

// Nodes by their corners, these ascending.
std::vector<std::string> split(std::string_view nodes) {
  std::vector<std::string> result(1);
  for (const char c : nodes)
    if (c == ' ')
      result.emplace_back();
    else
      result.back() += c;
  for (std::string& node : result) std::sort(node.begin(), node.end());
  return result;
}

int position(const std::vector<std::string>& nodes, const std::string& node) {
  return static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
}

std::span<const int> first_nodes(int n) {
  static const std::vector<int> numbers = [] {
    std::vector<int> result(27);
    std::iota(result.begin(), result.end(), 0);
    return result;
  }();
  return {numbers.data(), static_cast<std::size_t>(n)};
}

std::vector<int> inverse(const std::vector<int>& places) {
  std::vector<int> result(places.size());
  for (std::size_t k = 0; k < places.size(); ++k)
    result[static_cast<std::size_t>(places[k])] = static_cast<int>(k);
  return result;
}

}  // namespace

std::vector<int> places_in_gmsh_order(const NodeOrder& order) {
  if (order.nodes.empty()) {
    const auto same = first_nodes(order.type.n_nodes);
    return {same.begin(), same.end()};
  }
  const std::vector<std::string> in_gmsh = split(gmsh_nodes(order.type.shape));
  std::vector<int> places;
  for (const std::string& node : split(order.nodes)) places.push_back(position(in_gmsh, node));
  return places;
}

NodeOrders::NodeOrders(std::span<const NodeOrder> orders) {
  for (const NodeOrder& order : orders) {
    const auto& [shape, degree, n_nodes] = order.type;
    std::vector<int> places = places_in_gmsh_order(order);
    in_file_[{shape, degree, n_nodes}] = inverse(places);
    in_gmsh_[{shape, degree, n_nodes}] = std::move(places);
  }
}

std::span<const int> NodeOrders::find(const Places& places, const ElementType& type) {
  const auto found = places.find({type.shape, type.order, type.n_nodes});
  if (found != places.end()) return found->second;
  return first_nodes(type.n_nodes);
}

ElementType serendipity_type(ElementShape shape, int order) {
  const int n_corner_nodes = n_corners(shape);
  const auto n_edges = static_cast<int>(local_edges(shape).size());
  return {shape, order, order == 1 ? n_corner_nodes : n_corner_nodes + n_edges};
}

bool is_serendipity(const ElementType& type) {
  return type.order <= 2 && type == serendipity_type(type.shape, type.order);
}

int middle_node(ElementShape shape, int a, int b) {
  const auto edges = local_edges(shape);
  const auto at = std::find_if(edges.begin(), edges.end(), [&](const auto& edge) {
    return (edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a);
  });
  return n_corners(shape) + static_cast<int>(at - edges.begin());
}

}  // namespace roughmesh::detail
