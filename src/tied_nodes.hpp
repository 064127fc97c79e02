// SPDX-License-Identifier: BSD-3-Clause
// Nodes that slide along walls or move alike: their coordinates are functions of fewer numbers.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "roughmesh/displace.hpp"

namespace roughmesh::detail {

/// What the free nodes of a mesh cannot do; as in Walls.
struct NodeTies {
  std::vector<SlidingNode> sliding = {};  ///< ascending; normals of one node orthonormal
  std::vector<Index> images = {};         ///< empty: every node for itself

  Index image(Index node) const {
    return node < static_cast<Index>(images.size()) ? images[node] : node;
  }
  /// Normals of the planes that the node slides in, none to three.
  std::span<const SlidingNode> of(Index node) const;
  bool is_tied(Index node) const { return image(node) != node || !of(node).empty(); }
};

/// Shifts of nodes as x = B (q - q_0) (docs/math.md, eq. 58 and 59), in `dim` coordinates each.
template <int dim>
class TiedPoints {
 public:
  /// @param nodes  of the mesh; where one moves, all that move alike are among them
  /// @param axes   orthonormal rows, the axes of the coordinates
  /// @param start  coordinates of the nodes, one after the other
  TiedPoints(const NodeTies& ties, std::span<const Index> nodes,
             const Eigen::Matrix<double, dim, 3>& axes, const Eigen::VectorXd& start);

  const Eigen::VectorXd& start() const { return start_; }  ///< q_0, where no shift is
  Eigen::VectorXd shifts(const Eigen::VectorXd& q) const;
  /// Derivatives by q from those by the coordinates.
  Eigen::VectorXd reduced(const Eigen::VectorXd& gradient) const;

 private:
  using Basis = Eigen::Matrix<double, dim, Eigen::Dynamic, 0, dim, dim>;

  static Basis free_directions(std::span<const SlidingNode> normals,
                               const Eigen::Matrix<double, dim, 3>& axes);

  std::vector<Index> class_of_node_;
  std::vector<Basis> bases_;            // of each class
  std::vector<Eigen::Index> first_{0};  // number of each class in q
  Eigen::VectorXd start_;
};

extern template class TiedPoints<2>;
extern template class TiedPoints<3>;

}  // namespace roughmesh::detail
