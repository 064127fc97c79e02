// SPDX-License-Identifier: BSD-3-Clause
// The smallest vector that moves several planes by given heights.
#pragma once

#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The smallest u with n_k . u = z_k for all k in the sense of least squares, and m . u = 0
/// (docs/math.md, eq. 36). What depends on the normals only is computed once.
class LeastDisplacement {
 public:
  /// @param normals  n_k, of unit length
  /// @param across   m, of any size
  LeastDisplacement(std::span<const Vec3> normals, std::span<const Vec3> across);

  /// @param load     sum of z_k n_k
  /// @param largest  of |z_k|: u is at most three times as long
  Vec3 solve(const Vec3& load, double largest) const;

  /// The part of v that changes none of the products n_k . u and m . u.
  Vec3 free_part(const Vec3& v) const { return free_ * v; }
  /// What that leaves out: none to three directions, orthonormal.
  std::vector<Vec3> bound_directions() const;
  bool is_rigid() const { return free_.isZero(0); }  ///< there is none

 private:
  Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d free_ = Eigen::Matrix3d::Zero();
};

}  // namespace roughmesh::detail
