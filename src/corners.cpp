// SPDX-License-Identifier: BSD-3-Clause
#include "corners.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::array<CornerTetrahedron, 4> tetrahedron = {
    {{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 0, 2, 1}}};
constexpr std::array<CornerTetrahedron, 8> hexahedron = {{{0, 1, 3, 4},
                                                          {1, 2, 0, 5},
                                                          {2, 3, 1, 6},
                                                          {3, 0, 2, 7},
                                                          {4, 7, 5, 0},
                                                          {5, 4, 6, 1},
                                                          {6, 5, 7, 2},
                                                          {7, 6, 4, 3}}};
constexpr std::array<CornerTetrahedron, 6> prism = {
    {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}};
constexpr std::array<CornerTetrahedron, 4> pyramid = {
    {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}};

}  // namespace

std::span<const CornerTetrahedron> corner_tetrahedra(ElementShape shape) {
  switch (shape) {
    case ElementShape::tetrahedron:
      return tetrahedron;
    case ElementShape::hexahedron:
      return hexahedron;
    case ElementShape::prism:
      return prism;
    case ElementShape::pyramid:
      return pyramid;
    default:
      return {};
  }
}

}  // namespace roughmesh::detail
