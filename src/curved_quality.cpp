// SPDX-License-Identifier: BSD-3-Clause
#include "curved_quality.hpp"

#include <algorithm>
#include <limits>

#include "corners.hpp"

namespace roughmesh::detail {

double straight_jacobian(ElementShape shape, std::span<const Index> nodes,
                         std::span<const Vec3> positions, const ElementOrientation& orientation) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c, d] : corner_tetrahedra(shape))
    least =
        std::min(least, orientation.sign * determinant(positions[nodes[a]], positions[nodes[b]],
                                                       positions[nodes[c]], positions[nodes[d]]));
  if (dimension(shape) == 3) return least;
  const auto n = static_cast<std::size_t>(n_corners(shape));
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3& x = positions[nodes[k]];
    least = std::min(least, (positions[nodes[(k + 1) % n]] - x)
                                .cross(positions[nodes[(k + n - 1) % n]] - x)
                                .dot(orientation.normal));
  }
  return least;
}

std::vector<double> jacobian_coefficients(const JacobianPolynomial& polynomial,
                                          std::span<const Index> nodes,
                                          std::span<const Vec3> positions,
                                          const ElementOrientation& orientation) {
  std::array<Vec3, most_quadratic_nodes> of_element;
  for (std::size_t k = 0; k < nodes.size(); ++k) of_element[k] = positions[nodes[k]];
  std::vector<double> coefficients =
      polynomial.coefficients({of_element.data(), nodes.size()}, orientation.normal);
  if (orientation.sign < 0)
    for (double& each : coefficients) each = -each;
  return coefficients;
}

std::optional<LeastValue> curved_quality(const ElementType& type, std::span<const Index> nodes,
                                         std::span<const Vec3> positions,
                                         const ElementOrientation& orientation) {
  const JacobianPolynomial* const polynomial = JacobianPolynomial::of(type);
  if (polynomial == nullptr) return std::nullopt;
  const double straight = straight_jacobian(type.shape, nodes, positions, orientation);
  if (!(straight > 0)) return std::nullopt;
  LeastValue least =
      polynomial->least(jacobian_coefficients(*polynomial, nodes, positions, orientation));
  least.value /= straight;
  return least;
}

}  // namespace roughmesh::detail
