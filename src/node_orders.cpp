// SPDX-License-Identifier: BSD-3-Clause
#include "node_orders.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace roughmesh::detail {
namespace {

// Middles in Gmsh's order (its manual, "Node ordering"). Elements with nodes on their edges only
// are the complete ones cut short.
std::string_view gmsh_middles(ElementShape shape) {
  constexpr std::array<std::string_view, 8> table = {
      "",
      "01",
      "01 12 20",
      "01 12 23 30 0123",
      "01 12 20 30 32 31",
      "01 03 04 12 15 23 26 37 45 47 56 67 0321 0154 0473 1265 2376 4567 01234567",
      "01 02 03 12 14 25 34 35 45 0143 0352 1254",
      "01 03 04 12 14 23 24 34 0321"};
  return table[static_cast<std::size_t>(shape)];
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> result;
  while (!text.empty()) {
    const std::size_t stop = std::min(text.find(' '), text.size());
    result.emplace_back(text.substr(0, stop));
    text.remove_prefix(std::min(stop + 1, text.size()));
  }
  return result;
}

// The same middle whichever way its corners are listed.
std::string sorted(std::string corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

std::vector<int> places_in_gmsh_order(const NodeOrder& order) {
  const int n = n_corners(order.type.shape);
  std::vector<int> places;
  for (int corner = 0; corner < n; ++corner)
    places.push_back(order.corners.empty() ? corner
                                           : order.corners[static_cast<std::size_t>(corner)] - '0');
  std::vector<std::string> in_gmsh = words(gmsh_middles(order.type.shape));
  for (std::string& middle : in_gmsh) middle = sorted(middle);
  for (std::string middle : words(order.middles)) {
    for (char& corner : middle)
      corner = static_cast<char>('0' + places[static_cast<std::size_t>(corner - '0')]);
    const auto found = std::find(in_gmsh.begin(), in_gmsh.end(), sorted(middle));
    places.push_back(n + static_cast<int>(found - in_gmsh.begin()));
  }
  return places;
}

}  // namespace roughmesh::detail
