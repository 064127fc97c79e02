// SPDX-License-Identifier: BSD-3-Clause
#include "field_ensemble.hpp"

#include <algorithm>
#include <utility>

namespace roughmesh::detail {
namespace {

/// Of the first surface that shows the field.
const Roughness& request_of(std::size_t field, std::span<const SurfacePlan> plans) {
  return std::find_if(plans.begin(), plans.end(),
                      [&](const SurfacePlan& plan) { return plan.field == field; })
      ->request;
}

/// Of the points of a surface, among those that are sampled: each of them or its master.
std::vector<Index> sampled_positions(const SurfacePlan& plan, const PeriodicPartners& partners) {
  const std::vector<Index> sampled = masters(partners);
  std::vector<Index> position_of(partners.master.size());
  for (std::size_t k = 0; k < sampled.size(); ++k) position_of[sampled[k]] = static_cast<Index>(k);
  std::vector<Index> positions;
  positions.reserve(plan.field_point.size());
  for (const Index point : plan.field_point)
    positions.push_back(position_of[partners.master[point]]);
  return positions;
}

bool is_last_of_its_field(std::size_t plan, std::span<const SurfacePlan> plans) {
  const auto later = plans.subspan(plan + 1);
  return std::none_of(later.begin(), later.end(),
                      [&](const SurfacePlan& other) { return other.field == plans[plan].field; });
}

}  // namespace

void add_citations(std::vector<std::string>& works, std::vector<std::string> more) {
  for (std::string& work : more)
    if (std::find(works.begin(), works.end(), work) == works.end())
      works.push_back(std::move(work));
}

FieldEnsemble::FieldEnsemble(const RoughSurfaces& rough, const RoughenOptions& options,
                             StageTimer& timer)
    : rough_(rough) {
  for (std::size_t f = 0; f < rough.fields.size(); ++f) {
    const FieldPlan& plan = rough.fields[f];
    const Roughness& request = request_of(f, rough.plans);
    FieldOptions sampling = field_options(options, request);
    sampling.dimension = plan.dimension;
    samplers_.push_back(timer.time(&Timings::field, [&] {
      return FieldSampler(plan.correlation.among(masters(plan.partners)), sampling);
    }));
    audits_.push_back(timer.time(&Timings::audit, [&] { return samplers_.back().audit(); }));
    seeds_.push_back(request.seed);
  }
}

std::vector<std::vector<double>> FieldEnsemble::heights(std::uint64_t realization) const {
  std::vector<std::vector<double>> fields, result;
  for (std::size_t f = 0; f < samplers_.size(); ++f)
    fields.push_back(
        expand(rough_.fields[f].partners, samplers_[f].heights(seeds_[f], realization)));
  for (std::size_t s = 0; s < rough_.plans.size(); ++s) {
    std::vector<double>& field = fields[rough_.plans[s].field];
    const bool is_last = is_last_of_its_field(s, rough_.plans);
    result.push_back(heights_of(rough_.plans[s], is_last ? std::move(field) : field));
  }
  return result;
}

std::function<double(Index, Index)> FieldEnsemble::covariance(const SurfacePlan& plan) const {
  const FieldSampler& sampler = samplers_[plan.field];
  const auto& cholesky = sampler.summary().cholesky;
  const bool is_clipped = cholesky && cholesky->factorization == Factorization::eigenvalue;
  if (!is_clipped && !plan.request.cutoff) return {};
  return
      [&sampler, is_clipped,
       position = sampled_positions(plan, rough_.fields[plan.field].partners)](Index i, Index j) {
        return is_clipped ? sampler.covariance(position[i], position[j])
                          : sampler.target(position[i], position[j]);
      };
}

std::vector<std::string> FieldEnsemble::citations() const {
  std::vector<std::string> works;
  for (std::size_t f = 0; f < samplers_.size(); ++f) {
    add_citations(works, samplers_[f].citations());
    add_citations(works, rough_.fields[f].correlation.autocorrelation().citations());
  }
  return works;
}

}  // namespace roughmesh::detail
