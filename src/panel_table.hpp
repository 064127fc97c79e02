// SPDX-License-Identifier: BSD-3-Clause
// A smooth function of up to three coordinates, as polynomials on panels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Interpolates at Chebyshev's nodes: on each cell of panels a product of polynomials of degree 11
/// in each coordinate. An axis without panels is one the function does not depend on.
class PanelTable {
 public:
  static constexpr std::size_t n_terms = 12;  ///< coefficients per panel of an axis
  using Ends = std::array<std::vector<double>, 3>;

  PanelTable() = default;

  /// @param ends  of the panels of each axis, ascending; empty for an axis without
  explicit PanelTable(Ends ends);

  /// Places along an axis at which values are needed; 0 for an axis without panels.
  std::vector<double> nodes(std::size_t axis) const;

  /// @param values     at all combinations of nodes, the last axis running fastest
  /// @param tolerance  what may be left out of a cell, for speed
  void set_values(std::vector<double> values, double tolerance);

  bool is_empty() const { return cells_.empty(); }

  /// Outside of the panels the nearest place inside counts.
  double operator()(const Vec3& x) const;

 private:
  using Polynomials = std::array<double, n_terms>;

  std::size_t n_panels(std::size_t axis) const {
    return ends_[axis].empty() ? 1 : ends_[axis].size() - 1;
  }
  std::size_t n_coefficients(std::size_t axis) const { return ends_[axis].empty() ? 1 : n_terms; }
  std::size_t n_nodes(std::size_t axis) const { return n_panels(axis) * n_coefficients(axis); }
  std::size_t locate(std::size_t axis, double x, Polynomials& polynomials) const;
  void transform_along(std::size_t axis, std::vector<double>& values) const;
  /// Coefficients of one cell, and how many along each axis are not negligible.
  struct Cell {
    std::size_t first = 0;
    std::array<std::size_t, 3> n{};
  };
  /// The numbers of polynomials along each axis.
  using Place = std::array<std::size_t, 3>;
  double coefficient(std::span<const double> values, const Place& cell, const Place& degrees) const;
  void add_cell(std::span<const double> values, const Place& place, double tolerance);

  Ends ends_;
  std::vector<Cell> cells_;           ///< the last axis running fastest
  std::vector<double> coefficients_;  ///< cell by cell, the last axis running fastest
};

}  // namespace roughmesh::detail
