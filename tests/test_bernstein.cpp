// SPDX-License-Identifier: BSD-3-Clause
// Determinants of curved elements in Bernstein form, against shape functions of textbooks.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "bernstein.hpp"
#include "support/curved.hpp"

using namespace roughmesh;

namespace {

using detail::JacobianPolynomial;

std::vector<double> coefficients(const ElementType& type, const std::vector<Vec3>& nodes) {
  return JacobianPolynomial::of(type)->coefficients(nodes, Vec3::UnitZ());
}

detail::LeastValue least(const ElementType& type, const std::vector<Vec3>& nodes) {
  return JacobianPolynomial::of(type)->least(coefficients(type, nodes));
}

/// Barycentric coordinates of the simplices whose product the reference element is.
std::vector<std::vector<double>> barycentric(ElementShape shape, const Vec3& x) {
  const auto line = [&](int k) { return std::vector{1 - x[k], x[k]}; };
  switch (shape) {
    case ElementShape::triangle:
      return {{1 - x[0] - x[1], x[0], x[1]}};
    case ElementShape::tetrahedron:
      return {{1 - x[0] - x[1] - x[2], x[0], x[1], x[2]}};
    case ElementShape::quadrangle:
      return {line(0), line(1)};
    case ElementShape::hexahedron:
      return {line(0), line(1), line(2)};
    default:
      return {{1 - x[0] - x[1], x[0], x[1]}, line(2)};
  }
}

double bernstein_sum(const ElementType& type, const std::vector<double>& coefficients,
                     const Vec3& x) {
  const auto factors = barycentric(type.shape, x);
  double total = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    double term = coefficients[k];
    std::size_t v = 0;
    for (const auto& factor : factors) {
      int n = 0;
      for (const double l : factor) {
        const int e = JacobianPolynomial::of(type)->exponents()[k][v++];
        n += e;
        term *= std::pow(l, e) / std::tgamma(e + 1);
      }
      term *= std::tgamma(n + 1);
    }
    total += term;
  }
  return total;
}

double least_on_grid(const ElementType& type, const std::vector<Vec3>& nodes, int n) {
  double result = std::numeric_limits<double>::infinity();
  for (const Vec3& x : test::reference_grid(type.shape, n))
    result = std::min(result, test::determinant_at(type, nodes, x));
  return result;
}

}  // namespace

TEST(Bernstein, AffineElementsHaveEqualCoefficients) {
  Eigen::Matrix3d map;
  map << 2, 0.5, 0, 0.3, 1.5, 0, 0, 0, 0.7;
  Eigen::Matrix3d skew = map;
  skew(2, 0) = 0.4;
  skew(1, 2) = -0.6;
  for (const ElementType& type : test::curved_types) {
    const bool is_volume = dimension(type.shape) == 3;
    std::vector<Vec3> nodes = test::reference_nodes(type);
    for (Vec3& x : nodes) x = (is_volume ? skew : map) * x + Vec3(3, -2, is_volume ? 5 : 0);
    const double expected =
        is_volume ? skew.determinant() : map.topLeftCorner<2, 2>().determinant();
    for (const double c : coefficients(type, nodes))
      EXPECT_NEAR(c, expected, 1e-12) << name(type) << " " << type.n_nodes;
  }
}

// As many coefficients as the degrees of the determinant allow, and the same polynomial.
TEST(Bernstein, TheSumIsTheDeterminant) {
  std::mt19937 random(1);
  for (const ElementType& type : test::curved_types) {
    const std::vector<Vec3> nodes = test::disturbed(type, 0.3, random);
    const std::vector<double> c = coefficients(type, nodes);
    for (const Vec3& x : test::reference_grid(type.shape, 4))
      EXPECT_NEAR(bernstein_sum(type, c, x), test::determinant_at(type, nodes, x), 1e-12)
          << name(type) << " " << type.n_nodes;
  }
  const auto n = [](ElementShape shape, int nodes) {
    return JacobianPolynomial::of({shape, 2, nodes})->exponents().size();
  };
  EXPECT_EQ(n(ElementShape::triangle, 6), 6U);
  EXPECT_EQ(n(ElementShape::tetrahedron, 10), 20U);
  EXPECT_EQ(n(ElementShape::quadrangle, 8), 16U);
  EXPECT_EQ(n(ElementShape::hexahedron, 27), 216U);
  EXPECT_EQ(n(ElementShape::prism, 15), 90U);
}

