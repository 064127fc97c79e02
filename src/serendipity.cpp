// SPDX-License-Identifier: BSD-3-Clause
#include "serendipity.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace roughmesh::detail {
namespace {

// https://gmsh.info/doc/texinfo/gmsh.html, "Node ordering"
constexpr std::array<std::string_view, 8> gmsh_places = {
    "0",
    "0 1 01",
    "0 1 2 01 12 02",
    "0 1 2 3 01 12 23 03",
    "0 1 2 3 01 12 02 03 23 13",
    "0 1 2 3 4 5 6 7 01 03 04 12 15 23 26 37 45 47 56 67",
    "0 1 2 3 4 5 01 02 03 12 14 25 34 35 45",
    "0 1 2 3 4 01 03 04 12 14 23 24 34"};

std::vector<std::string> split(std::string_view places) {
  std::vector<std::string> result(1);
  for (const char c : places)
    if (c == ' ')
      result.emplace_back();
    else
      result.back() += c;
  for (std::string& place : result) std::sort(place.begin(), place.end());
  return result;
}

std::size_t index(ElementShape shape) { return static_cast<std::size_t>(shape); }

int position(const std::vector<std::string>& places, const std::string& place) {
  return static_cast<int>(std::find(places.begin(), places.end(), place) - places.begin());
}

std::span<const int> first_nodes(int n) {
  static const std::vector<int> numbers = [] {
    std::vector<int> result(20);
    std::iota(result.begin(), result.end(), 0);
    return result;
  }();
  return {numbers.data(), static_cast<std::size_t>(n)};
}

}  // namespace

ElementType serendipity_type(ElementShape shape, int order) {
  const std::string_view places = gmsh_places[index(shape)];
  const auto n_second = 1 + std::count(places.begin(), places.end(), ' ');
  return {shape, order, order == 1 ? n_corners(shape) : static_cast<int>(n_second)};
}

bool is_serendipity(const ElementType& type) {
  return type.order <= 2 && type == serendipity_type(type.shape, type.order);
}

int middle_node(ElementShape shape, int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return position(split(gmsh_places[index(shape)]), std::to_string(low) + std::to_string(high));
}

SerendipityOrder::SerendipityOrder(std::span<const SecondOrderNodes> nodes) {
  for (const SecondOrderNodes& of_shape : nodes) {
    const std::vector<std::string> file = split(of_shape.places);
    const std::vector<std::string> gmsh = split(gmsh_places[index(of_shape.shape)]);
    for (const std::string& place : gmsh)
      in_file_[index(of_shape.shape)].push_back(position(file, place));
    for (const std::string& place : file)
      in_gmsh_[index(of_shape.shape)].push_back(position(gmsh, place));
  }
}

std::span<const int> SerendipityOrder::in_file(const ElementType& type) const {
  const std::vector<int>& order = in_file_[index(type.shape)];
  if (type.order == 2 && !order.empty()) return order;
  return first_nodes(type.n_nodes);
}

std::span<const int> SerendipityOrder::in_gmsh(const ElementType& type) const {
  const std::vector<int>& order = in_gmsh_[index(type.shape)];
  if (type.order == 2 && !order.empty()) return order;
  return first_nodes(type.n_nodes);
}

}  // namespace roughmesh::detail
