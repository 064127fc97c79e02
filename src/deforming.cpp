// SPDX-License-Identifier: BSD-3-Clause
#include "deforming.hpp"

#include <algorithm>

#include "corners.hpp"

namespace roughmesh::detail {
namespace {

template <class Visit>
void for_each_simplex(const ElementBlock& block, Index element, Visit&& visit) {
  const auto nodes =
      block.element(element).first(static_cast<std::size_t>(n_corners(block.type.shape)));
  const std::size_t n = nodes.size();
  if (n == 3) visit(Simplex{nodes[0], nodes[1], nodes[2], -1});
  if (block.type.shape == ElementShape::quadrangle)
    for (std::size_t k = 0; k < n; ++k)
      visit(Simplex{nodes[k], nodes[(k + 1) % n], nodes[(k + n - 1) % n], -1});
  auto corners = corner_tetrahedra(block.type.shape);
  if (block.type.shape == ElementShape::tetrahedron) corners = corners.first(1);
  for (const auto& [a, b, c, d] : corners) visit(Simplex{nodes[a], nodes[b], nodes[c], nodes[d]});
}

}  // namespace

std::vector<Simplex> deforming_simplices(const Mesh& mesh, int cell_dimension,
                                         const NodeFlags& is_free) {
  std::vector<Simplex> simplices;
  const auto can_move = [&](Index node) { return node >= 0 && is_free[node] != 0; };
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; dimension(block.type.shape) == cell_dimension && e < block.size(); ++e)
      for_each_simplex(block, e, [&](const Simplex& simplex) {
        if (std::any_of(simplex.begin(), simplex.end(), can_move)) simplices.push_back(simplex);
      });
  return simplices;
}

}  // namespace roughmesh::detail
