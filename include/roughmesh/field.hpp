// SPDX-License-Identifier: BSD-3-Clause
// Random fields of heights on points: prepare once, draw many.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "roughmesh/correlation.hpp"
#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh {

enum class Method { cholesky };

std::string_view name(Method method);
Method method_from_name(
    std::string_view name);  ///< "auto" means the best method there is; @throws InputError

struct FieldOptions {
  Method method = Method::cholesky;
  double tolerance = 1e-4;  ///< covariance error that the audit accepts, > 0
};

enum class Factorization {
  cholesky,          ///< R = L L^T, every pivot at least 1e-5
  pivoted_cholesky,  ///< rank-revealing, stopped at a remaining diagonal of 1e-8
  eigenvalue         ///< R is indefinite: negative eigenvalues set to zero
};

std::string_view name(
    Factorization factorization);  ///< "cholesky", "pivoted-cholesky", "eigenvalue"

/// How the field was prepared, for the report. Absent values were not computed by that
/// factorization.
struct FieldSummary {
  Method method = Method::cholesky;
  Factorization factorization = Factorization::cholesky;
  Index rank = 0;                  ///< columns of L; `eigenvalue`: eigenvalues above 1e-8
  Index negative_eigenvalues = 0;  ///< below -1e-8; 0 for the Cholesky factorizations
  std::optional<double> smallest_eigenvalue;
  double smallest_correlation = 0;  ///< smallest rho between two points
  double variance_change = 0;  ///< largest |variance - 1| that the clipping of eigenvalues leaves
  std::optional<double> minimum_image_difference;  ///< Correlation::minimum_image_difference()
};

/// Largest |covariance - rho| over the audited pairs and diagonal entries.
struct Audit {
  double covariance_error = 0;
  Index n_pairs = 0;  ///< log-stratified in distance, from the shortest up
  Index n_diagonal = 0;
};

/// Draws realizations d of a zero-mean Gaussian field with unit variance and
///
///     E[d_i d_j] = R_ij                                          (docs/math.md, eq. 1)
///
/// at the n points of a Correlation R. `cholesky` is the method of Loth et al. (2020): N^2 memory,
/// N^3 work, any distance. Heights depend on (seed, realization, points) only, to 1e-8 across
/// threads and processors.
class FieldSampler {
 public:
  /// @param correlation  of n >= 1 points in canonical order (Surface::points); of points that
  ///                     carry one height only the masters (PeriodicPartners)
  /// @throws InputError      no points; tolerance out of range; too little free memory, naming what
  ///                         is needed
  /// @throws NumericalError  a correlation that is not a number; the eigenvalue decomposition did
  ///                         not converge
  explicit FieldSampler(const Correlation& correlation, const FieldOptions& options = {});
  ~FieldSampler();
  FieldSampler(FieldSampler&&) noexcept;
  FieldSampler& operator=(FieldSampler&&) noexcept;
  FieldSampler(const FieldSampler&) = delete;
  FieldSampler& operator=(const FieldSampler&) = delete;

  /// Heights over Rq: length n, in the order of the points. The same alone and among others.
  std::vector<double> heights(std::uint64_t seed, std::uint64_t realization) const;

  /// Covariance of points i and j that heights() has by construction, a dot product of two rows of
  /// the very factor that heights() multiplies with.
  /// @throws InputError  no such point
  double covariance(Index i, Index j) const;

  /// Compares covariance() with the rho that was asked for (unclipped), on up to 10^4 pairs and
  /// 10^4 diagonal entries. No Monte Carlo.
  Audit audit() const;

  const FieldSummary& summary() const;
  std::vector<std::string> citations() const;  ///< DOIs of the method

  struct Plan;  ///< the prepared factor; defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

}  // namespace roughmesh
