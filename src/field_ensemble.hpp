// SPDX-License-Identifier: BSD-3-Clause
// The fields of a run, prepared and audited once: heights of every surface, realization by
// realization.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "roughmesh/field.hpp"
#include "roughmesh/options.hpp"

#include "rough_surface.hpp"
#include "stage_timer.hpp"

namespace roughmesh::detail {

class FieldEnsemble {
 public:
  /// @param rough  outlives it
  /// @throws what FieldSampler throws
  FieldEnsemble(const RoughSurfaces& rough, const RoughenOptions& options, StageTimer& timer);

  /// One for each field.
  const std::vector<FieldSampler>& samplers() const { return samplers_; }
  const std::vector<Audit>& audits() const { return audits_; }

  /// Heights of the points of every surface.
  std::vector<std::vector<double>> heights(std::uint64_t realization) const;

  /// Covariance between the points of a surface where it is not the correlation, else empty: what
  /// clipped eigenvalues leave, or what is asked for under a cutoff. Does not outlive this.
  std::function<double(Index, Index)> covariance(const SurfacePlan& plan) const;

  std::vector<std::string> citations() const;

 private:
  const RoughSurfaces& rough_;
  std::vector<FieldSampler> samplers_;
  std::vector<Audit> audits_;
  std::vector<std::uint64_t> seeds_;
};

/// Appends what is not there yet.
void add_citations(std::vector<std::string>& works, std::vector<std::string> more);

}  // namespace roughmesh::detail
