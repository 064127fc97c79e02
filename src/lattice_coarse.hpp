// SPDX-License-Identifier: BSD-3-Clause
// The Gaussians that are smooth between many places, summed from coarse to fine.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/white_noise.hpp"

#include "lattice_level.hpp"
#include "lattice_space.hpp"
#include "tensor_product.hpp"

namespace roughmesh::detail {

/// Nodes of a cell along an axis, for an error of the covariance along it.
int polynomial_nodes(double error);

/// The sum of levels that are smooth in cells of their own scale. A level is known at the Chebyshev
/// nodes of such cells, and a polynomial between them. What a cell knows goes on to the cells of
/// half the edge in it, exactly, and from the smallest cells to the places: so that a place costs
/// the same for one level and for twenty (docs/math.md, eq. 49). Cells are absolute, so the field
/// is a function of the place.
class CoarseLevels {
 public:
  CoarseLevels() = default;

  /// @param levels     each with a scale of at least `cell`
  /// @param cell       edge of the smallest cells
  /// @param n_stages   sizes of cells at most: cell, 2 cell, ...
  /// @param error      of the covariance that the polynomials may add, for a variance of 1
  CoarseLevels(std::vector<LatticeLevel> levels, const LatticeSpace& space, double cell,
               int n_stages, double error);

  bool empty() const { return levels_.empty(); }
  std::span<const LatticeLevel> levels() const { return levels_; }

  /// @param heights  of the places, in their order before sorting
  void add(const NoiseStream& stream, const SortedPlaces& places, std::span<double> heights) const;

  /// Covariance that add() gives two places.
  double covariance(const Vec3& x, const Vec3& y) const;

 private:
  using Cell = std::array<double, 3>;  ///< its lower corner
  using Values = std::vector<double>;  ///< at the nodes of a cell

  class Descent;

  double edge(int stage) const { return cell_ * static_cast<double>(std::int64_t{1} << stage); }
  Cell cell_of(const Vec3& place, int stage) const;
  int n_nodes(std::size_t axis) const { return varies_[axis] ? n_nodes_ : 1; }
  std::size_t n_values() const;
  SmallMatrix kernel_rows(const LatticeAxis& axis, double corner, double edge,
                          std::int64_t& first) const;
  void add_level_to(const LatticeLevel& level, const NoiseStream& stream, const Cell& corner,
                    double edge, Values& values) const;
  NodeWeights interpolation(double position) const;
  AxisRow row(const LatticeLevel& level, int stage, std::size_t axis, double x) const;

  std::vector<LatticeLevel> levels_;
  std::vector<int> stage_of_level_;
  int n_stages_ = 0;
  double cell_ = 1;
  int n_nodes_ = 1;
  std::array<bool, 3> varies_{};
  std::vector<double> nodes_;          ///< on [0, 1]
  std::vector<double> node_factors_;   ///< 1 / product of differences to the other nodes
  std::array<SmallMatrix, 2> halves_;  ///< values at the nodes of the lower and the upper half
};

}  // namespace roughmesh::detail
