// SPDX-License-Identifier: BSD-3-Clause
// The method `lattice` keeps the tolerance of its covariance: every family, body, unit and space.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "support/lattice_cases.hpp"

namespace roughmesh {
namespace {

using test::lattice_sampler;

void expect_tolerance_kept(const std::vector<Vec3>& places, const Autocorrelation& rho,
                           const Distance& distance, const FieldOptions& options) {
  const FieldSampler sampler = lattice_sampler(places, rho, distance, options);
  ASSERT_TRUE(sampler.summary().lattice.has_value());
  const Audit audit = sampler.audit();
  EXPECT_LE(audit.covariance_error, options.tolerance);
  EXPECT_GT(audit.n_pairs, 1000);
}

TEST(LatticeField, KeepsTheToleranceForEveryFamily) {
  const test::Body sphere = test::sphere_body();
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(sphere.length))
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
      SCOPED_TRACE(name + ", " + std::to_string(tolerance));
      expect_tolerance_kept(sphere.nodes, Autocorrelation(autocorrelation), Distance::euclidean(),
                            {.tolerance = tolerance});
    }
}

TEST(LatticeField, KeepsTheToleranceOnEveryBody) {
  int number = 0;
  for (const test::Body& body : test::other_bodies()) {
    ++number;  // so that each family has each tolerance on every other body
    for (const auto& [name, autocorrelation] : test::some_autocorrelations(body.length)) {
      const double tolerance = ++number % 2 == 0 ? 1e-3 : 1e-6;
      SCOPED_TRACE(body.name + ", " + name + ", " + std::to_string(tolerance));
      expect_tolerance_kept(body.nodes, Autocorrelation(autocorrelation), Distance::euclidean(),
                            {.tolerance = tolerance});
    }
  }
}

}  // namespace
}  // namespace roughmesh
