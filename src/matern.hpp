// SPDX-License-Identifier: BSD-3-Clause
// The Matern function (docs/math.md, eq. 6) for any smoothness.
#pragma once

#include <array>
#include <vector>

namespace roughmesh::detail {

/// log rho(x), x = r / l >= 0, to a relative error of rho of 1e-13, for any nu > 0. Takes
/// microseconds.
double log_matern(double nu, double x);

/// rho(x) for nu = 1/2, 3/2 or 5/2, where it is an exponential times a polynomial.
double matern_half_integer(double nu, double x);
bool is_half_integer_matern(double nu);

/// rho for one nu in some 20 nanoseconds: polynomials of -log rho on quarters of binades. The
/// logarithm keeps rho positive, and accurate relative to itself, down to where it underflows.
class MaternTable {
 public:
  explicit MaternTable(double nu);

  double rho(double x) const;  ///< x = r / l >= 0; 0 where rho underflows

 private:
  static constexpr int n_coefficients = 12;
  struct Segment {
    double centre = 0;
    double inverse_half_width = 0;
    std::array<double, n_coefficients> coefficients{};  ///< of powers of the local coordinate
  };

  double nu_;
  double scale_;  ///< of the argument: for nu < 1 that of the Bessel function
  std::vector<Segment> segments_;
};

}  // namespace roughmesh::detail
