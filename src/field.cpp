// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/field.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "audit.hpp"
#include "field_cholesky.hpp"

namespace roughmesh {

std::string_view name(Method) { return "cholesky"; }

Method method_from_name(std::string_view name) {
  if (name == "auto" || name == "cholesky") return Method::cholesky;
  throw InputError(fmt::format("method '{}' is unknown; use auto or cholesky", name));
}

std::string_view name(Factorization factorization) {
  switch (factorization) {
    case Factorization::cholesky:
      return "cholesky";
    case Factorization::pivoted_cholesky:
      return "pivoted-cholesky";
    case Factorization::eigenvalue:
      break;
  }
  return "eigenvalue";
}

struct FieldSampler::Plan {
  Correlation correlation;
  detail::PreparedField field;
};

namespace {

void check_input(const Correlation& correlation, const FieldOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw InputError(fmt::format("tolerance {} is out of range; give a finite number above 0",
                                 options.tolerance));
  if (correlation.n_points() == 0)
    throw InputError("a field needs at least one point; select a surface");
}

}  // namespace

FieldSampler::FieldSampler(const Correlation& correlation, const FieldOptions& options) {
  check_input(correlation, options);
  detail::PreparedField field =
      detail::prepare_cholesky(detail::autocorrelation_matrix(correlation));
  field.summary.minimum_image_difference = correlation.minimum_image_difference();
  plan_.reset(new Plan{correlation, std::move(field)});
}

FieldSampler::~FieldSampler() = default;
FieldSampler::FieldSampler(FieldSampler&&) noexcept = default;
FieldSampler& FieldSampler::operator=(FieldSampler&&) noexcept = default;

std::vector<double> FieldSampler::heights(std::uint64_t seed, std::uint64_t realization) const {
  return plan_->field.factor.heights({seed, realization});
}

double FieldSampler::covariance(Index i, Index j) const {
  const Index n = plan_->correlation.n_points();
  if (std::min(i, j) < 0 || std::max(i, j) >= n)
    throw InputError(
        fmt::format("covariance of points {} and {}: there are points 0 to {}", i, j, n - 1));
  const detail::PointPair pair{i, j};
  return plan_->field.factor.covariances({&pair, 1}).front();
}

Audit FieldSampler::audit() const {
  return detail::audit_covariance(plan_->field.factor, plan_->correlation);
}

const FieldSummary& FieldSampler::summary() const { return plan_->field.summary; }

std::vector<std::string> FieldSampler::citations() const {
  std::vector<std::string> works = {
      "Loth, Kiel, Busch, Kristensen (2020), Surface roughness in finite element meshes, "
      "arXiv:2002.00894",
      "Salmon, Moraes, Dror, Shaw (2011), Parallel random numbers: as easy as 1, 2, 3, "
      "doi:10.1145/2063384.2063405",
      "Higham (2009), Cholesky factorization, doi:10.1002/wics.18"};
  if (summary().factorization == Factorization::pivoted_cholesky)
    works.emplace_back(
        "Lucas (2004), LAPACK-style codes for level 2 and 3 pivoted Cholesky factorizations, "
        "LAPACK Working Note 161");
  return works;
}

}  // namespace roughmesh
