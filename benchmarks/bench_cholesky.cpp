// SPDX-License-Identifier: BSD-3-Clause
// Bar: preparing `cholesky` for 10^4 points and an exponential autocorrelation takes at most 1.3
// times LAPACK's own factorization of the same matrix. The two alternate, because the speed of a
// shared machine drifts; the ratio is that of their medians.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include <cblas.h>
#include <fmt/format.h>
#include <lapacke.h>

#include "roughmesh/field.hpp"

#include "support/meshes.hpp"

namespace {

using namespace roughmesh;

constexpr int repetitions = 5;

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double lapack_seconds(const std::vector<Vec3>& points, const Autocorrelation& autocorrelation) {
  const auto n = static_cast<lapack_int>(points.size());
  std::vector<double> matrix(points.size() * points.size());
  for (std::size_t j = 0; j < points.size(); ++j)
    for (std::size_t i = j; i < points.size(); ++i)
      matrix[j * points.size() + i] = autocorrelation.rho((points[i] - points[j]).norm());
  return seconds([&] { LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, matrix.data(), n); });
}

}  // namespace

int main() {
  constexpr int divisions = 99;  // 10^4 points
  const Mesh mesh = test::plate(divisions);
  const Autocorrelation autocorrelation({.family = Family::exponential, .length = 2.5 / divisions});
  const double n = static_cast<double>(mesh.nodes.size());
  const double gigaflop = n * n * n / 3 * 1e-9;

  std::vector<double> lapack, ours;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    lapack.push_back(lapack_seconds(mesh.nodes, autocorrelation));
    ours.push_back(seconds([&] {
      const FieldSampler sampler(Correlation(mesh.nodes, autocorrelation, Distance::euclidean()),
                                 {.method = Method::cholesky});
    }));
    fmt::print("LAPACK dpotrf {:.3f} s, FieldSampler {:.3f} s\n", lapack.back(), ours.back());
  }
  fmt::print("{} points, exponential, l = 2.5 h, {} threads of linear algebra, {} cores\n", n,
             openblas_get_num_threads(), std::thread::hardware_concurrency());
  fmt::print("LAPACK dpotrf (reference): {:.3f} s, {:.1f} GFLOP/s\n", median(lapack),
             gigaflop / median(lapack));
  fmt::print("FieldSampler: {:.3f} s, {:.1f} GFLOP/s\n", median(ours), gigaflop / median(ours));
  fmt::print("ratio {:.2f}, at most 1.3\n", median(ours) / median(lapack));
}
