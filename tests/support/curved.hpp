// SPDX-License-Identifier: BSD-3-Clause
// Elements of order 2 by the shape functions of textbooks, and their Jacobian determinants.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "cells.hpp"
#include "second_order.hpp"

namespace roughmesh::test {

inline constexpr std::array<ElementType, 8> curved_types = {{{ElementShape::triangle, 2, 6},
                                                             {ElementShape::quadrangle, 2, 8},
                                                             {ElementShape::quadrangle, 2, 9},
                                                             {ElementShape::tetrahedron, 2, 10},
                                                             {ElementShape::hexahedron, 2, 20},
                                                             {ElementShape::hexahedron, 2, 27},
                                                             {ElementShape::prism, 2, 15},
                                                             {ElementShape::prism, 2, 18}}};

/// A straight element of order 2 on the corners of the ideal one.
inline Mesh single_curved(const ElementType& type) {
  const Mesh serendipity =
      second_order(single_element(type.shape, ideal_corners(type.shape)), false);
  if (serendipity.blocks[0].type == type) return serendipity;
  return second_order(single_element(type.shape, ideal_corners(type.shape)), true);
}

/// Where the nodes are in the reference element: coordinates r, s, t from 0 with edges of length 1.
inline std::vector<Vec3> reference_nodes(const ElementType& type) {
  Mesh mesh = single_element(type.shape, ideal_corners(type.shape));
  switch (type.shape) {
    case ElementShape::triangle:
      mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      break;
    case ElementShape::tetrahedron:
      mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      break;
    case ElementShape::prism:
      mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
      break;
    default:
      break;  // those of ideal corners
  }
  const Mesh serendipity = second_order(mesh, false);
  return serendipity.blocks[0].type == type ? serendipity.nodes : second_order(mesh, true).nodes;
}

/// Shape function of the node at `a`: of a simplex l (2 l - 1) at corners and 4 l m on edges, of
/// lines Lagrange's; of serendipity elements those of Zienkiewicz.
inline double shape_function(const ElementType& type, const Vec3& a, const Vec3& x) {
  const bool is_prism = type.shape == ElementShape::prism;
  const bool is_simplex =
      type.shape == ElementShape::triangle || type.shape == ElementShape::tetrahedron;
  const auto simplex = [&](int dim) {
    std::array<double, 4> at{1, 0, 0, 0}, l{1, 0, 0, 0};
    for (int k = 0; k < dim; ++k) {
      at[k + 1] = a[k], l[k + 1] = x[k];
      at[0] -= a[k], l[0] -= x[k];
    }
    double product = 1;
    for (int k = 0; k <= dim; ++k) {
      if (at[k] == 1) return l[k] * (2 * l[k] - 1);
      if (at[k] == 0.5) product *= 2 * l[k];
    }
    return product;
  };
  const auto line = [&](int k) {  // Lagrange, nodes at 0, 1/2 and 1
    const double s = x[k];
    if (a[k] == 0.5) return 4 * s * (1 - s);
    return a[k] == 0 ? (1 - s) * (1 - 2 * s) : s * (2 * s - 1);
  };
  const auto linear = [&](int k) { return a[k] == 0 ? 1 - x[k] : x[k]; };
  const auto bubble = [&](int k) { return 4 * x[k] * (1 - x[k]); };
  if (is_simplex) return simplex(dimension(type.shape));
  if (is_prism && type.n_nodes == 18) return simplex(2) * line(2);
  if (is_prism) {
    const std::array<double, 3> at{1 - a[0] - a[1], a[0], a[1]}, l{1 - x[0] - x[1], x[0], x[1]};
    if (a[2] == 0.5) {
      for (int k = 0; k < 3; ++k)
        if (at[k] == 1) return l[k] * bubble(2);
    }
    for (int k = 0; k < 3; ++k)
      if (at[k] == 1) return l[k] * (2 * l[k] - 1) * linear(2) - l[k] * bubble(2) / 2;
    return simplex(2) * linear(2);
  }
  const int dim = dimension(type.shape);
  double product = 1;
  if (type.n_nodes == 9 || type.n_nodes == 27) {
    for (int k = 0; k < dim; ++k) product *= line(k);
    return product;
  }
  // xi xi_k in [-1, 1]: (1 + xi xi_k) / 2 is the linear function, the sum of xi xi_k is 2 sum -
  // dim.
  double sum = 0;
  bool is_corner = true;
  for (int k = 0; k < dim; ++k) {
    if (a[k] == 0.5) {
      product *= bubble(k);
      is_corner = false;
    } else {
      product *= linear(k);
      sum += 2 * linear(k) - 1;
    }
  }
  return is_corner ? product * (sum - (dim - 1)) : product;
}

/// det of the derivatives of sum N_i x_i; central differences are exact for quadratic functions.
inline double determinant_at(const ElementType& type, const std::vector<Vec3>& nodes,
                             const Vec3& x) {
  const std::vector<Vec3> reference = reference_nodes(type);
  const auto map = [&](const Vec3& at) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sum += shape_function(type, reference[i], at) * nodes[i];
    return sum;
  };
  Eigen::Matrix3d d = Eigen::Matrix3d::Identity();
  constexpr double step = 0.25;
  for (int k = 0; k < dimension(type.shape); ++k)
    d.col(k) = (map(x + step * Vec3::Unit(k)) - map(x - step * Vec3::Unit(k))) / (2 * step);
  return d.determinant();
}

/// Points of a grid of n steps over the reference element, with its border.
inline std::vector<Vec3> reference_grid(ElementShape shape, int n) {
  std::vector<Vec3> points;
  const int last = dimension(shape) == 3 ? n : 0;
  for (int k = 0; k <= last; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const bool in_triangle = i + j <= n;
        if (shape == ElementShape::tetrahedron && i + j + k > n) continue;
        if ((shape == ElementShape::triangle || shape == ElementShape::prism) && !in_triangle)
          continue;
        points.push_back(Vec3(i, j, k) / n);
      }
  return points;
}

/// The straight element with every node moved by up to `size` along each axis (of its plane).
inline std::vector<Vec3> disturbed(const ElementType& type, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vec3> nodes = single_curved(type).nodes;
  for (Vec3& x : nodes)
    x += Vec3(uniform(random), uniform(random), dimension(type.shape) == 3 ? uniform(random) : 0);
  return nodes;
}

}  // namespace roughmesh::test
