// SPDX-License-Identifier: BSD-3-Clause
// Periodic autocorrelation: the sum over images.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "roughmesh/autocorrelation.hpp"
#include "roughmesh/distance.hpp"

#include "panel_table.hpp"

namespace roughmesh::detail {

/// @throws InputError  the sum over images along n_sums axes diverges, or is not positive definite
void require_image_sum(const Autocorrelation& autocorrelation, int n_sums);

/// rho_P(x) of docs/math.md, eq. 25, to 1e-12, in some tenths of a microsecond. The images of the
/// nearest cells (up to 27) are added one by one. What the others add has no singularity near, and
/// is tabulated: polynomials of degree 11 on panels, along each axis along which it varies.
class ImageSum {
 public:
  /// @param distance  of kind `periodic`
  /// @param extent    differences of points do not exceed it along the axes without a period
  /// @throws InputError  the sum diverges, or is not positive definite, or the periods differ by
  ///                     too much for the table
  ImageSum(const Autocorrelation& autocorrelation, const Distance& distance, const Vec3& extent);

  double rho(const Vec3& difference) const;

 private:
  /// In stretched coordinates S x, S being diagonal.
  struct Axis {
    int number = 0;      ///< 0 to 2, for x to z
    double stretch = 1;  ///< entry of S
    double period = 0;   ///< 0: not periodic
    double range = 0;    ///< largest |difference| after reduction to the cell
  };

  void set_axes(const Distance& distance, const Vec3& extent);
  PanelTable::Ends panels(double shortest_period) const;
  void fill_table(std::span<const GaussianTerm> terms);
  void add_term(const GaussianTerm& term, std::vector<double>& values) const;
  Vec3 reduced(const Vec3& difference) const;
  double near_images(const Vec3& x) const;
  double far_images(const Vec3& x) const { return far_.is_empty() ? 0 : far_(x); }

  Autocorrelation autocorrelation_;
  std::array<Axis, 3> axes_;  ///< those of range 0 first
  double negligible_distance_ = 0;
  double total_ = 1;  ///< sum over images at 0
  PanelTable far_;    ///< empty where far images are negligible
};

}  // namespace roughmesh::detail