// A node on an edge that moves along it: the edge folds where it passes the quarter point. At it
// the determinant is 0 at the end.
TEST(Bernstein, AnEdgeFoldsAtTheQuarterPoint) {
  for (const ElementType& type : test::curved_types) {
    const Mesh mesh = test::single_curved(type);
    const auto edges = local_edges(type.shape);
    for (std::size_t k = 0; k < edges.size(); ++k)
      for (const double share : {0.2, 0.249, 0.251, 0.5, 0.749, 0.751, 0.9}) {
        std::vector<Vec3> nodes = mesh.nodes;
        const Vec3 &a = nodes[edges[k][0]], &b = nodes[edges[k][1]];
        nodes[n_corners(type.shape) + static_cast<int>(k)] = a + share * (b - a);
        EXPECT_EQ(least(type, nodes).is_positive, share > 0.25 && share < 0.75)
            << name(type) << " " << type.n_nodes << " edge " << k << " at " << share;
      }
  }
  std::vector<Vec3> nodes = test::reference_nodes({ElementShape::triangle, 2, 6});
  nodes[3] = Vec3(0.25, 0, 0);
  EXPECT_FALSE(least({ElementShape::triangle, 2, 6}, nodes).is_positive);
  EXPECT_EQ(least({ElementShape::triangle, 2, 6}, nodes).value, 0);
}

// A bound is below all values; what is refuted is so by a value. Elements of every kind appear,
// also those whose first coefficients prove nothing.
TEST(Bernstein, AgreesWithValuesOnAGrid) {
  std::mt19937 random(2);
  for (const ElementType& type : test::curved_types) {
    const bool is_small = dimension(type.shape) == 2 || type.shape == ElementShape::tetrahedron;
    int n_valid = 0, n_halved = 0, n_invalid = 0;
    for (int i = 0; i < (is_small ? 400 : 60); ++i) {
      const std::vector<Vec3> nodes = test::disturbed(type, i % 2 == 0 ? 0.13 : 0.18, random);
      const std::vector<double> c = coefficients(type, nodes);
      const detail::LeastValue found = least(type, nodes);
      const double on_grid = least_on_grid(type, nodes, is_small ? 20 : 8);
      if (found.is_positive) {
        ++n_valid;
        n_halved += *std::min_element(c.begin(), c.end()) <= 0;
        EXPECT_GT(found.value, 0);
        EXPECT_LE(found.value, on_grid + 1e-14);
      } else {
        ++n_invalid;
        EXPECT_LE(found.value, 0);
        // A grid of 20 steps misses little of what is negative.
        if (is_small) {
          EXPECT_LT(on_grid, 0.02);
        }
      }
    }
    EXPECT_GT(n_valid, 5) << name(type) << " " << type.n_nodes;
    EXPECT_GT(n_halved, 0) << name(type) << " " << type.n_nodes;
    EXPECT_GT(n_invalid, 5) << name(type) << " " << type.n_nodes;
  }
}

// Zero inside only: no sum of pieces proves or refutes it, and the work is bounded.
TEST(Bernstein, UndecidedIsNotProven) {
  const JacobianPolynomial& square = *JacobianPolynomial::of({ElementShape::triangle, 2, 6});
  // (lambda_0 - lambda_1 / pi)^2
  std::vector<double> c;
  const double t = 1 / std::numbers::pi;
  for (const auto& e : square.exponents())
    c.push_back(e[0] == 2 ? 1 : e[1] == 2 ? t * t : e[0] + e[1] == 2 ? -t : 0);
  EXPECT_FALSE(square.least(c).is_positive);
  for (double& each : c) each += 0.01;
  EXPECT_TRUE(square.least(c).is_positive);
  EXPECT_LE(square.least(c).value, 0.01);
}

TEST(Bernstein, OtherElementsHaveNone) {
  for (const ElementType& type :
       {ElementType{ElementShape::pyramid, 2, 13}, ElementType{ElementShape::pyramid, 2, 14},
        ElementType{ElementShape::tetrahedron, 1, 4}, ElementType{ElementShape::tetrahedron, 3, 20},
        ElementType{ElementShape::line, 2, 3}})
    EXPECT_EQ(JacobianPolynomial::of(type), nullptr);
}
