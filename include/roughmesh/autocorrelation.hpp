// SPDX-License-Identifier: BSD-3-Clause
// Autocorrelation functions rho(r), as values.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/error.hpp"

namespace roughmesh {

namespace detail {
class AutocorrelationTable;
class MaternTable;
}  // namespace detail

enum class Family {
  gaussian,
  exponential,
  matern,
  self_affine,
  stretched,
  rational_quadratic,
  table  ///< measured pairs (r, rho)
};

/// What a given length means; all but `formula` are converted to the parameter of the formula.
enum class LengthDefinition {
  formula,     ///< the parameter l of docs/math.md, eq. 4 to 9
  one_over_e,  ///< distance at which rho = 1/e
  integral,    ///< integral of rho over r from 0 to infinity
  sal          ///< distance at which rho = 0.2 (Sal of ISO 25178-2)
};

std::string_view name(Family family);                ///< as on the command line: "self-affine"
std::string_view name(LengthDefinition definition);  ///< "one-over-e"

/// One entry of a measured autocorrelation function.
struct CorrelationPair {
  double r = 0;    ///< distance, >= 0
  double rho = 0;  ///< autocorrelation there, from -1 to 1; 1 at r = 0
};

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
  /// Pairs of `table`, ascending in r, at least 3, the last rho at most 0.1. They set the length.
  std::vector<CorrelationPair> table = {};
};

/// Pairs from a text file: two numbers a line, r and rho, between spaces, tabs, commas or
/// semicolons; lines that are empty or start with `#` do not count.
/// @throws InputError   a file that cannot be read
/// @throws FormatError  fewer than 3 pairs, and, by line: not two finite numbers, r that does not
///                      increase or is negative, |rho| above 1, rho(0) that is not 1 (to 1e-6)
std::vector<CorrelationPair> read_correlation_table(const std::filesystem::path& path);

/// One Gaussian of a mixture: weight exp(-r^2 / (2 scale^2)).
struct GaussianTerm {
  double weight = 0;
  double scale = 0;  ///< a length
};

/// The same decay in each convention of the field; absent where it does not exist.
struct EquivalentLengths {
  std::optional<double> formula;  ///< `table` has none
  double one_over_e = 0;
  std::optional<double> integral;
  double sal = 0;
};

/// rho(r): normalized (rho(0) = 1), isotropic, positive definite in every dimension up to 3, but
/// for a `table` that no positive definite function meets. Formulas and sources: docs/math.md, eq.
/// 4 to 9, 29 and 30. Cheap to copy.
class Autocorrelation {
 public:
  /// @throws InputError  a parameter that is missing, foreign to the family, not finite or out of
  ///                     range; both or none of length and rolloff; a length definition that
  ///                     does not exist for the family; a table of too few pairs, with a pair
  ///                     out of range or order, or that has not decayed
  explicit Autocorrelation(const AutocorrelationOptions& options);

  double rho(double r) const;  ///< r >= 0, a length; continuous, in (0, 1], 0 where it underflows
  Family family() const { return family_; }
  /// l of the formula; of `table` that of a Gaussian with the same 1/e distance.
  double length() const { return length_; }
  double shape() const { return shape_; }  ///< nu, H, p or a; 0 for families without
  EquivalentLengths equivalent_lengths() const;

  /// Share of the variance carried by wavenumbers above q (rad per length) in the plane (dimension
  /// 2) or along a line (dimension 1), in [0, 1]: docs/math.md, eq. 14.
  double spectrum_share_above(double q, int dimension) const;

  /// -rho''(0) where rho is twice differentiable there (the field has slopes), else nothing.
  /// 1/length^2.
  std::optional<double> slope_variance() const;

  /// The positive mixture of Gaussians that rho is: of `table` where it is met to 0.02, else empty.
  std::span<const GaussianTerm> gaussian_terms() const;

  /// Of `table`: largest |mixture - rho| over the pairs, for the best mixture of Gaussians. Up to
  /// 0.02 the mixture is rho; above, rho is the monotone interpolant of the pairs.
  std::optional<double> fit_residual() const;

  /// Works that the family rests on, for the report: authors, year, title, DOI.
  std::vector<std::string> citations() const;

 private:
  Family family_;
  double length_ = 0;
  double shape_ = 0;  ///< nu, H, p or a; unused by gaussian and exponential
  std::shared_ptr<const detail::MaternTable> matern_table_;    ///< for nu without a closed form
  std::shared_ptr<const detail::AutocorrelationTable> table_;  ///< of `table`
};

}  // namespace roughmesh
