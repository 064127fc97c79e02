// SPDX-License-Identifier: BSD-3-Clause
// Which Gaussians a field of the method `lattice` is made of, and which places can do without some.
#pragma once

#include <cstdint>
#include <vector>

#include "roughmesh/field.hpp"

#include "lattice_space.hpp"
#include "scale_mixture.hpp"

namespace roughmesh::detail {

/// Is the autocorrelation one Gaussian, whatever the tolerance?
bool is_one_gaussian(const Autocorrelation& autocorrelation);

/// The terms from number `first` on are summed over cells (docs/math.md, eq. 49): two or more, or
/// none.
struct CoarseTerms {
  std::size_t first = 0;
  double cell = 1;   ///< edge of the smallest cells
  int n_stages = 1;  ///< sizes of cells at most
  double error = 0;  ///< that their polynomials may add
  /// The body is so far across that places cannot be sorted into smaller cells: `cell` depends on
  /// it.
  bool is_enlarged = false;
};

/// The tolerance and what became of it (docs/math.md, eq. 48).
struct LatticeTerms {
  ScaleMixture mixture;      ///< under a cutoff without the terms and the nugget that it takes away
  double lost_variance = 0;  ///< taken away by the cutoff
  double lattice_error = 0;  ///< that the kernels may add
  double distance = 0;       ///< typical one of neighbours: of these places, or the cutoff; or 0
  /// For each sorted place, how many of the first terms are nugget there, no other place being near
  /// enough to tell; empty: none.
  std::vector<std::uint8_t> n_skipped;
  CoarseTerms coarse;  ///< none of which a place does without
};

/// One Gaussian is itself. Under a cutoff the terms are a function of the autocorrelation, the
/// tolerance and the cutoff; otherwise scales go down to the shortest distance between places.
/// @throws InputError  a cutoff that leaves nothing; what fit_scale_mixture throws
LatticeTerms choose_terms(const Correlation& correlation, const FieldOptions& options,
                          const LatticeSpace& space, const SortedPlaces& places);

}  // namespace roughmesh::detail
