// SPDX-License-Identifier: BSD-3-Clause
// Autocorrelation functions rho(r), as values.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/error.hpp"

namespace roughmesh {

namespace detail {
class MaternTable;
}

enum class Family { gaussian, exponential, matern, self_affine, stretched, rational_quadratic };

/// What a given length means; all but `formula` are converted to the parameter of the formula.
enum class LengthDefinition {
  formula,     ///< the parameter l of docs/math.md, eq. 4 to 9
  one_over_e,  ///< distance at which rho = 1/e
  integral,    ///< integral of rho over r from 0 to infinity
  sal          ///< distance at which rho = 0.2 (Sal of ISO 25178-2)
};

std::string_view name(Family family);                ///< as on the command line: "self-affine"
std::string_view name(LengthDefinition definition);  ///< "one-over-e"

struct AutocorrelationOptions {
  Family family = Family::gaussian;
  /// Correlation length, > 0, in the length unit of the mesh.
  std::optional<double> length = {};
  LengthDefinition length_definition = LengthDefinition::formula;
  std::optional<double> nu = {};       ///< smoothness of `matern`, > 0
  std::optional<double> hurst = {};    ///< Hurst exponent of `self_affine`, in (0, 1)
  std::optional<double> rolloff = {};  ///< roll-off wavelength of it, > 0; instead of `length`
  std::optional<double> power = {};    ///< p of `stretched`, in (0, 2]
  std::optional<double> alpha = {};    ///< a of `rational_quadratic`, > 0
};

/// The same decay in each convention of the field; absent where it does not exist.
struct EquivalentLengths {
  double formula = 0;
  double one_over_e = 0;
  std::optional<double> integral;
  double sal = 0;
};

/// rho(r): normalized (rho(0) = 1), isotropic, positive definite in every dimension up to 3.
/// Formulas and sources: docs/math.md, eq. 4 to 9. Cheap to copy.
class Autocorrelation {
 public:
  /// @throws InputError  a parameter that is missing, foreign to the family, not finite or out of
  ///                     range; both or none of length and rolloff; a length definition that
  ///                     does not exist for the family
  explicit Autocorrelation(const AutocorrelationOptions& options);

  double rho(double r) const;  ///< r >= 0, a length; continuous, in (0, 1], 0 where it underflows
  Family family() const { return family_; }
  double length() const { return length_; }  ///< l of the formula
  EquivalentLengths equivalent_lengths() const;

  /// Share of the variance carried by wavenumbers above q (rad per length) in the plane (dimension
  /// 2) or along a line (dimension 1), in [0, 1]: docs/math.md, eq. 14.
  double spectrum_share_above(double q, int dimension) const;

  /// -rho''(0) where rho is twice differentiable there (the field has slopes), else nothing.
  /// 1/length^2.
  std::optional<double> slope_variance() const;

  /// Works that the family rests on, for the report: authors, year, title, DOI.
  std::vector<std::string> citations() const;

 private:
  Family family_;
  double length_ = 0;
  double shape_ = 0;  ///< nu, H, p or a; unused by gaussian and exponential
  std::shared_ptr<const detail::MaternTable> table_;  ///< for nu without a closed form
};

}  // namespace roughmesh
