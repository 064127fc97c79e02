// SPDX-License-Identifier: BSD-3-Clause
// Jacobian determinants of elements of order 2: a proof that they are positive everywhere.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "quadratic_map.hpp"

namespace roughmesh::detail {

/// The least value of a polynomial over the element.
struct LeastValue {
  /// Where positive a lower bound, nearly always within a tenth; else a value that is reached, or
  /// 0.
  double value = 0;
  bool is_positive = false;  ///< proven
};

/// The determinant of the derivatives of the map of a type of order 2 as polynomial in Bernstein
/// form (docs/math.md, eq. 60), with the reference simplex of edges of length 1, or cube: for an
/// affine element all coefficients are d! times its volume.
/// Source: A. Johnen, J.-F. Remacle, C. Geuzaine (2013), doi:10.1016/j.jcp.2012.08.051.
class JacobianPolynomial {
 public:
  explicit JacobianPolynomial(const QuadraticMap& map);

  /// Null where quadratic_map is.
  static const JacobianPolynomial* of(const ElementType& type);

  /// Of the Bernstein polynomials, in the order of the coefficients: n!/(e! ...) lambda^e, for
  /// products of simplices the product of these.
  const std::vector<Exponents>& exponents() const { return exponents_; }

  /// @param nodes   positions of the nodes of the element, in its order
  /// @param normal  of the plane of a triangle or quadrangle, where determinants of elements that
  ///                run counter-clockwise about it are positive; volumes have no use for it
  /// @return        one per exponents(); their
  ///                smallest is a lower bound of the determinant
  std::vector<double> coefficients(std::span<const Vec3> nodes, const Vec3& normal) const;

  /// Coefficients at corners are values: they refute. Else halves are looked at, until all
  /// coefficients of each are positive or one at a corner is not, at most `most_pieces` of them;
  /// what is undecided then counts as not positive. The first `most_for_precision` pieces are
  /// halved as well where the bound is more than a tenth below a value that is reached.
  LeastValue least(std::vector<double> coefficients) const;

  static constexpr int most_pieces = 1000;
  static constexpr int most_for_precision = 60;

  /// Values of the polynomial at the points e / n of its exponents, each factor by its degree:
  /// corners, and an even grid between them.
  std::vector<double> values(std::span<const double> coefficients) const;

 private:
  // Vertices of the simplices by variable.
  struct Piece {
    std::vector<double> coefficients;
    std::array<Vec3, most_variables> vertices;
  };
  std::pair<Piece, Piece> halves(const Piece& piece) const;
  // An entry of MapDerivative::of_nodes.
  struct Term {
    std::size_t monomial = 0, node = 0;
    double weight = 0;
  };
  static std::vector<Term> terms_of(const MapDerivative& derivative);
  std::vector<double> half(std::span<const double> coefficients, int kept, int moved) const;
  double least_at_corners(std::span<const double> coefficients) const;

  const QuadraticMap& map_;
  std::vector<std::vector<Term>> terms_;      // of each derivative
  std::vector<Exponents> exponents_;          // of the determinant
  std::map<Exponents, std::size_t> index_;    // in exponents_
  std::vector<double> inverse_multinomials_;  // monomial -> Bernstein
  std::vector<std::size_t> corners_;
  Eigen::MatrixXd values_;               // by points and coefficients
  std::size_t n_minors_ = 0;             // monomials of the product of the last two derivatives
  std::vector<std::size_t> minor_of_;    // by monomials of these two
  std::vector<std::size_t> product_of_;  // by monomials of the first derivative and minors
};

}  // namespace roughmesh::detail
