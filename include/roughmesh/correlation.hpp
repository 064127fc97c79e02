// SPDX-License-Identifier: BSD-3-Clause
// The correlation between the points of a surface, as one value.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"
#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh {

namespace detail {
class ImageSum;
}

/// R_ij of n points (docs/math.md, eq. 1): an autocorrelation function, a distance, and the place
/// where each point stands for that distance: its position; along a curve, what curve_places()
/// gives. Symmetric, R_ii = 1. Cheap to copy.
class Correlation {
 public:
  /// @param places  n of them, in the order of the points
  /// @throws InputError  a place that is not finite; periodic distance with an autocorrelation
  ///                     whose sum over images does not exist or is not positive definite
  ///                     (`rational-quadratic` with 2a at most the number of periodic axes, a
  ///                     `table` without fit); curve places that belong to no piece
  Correlation(std::vector<Vec3> places, const Autocorrelation& autocorrelation,
              const Distance& distance);

  /// rho(distance of places i and j); periodic: the sum over images of docs/math.md, eq. 25, to
  /// 1e-12. Points are not checked.
  double operator()(Index i, Index j) const {
    const Vec3 &x = places_[static_cast<std::size_t>(i)], &y = places_[static_cast<std::size_t>(j)];
    if (images_) return image_sum(x, y);
    return autocorrelation_.rho(distance_(x, y));
  }

  Index n_points() const { return static_cast<Index>(places_.size()); }
  const Autocorrelation& autocorrelation() const { return autocorrelation_; }
  const Distance& distance() const { return distance_; }
  std::span<const Vec3> places() const { return places_; }  ///< valid as long as a copy lives

  /// The correlation of these points alone, in the order given.
  /// @throws InputError  no such point
  Correlation among(std::span<const Index> points) const;

  /// Periodic distance: largest difference of R_ij to rho of the nearest image alone, over the
  /// pairs of up to 256 points with up to 2,048, both spread evenly over all (every pair of up to
  /// 256 points). Absent for other distances.
  std::optional<double> minimum_image_difference() const;

 private:
  double image_sum(const Vec3& x, const Vec3& y) const;

  std::shared_ptr<const std::vector<Vec3>> owned_places_;
  std::span<const Vec3> places_;  ///< of owned_places_
  Autocorrelation autocorrelation_;
  Distance distance_;
  std::shared_ptr<const detail::ImageSum> images_;  ///< of periodic distance, else null
};

}  // namespace roughmesh
