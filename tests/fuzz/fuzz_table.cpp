// SPDX-License-Identifier: BSD-3-Clause
// Measured autocorrelation functions: what is accepted is a function from -1 to 1.
#include <cmath>
#include <cstdlib>

#include "roughmesh/autocorrelation.hpp"

#include "input_file.hpp"
#include "readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace roughmesh;
  fuzz::run([&] {
    AutocorrelationOptions options{.family = Family::table};
    options.table = read_correlation_table(fuzz::input_file(data, size));
    const Autocorrelation autocorrelation(options);
    const double end = options.table.back().r;
    if (autocorrelation.rho(0) != 1) std::abort();
    for (const double r : {0.01 * end, 0.5 * end, end, 2 * end, 1e3 * end})
      if (!(std::abs(autocorrelation.rho(r)) <= 1 + 1e-9)) std::abort();
  });
  return 0;
}
