// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/field.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "audit.hpp"
#include "field_cholesky.hpp"
#include "field_lattice.hpp"

namespace roughmesh {

std::string_view name(Method method) {
  switch (method) {
    case Method::automatic:
      return "auto";
    case Method::cholesky:
      return "cholesky";
    case Method::lattice:
      break;
  }
  return "lattice";
}

Method method_from_name(std::string_view text) {
  for (const Method method : {Method::automatic, Method::cholesky, Method::lattice})
    if (text == name(method)) return method;
  throw InputError(fmt::format("method '{}' is unknown; use auto, cholesky or lattice", text));
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
  detail::PreparedField field;
};

namespace {

/// Places in a plane z = const, to round-off.
void require_plane(std::span<const Vec3> places) {
  const auto [low, high] = std::minmax_element(
      places.begin(), places.end(), [](const Vec3& x, const Vec3& y) { return x.z() < y.z(); });
  double largest = 0;
  for (const Vec3& x : places) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  if (high->z() - low->z() <= 1e-9 * largest) return;
  throw InputError(
      fmt::format("a field in a space of dimension 2 has places from z = {:g} to {:g}; give them "
                  "in a plane z = "
                  "const, or dimension 3",
                  low->z(), high->z()));
}

void check_input(const Correlation& correlation, const FieldOptions& options) {
  if (!(options.tolerance > 0) || !(options.tolerance < 1))
    throw InputError(fmt::format("tolerance {} is out of range; give a number between 0 and 1",
                                 options.tolerance));
  if (options.cutoff && (!(*options.cutoff > 0) || !std::isfinite(*options.cutoff)))
    throw InputError(
        fmt::format("cutoff {} is out of range; give a length above 0", *options.cutoff));
  if (correlation.n_points() == 0)
    throw InputError("a field needs at least one point; select a surface");
  if (options.dimension != 2 && options.dimension != 3)
    throw InputError(
        fmt::format("dimension {} of the space of a field; give 2 or 3", options.dimension));
  if (options.dimension == 2) require_plane(correlation.places());
}

/// What decides is the correlation alone, never the number of points, so that heights of one
/// request come from one method on every mesh.
Method chosen(const Correlation& correlation, const FieldOptions& options) {
  if (options.method != Method::automatic) return options.method;
  return detail::lattice_obstacle(correlation).empty() ? Method::lattice : Method::cholesky;
}

/// Only the method lattice can leave out short scales.
[[noreturn]] void refuse_cutoff(const Correlation& correlation, double cutoff) {
  const std::string obstacle = detail::lattice_obstacle(correlation);
  throw InputError(fmt::format(
      "cutoff {:g}: {}", cutoff,
      obstacle.empty() ? "only the method lattice can leave out short scales; leave the cutoff out "
                         "or choose lattice"
                       : obstacle + ", without a cutoff"));
}

detail::PreparedField prepare(const Correlation& correlation, const FieldOptions& options) {
  if (chosen(correlation, options) == Method::lattice)
    return detail::prepare_lattice(correlation, options);
  if (options.cutoff) refuse_cutoff(correlation, *options.cutoff);
  return detail::prepare_cholesky(correlation);
}

}  // namespace

FieldSampler::FieldSampler(const Correlation& correlation, const FieldOptions& options) {
  check_input(correlation, options);
  detail::PreparedField field = prepare(correlation, options);
  field.summary.minimum_image_difference = correlation.minimum_image_difference();
  plan_.reset(new Plan{std::move(field)});
}

FieldSampler::~FieldSampler() = default;
FieldSampler::FieldSampler(FieldSampler&&) noexcept = default;
FieldSampler& FieldSampler::operator=(FieldSampler&&) noexcept = default;

std::vector<double> FieldSampler::heights(std::uint64_t seed, std::uint64_t realization) const {
  return plan_->field.method->heights({seed, realization});
}

namespace {

void require_pair(Index i, Index j, const detail::PreparedField& field) {
  const Index n = field.method->correlation().n_points();
  if (std::min(i, j) < 0 || std::max(i, j) >= n)
    throw InputError(
        fmt::format("covariance of points {} and {}: there are points 0 to {}", i, j, n - 1));
}

}  // namespace

double FieldSampler::covariance(Index i, Index j) const {
  require_pair(i, j, plan_->field);
  const detail::PointPair pair{i, j};
  return plan_->field.method->covariances({&pair, 1}).front();
}

double FieldSampler::target(Index i, Index j) const {
  require_pair(i, j, plan_->field);
  return plan_->field.method->target(i, j);
}

Audit FieldSampler::audit() const { return detail::audit_covariance(*plan_->field.method); }

const FieldSummary& FieldSampler::summary() const { return plan_->field.summary; }

std::vector<std::string> FieldSampler::citations() const { return plan_->field.citations; }

}  // namespace roughmesh
