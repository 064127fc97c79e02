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

enum class Method {
  automatic,  ///< `lattice` where the correlation allows it, else `cholesky`
  cholesky,   ///< the whole matrix: N^2 memory, N^3 work, any distance
  lattice     ///< linear in N: Euclidean and periodic distance, mixtures of Gaussians
};

std::string_view name(Method method);            ///< "auto", "cholesky", "lattice"
Method method_from_name(std::string_view name);  ///< @throws InputError

struct FieldOptions {
  Method method = Method::automatic;
  double tolerance = 1e-4;  ///< covariance error that the audit accepts, in (0, 1)
  /// `lattice`: Gaussians of the mixture with a smaller scale are left out, and their variance is
  /// lost. With it heights are a function of the place for every family. A length, > 0.
  std::optional<double> cutoff = {};
  int dimension = 3;  ///< of the space that the places fill: 2 (z is equal for all) or 3
};

enum class Factorization {
  cholesky,          ///< R = L L^T, every pivot at least 1e-5
  pivoted_cholesky,  ///< rank-revealing, stopped at a remaining diagonal of 1e-8
  eigenvalue         ///< R is indefinite: negative eigenvalues set to zero
};

std::string_view name(
    Factorization factorization);  ///< "cholesky", "pivoted-cholesky", "eigenvalue"

/// How `cholesky` prepared the field. Absent values were not computed by that factorization.
struct CholeskySummary {
  Factorization factorization = Factorization::cholesky;
  Index rank = 0;                  ///< columns of L; `eigenvalue`: eigenvalues above 1e-8
  Index negative_eigenvalues = 0;  ///< below -1e-8; 0 for the Cholesky factorizations
  std::optional<double> smallest_eigenvalue;
  double smallest_correlation = 0;  ///< smallest rho between two points
  double variance_change = 0;  ///< largest |variance - 1| that the clipping of eigenvalues leaves
};

/// How `lattice` prepared the field.
struct LatticeSummary {
  std::vector<GaussianTerm> terms;  ///< of the mixture, ascending in scale; without the nugget
  double nugget = 0;         ///< mean share of the variance that a point shares with no other
  double lost_variance = 0;  ///< left out because of the cutoff: points have variance 1 - this
  /// Whether another mesh of the same body gets the same heights at the same places: true of one
  /// Gaussian, and of all families under a cutoff.
  bool same_on_other_meshes = false;
};

/// How the field was prepared, for the report.
struct FieldSummary {
  Method method = Method::cholesky;                ///< never `automatic`
  std::optional<CholeskySummary> cholesky;         ///< of that method, else absent
  std::optional<LatticeSummary> lattice;           ///< of that method, else absent
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
/// at the n points of a Correlation R.
///
/// `cholesky` is the method of Loth et al. (2020). Heights depend on (seed, realization, points)
/// only, to 1e-8 across threads and processors.
///
/// `lattice` sums white noise on lattices, keyed by absolute place, under Gaussian kernels
/// (docs/math.md, eq. 46 to 49). Heights have the same bits on any number of threads, and differ by
/// at most 1e-12 across processors. Where LatticeSummary::same_on_other_meshes holds they depend on
/// (seed, realization, place) alone, for one correlation and equal options; otherwise also on how
/// close points are.
class FieldSampler {
 public:
  /// @param correlation  of n >= 1 points in canonical order (Surface::points); of points that
  ///                     carry one height only the masters (PeriodicPartners)
  /// @throws InputError      no points; an option out of range; a method or cutoff that does not go
  ///                         with the correlation; places too far from the origin for their
  ///                         correlation length; too little free memory, naming what is needed
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
  /// the very factor or tables that heights() multiplies with.
  /// @throws InputError  no such point
  double covariance(Index i, Index j) const;

  /// Covariance that was asked for: rho (rho_P where periodic), unclipped; under a cutoff the sum
  /// of the Gaussians that are left.
  double target(Index i, Index j) const;

  /// Compares covariance() with target() on up to 10^4 pairs and 10^4 diagonal entries. No Monte
  /// Carlo.
  Audit audit() const;

  const FieldSummary& summary() const;
  std::vector<std::string> citations() const;  ///< DOIs of the method

  struct Plan;  ///< the prepared field; defined by the source

 private:
  std::unique_ptr<const Plan> plan_;
};

}  // namespace roughmesh
