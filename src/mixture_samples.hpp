// SPDX-License-Identifier: BSD-3-Clause
// Where a Gaussian mixture is held against rho.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "roughmesh/autocorrelation.hpp"

#include "mixture_space.hpp"

namespace roughmesh::detail {

/// rho, or rho_P of docs/math.md, eq. 25, by the quadrature of eq. 26.
class MixtureTarget {
 public:
  /// @param nearest  no displacement is shorter, but for 0; > 0
  /// @throws InputError  the sum over images diverges
  MixtureTarget(const Autocorrelation& autocorrelation, const MixtureSpace& space, double nearest);

  double operator()(const MixtureSpace::Coordinates& x) const;

  /// Where rho falls to `level` along the axis without period, to 5 %, or the longest distance
  /// that a mixture is fitted to: 1e12 correlation lengths. `nearest` if there is no such axis.
  double reach(double level) const;

  const Autocorrelation& autocorrelation() const { return autocorrelation_; }
  const MixtureSpace& space() const { return space_; }
  double nearest() const { return nearest_; }
  const std::vector<GaussianTerm>& shares() const { return shares_; }  ///< empty without periods

 private:
  Autocorrelation autocorrelation_;
  MixtureSpace space_;
  double nearest_;
  std::vector<GaussianTerm> shares_;
};

/// Displacements from target.nearest() to where rho is negligible: along each axis, and a grid over
/// all axes where there are several.
class MixtureSamples {
 public:
  struct Density {
    int on_axes = 0;  ///< samples per octave along each axis
    int of_grid = 0;  ///< coordinates per octave
  };

  /// @param reach  rho is negligible beyond; >= target.nearest()
  MixtureSamples(const MixtureTarget& target, double reach, const Density& density);

  Eigen::VectorXd gaussian(double scale) const;              ///< 1 at 0
  const Eigen::VectorXd& target() const { return target_; }  ///< rho

 private:
  using Places = std::array<std::size_t, MixtureSpace::most_axes>;

  std::size_t add(std::size_t axis, double coordinate);
  void add_axis(std::size_t axis, int per_octave);
  std::vector<std::size_t> grid_places(std::size_t axis, int per_octave);
  void add_grid(int per_octave);
  void add_far(const Places& sample);
  void add_corner();
  double end(std::size_t axis) const;
  MixtureSpace::Coordinates at(const Places& sample) const;
  Eigen::VectorXd values(const MixtureTarget& target) const;

  MixtureSpace space_;
  double nearest_, reach_;
  std::array<std::vector<double>, MixtureSpace::most_axes> coordinates_;  ///< used on each axis
  std::vector<Places> samples_;                                           ///< among them
  Eigen::VectorXd target_;
};

}  // namespace roughmesh::detail
