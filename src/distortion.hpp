// SPDX-License-Identifier: BSD-3-Clause
// How far simplices are from their rest shape, also where they are inverted.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

struct Determinants {
  double smallest = std::numeric_limits<double>::infinity();  ///< NaN if one is
  std::int64_t n_negative = 0;                                ///< or zero
};

/// Sum over simplices of h e(J) (docs/math.md, eq. 50 and 51): J maps the rest shape to the current
/// one, e is 0 for rotations and finite for any J. Positions have `space` coordinates: triangles in
/// a plane (2), tetrahedra (3), and triangles in space (dim 2, space 3), each seen along the normal
/// of its rest shape (eq. 68). A function of the positions of the free nodes, one after the other.
template <int dim, int space = dim>
class Distortion {
 public:
  using Point = Eigen::Matrix<double, space, 1>;
  using Matrix = Eigen::Matrix<double, dim, dim>;
  using Frame = Eigen::Matrix<double, dim, space>;
  using Corners = std::array<Index, dim + 1>;  ///< positions in the array of points

  /// @param rest    of each simplex the edges from its first corner to the others, one a column;
  ///                none is flat
  /// @param points  the first n_free of them are free, all others stay here
  /// @param frames  orthonormal rows: the axes in which each simplex is seen; empty where all
  ///                coordinates count
  Distortion(std::span<const Matrix> rest, std::vector<Corners> simplices,
             std::vector<Point> points, Index n_free, std::vector<Frame> frames = {});

  /// The larger, the less it costs to be inverted. Starts at 1.
  void set_epsilon(double epsilon) { epsilon_ = epsilon; }

  /// The same bits on any number of threads.
  double operator()(const Eigen::VectorXd& free_points, Eigen::VectorXd& gradient);
  /// Of J, over all simplices.
  Determinants determinants(const Eigen::VectorXd& free_points);
  Eigen::VectorXd free_points() const;

 private:
  Matrix jacobian(std::size_t simplex) const;
  double add_simplex(std::size_t simplex);
  void place(const Eigen::VectorXd& free_points);
  void index_slots();

  std::vector<Point> points_;
  std::vector<Corners> simplices_;
  std::vector<Matrix> inverse_rest_;
  std::vector<Frame> frames_;
  std::vector<double> weights_;
  Index n_free_ = 0;
  double epsilon_ = 1;
  // Each simplex writes its share of the gradient to slots of its own; those of a node are
  // neighbours, in the order of the simplices, and are added up in that order.
  std::vector<Corners> slot_of_corner_;  // -1 for a node that stays
  std::vector<std::size_t> first_slot_;  // of each free node
  std::vector<Point> slots_;
};

extern template class Distortion<2>;
extern template class Distortion<2, 3>;
extern template class Distortion<3>;

}  // namespace roughmesh::detail
