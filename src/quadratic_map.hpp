// SPDX-License-Identifier: BSD-3-Clause
// Elements of order 2 as polynomials of the coordinates of a reference element.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The reference element is a product of simplices, here one of them: its barycentric coordinates
/// are the variables `first` to `first + dimension`. Triangles and tetrahedra are one, quadrangles
/// and hexahedra products of two and three lines, prisms of a triangle and a line.
struct SimplexFactor {
  int first = 0;
  int dimension = 0;
};

inline constexpr std::size_t most_variables = 6;  ///< those of a hexahedron
inline constexpr std::size_t most_quadratic_nodes = 27;

/// Exponents of the variables in a monomial.
using Exponents = std::array<std::uint8_t, most_variables>;

/// Polynomials homogeneous in the variables of each factor, with these degrees.
std::vector<Exponents> monomials(const std::vector<SimplexFactor>& factors,
                                 const std::vector<int>& degrees);

double value(const Exponents& monomial, const std::array<double, most_variables>& variables);

/// Derivative of the map by one coordinate of the reference element: the sum over monomials of
/// their value times the row of `of_nodes` times the positions of the nodes.
struct MapDerivative {
  std::vector<int> degrees;  ///< in each factor
  std::vector<Exponents> monomials;
  Eigen::MatrixXd of_nodes;  ///< monomials by nodes of the element; most entries are 0
};

/// The map x = sum N_i x_i of a type of order 2, also with nodes on edges only.
struct QuadraticMap {
  std::vector<SimplexFactor> factors;
  std::vector<MapDerivative> derivatives;  ///< by each coordinate, orientation positive
  /// By nodes and corners: a node in the middle of corners as their mean.
  Eigen::MatrixXd straight;
};

/// Null for other orders, for points and lines, and for pyramids, whose functions are no
/// polynomials.
const QuadraticMap* quadratic_map(const ElementType& type);

}  // namespace roughmesh::detail
