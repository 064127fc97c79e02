// SPDX-License-Identifier: BSD-3-Clause
// How far an element of order 2 is from being inverted somewhere.
#pragma once

#include <optional>
#include <span>

#include "bernstein.hpp"

namespace roughmesh::detail {

/// On which side an element is not inverted.
struct ElementOrientation {
  double sign = 1;              ///< of the determinants of a volume element
  Vec3 normal = Vec3::UnitZ();  ///< about which a face runs counter-clockwise
};

/// Least determinant at the corners of the element with straight edges, d! times the volume of a
/// simplex; positive if the corners are right.
double straight_jacobian(ElementShape shape, std::span<const Index> nodes,
                         std::span<const Vec3> positions, const ElementOrientation& orientation);

/// Bernstein coefficients of the determinant of an element of order 2, signs as above.
std::vector<double> jacobian_coefficients(const JacobianPolynomial& polynomial,
                                          std::span<const Index> nodes,
                                          std::span<const Vec3> positions,
                                          const ElementOrientation& orientation);

/// Least determinant over straight_jacobian (docs/math.md, eq. 61): 1 for
/// straight simplices and quadrangles. Nothing where quadratic_map has none, or the corners are
/// wrong.
std::optional<LeastValue> curved_quality(const ElementType& type, std::span<const Index> nodes,
                                         std::span<const Vec3> positions,
                                         const ElementOrientation& orientation);

}  // namespace roughmesh::detail
