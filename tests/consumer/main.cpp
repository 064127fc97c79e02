// SPDX-License-Identifier: BSD-3-Clause
// Draws heights on three points through the installed package; fails if they are not finite.
#include <cmath>
#include <iostream>
#include <vector>

#include <roughmesh/field.hpp>
#include <roughmesh/pipeline.hpp>

int main() {
  using namespace roughmesh;
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const FieldSampler sampler(
      Correlation(points, Autocorrelation({.length = 1.0}), Distance::euclidean()));
  for (const double height : sampler.heights(1, 0))
    if (!std::isfinite(height)) return 1;
  std::cout << "roughmesh " << version() << ": covariance error "
            << sampler.audit().covariance_error << '\n';
  return 0;
}
