// SPDX-License-Identifier: BSD-3-Clause
#include "least_displacement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace roughmesh::detail {
namespace {

// Singular values below this share of the largest are cut.
constexpr double least_share = 0.2;
// Longest displacement over the largest height.
constexpr double most_gain = 3;

using Modes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

// Calls visit(square of the singular value, mode) for those of the rows that are kept.
template <class Visit>
void for_each_mode(const Eigen::Matrix3d& squares, double scale, Visit&& visit) {
  const Modes modes(squares);
  const double largest = std::max(scale, modes.eigenvalues()[2]);
  for (int k = 0; k < 3; ++k)
    if (modes.eigenvalues()[k] >= least_share * least_share * largest)
      visit(modes.eigenvalues()[k], Vec3(modes.eigenvectors().col(k)));
}

Eigen::Matrix3d squares_of(std::span<const Vec3> rows) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Vec3& row : rows) squares += row * row.transpose();
  return squares;
}

}  // namespace

LeastDisplacement::LeastDisplacement(std::span<const Vec3> normals, std::span<const Vec3> across) {
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
  for (const Vec3& m : across) directions += squares_of(std::array{Vec3(m.normalized())});
  // What the planes leave; of unit normals at least one square is 1 or more.
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
  for_each_mode(directions, 1, [&](double, const Vec3& mode) { left -= mode * mode.transpose(); });
  long n_kept = 3 - std::lround(left.trace());
  free_ = left;
  for_each_mode(left * squares_of(normals) * left, 1, [&](double square, const Vec3& mode) {
    inverse_ += mode * mode.transpose() / square;
    free_ -= mode * mode.transpose();
    ++n_kept;
  });
  inverse_ = inverse_ * left;
  if (n_kept >= 3) free_.setZero();  // of round-off
}

Vec3 LeastDisplacement::solve(const Vec3& load, double largest) const {
  const Vec3 u = inverse_ * load;
  const double length = u.norm(), most = most_gain * largest;
  return length > most ? Vec3(most / length * u) : u;
}

std::vector<Vec3> LeastDisplacement::bound_directions() const {
  const Modes modes(Eigen::Matrix3d::Identity() - free_);
  std::vector<Vec3> directions;
  for (int k = 0; k < 3; ++k)
    if (modes.eigenvalues()[k] > 0.5) directions.emplace_back(modes.eigenvectors().col(k));
  return directions;
}

}  // namespace roughmesh::detail
