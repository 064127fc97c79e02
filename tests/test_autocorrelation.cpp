// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "roughmesh/autocorrelation.hpp"

using namespace roughmesh;

TEST(Autocorrelation, MaternEqualsItsBesselForm) {
  for (const double nu : {0.01, 0.1, 0.3, 0.8, 1.0, 1.2, 2.0, 5.0, 20.0}) {
    const Autocorrelation acf({.family = Family::matern, .length = 1.0, .nu = nu});
    for (const double r : {0.01, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0}) {
      const double z = std::sqrt(2 * nu) * r;
      const double expected =
          std::pow(2, 1 - nu) / std::tgamma(nu) * std::pow(z, nu) * std::cyl_bessel_k(nu, z);
      EXPECT_NEAR(acf.rho(r), expected, 1e-12) << nu << " " << r;
    }
  }
}
