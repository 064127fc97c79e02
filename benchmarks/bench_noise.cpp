// SPDX-License-Identifier: BSD-3-Clause
// Bar: white noise on a lattice takes at most 2 ns a number in runs of 16 and 2.5 ns in runs of 10
// that begin anywhere, on a processor with AVX-512. Every instruction set that the processor has is
// measured, and Random123 with the mathematics library beside them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Random123/philox.h>
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include "lattice_noise.hpp"

namespace {

using namespace roughmesh;
using detail::LatticeNoise;
using detail::NoiseRun;

/// Numbers on a cube of n x n x n points, as an active block of the sampler has them; four cubes,
/// which begin at the four places within a block of four, take turns.
struct Cubes {
  explicit Cubes(std::int64_t n) : values(static_cast<std::size_t>(n * n * n)) {
    for (std::int64_t first = 0; first < 4; ++first)
      for (std::int64_t x = 0; x < n; ++x)
        for (std::int64_t y = 0; y < n; ++y)
          runs[static_cast<std::size_t>(first)].push_back(
              {.x = x,
               .y = y,
               .z = first - n / 2,
               .n = static_cast<std::int32_t>(n),
               .values = &values[static_cast<std::size_t>((x * n + y) * n)]});
  }

  std::vector<double> values;
  std::array<std::vector<NoiseRun>, 4> runs;
};

template <class Fill>
void measure(benchmark::State& state, const Fill& fill) {
  Cubes cubes(state.range(0));
  std::size_t turn = 0;
  for (auto _ : state) {
    fill(cubes.runs[++turn % 4]);
    benchmark::DoNotOptimize(cubes.values.data());
    benchmark::ClobberMemory();
  }
  state.counters["time/number"] = benchmark::Counter(
      static_cast<double>(cubes.values.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void vectors(benchmark::State& state, std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  const LatticeNoise noise({1, 2}, 0);
  measure(state, [&](const std::vector<NoiseRun>& runs) { noise.fill(runs); });
  hwy::SetSupportedTargetsForTest(0);
}

/// The textbook: Random123 and the mathematics library.
std::array<double, 4> library_block(std::int64_t x, std::int64_t y, std::int64_t block) {
  using Philox = r123::Philox4x32_R<10>;
  const Philox::ctr_type words =
      Philox{}(Philox::ctr_type{{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                 static_cast<std::uint32_t>(block), 0}},
               Philox::key_type{{1, 2}});
  std::array<double, 4> four{};
  for (std::size_t pair = 0; pair < 4; pair += 2) {
    const double radius = std::sqrt(-2 * std::log((words[pair] + 0.5) * 0x1p-32));
    const double angle = 2 * std::numbers::pi * (words[pair + 1] + 0.5) * 0x1p-32;
    four[pair] = radius * std::cos(angle);
    four[pair + 1] = radius * std::sin(angle);
  }
  return four;
}

void fill_by_library(const NoiseRun& run) {
  for (std::int64_t k = -(run.z & 3); k < run.n; k += 4) {
    const std::array<double, 4> four = library_block(run.x, run.y, (run.z + k) >> 2);
    const std::int64_t end = std::min<std::int64_t>(4, run.n - k);
    for (std::int64_t j = std::max<std::int64_t>(0, -k); j < end; ++j)
      run.values[k + j] = four[static_cast<std::size_t>(j)];
  }
}

void library(benchmark::State& state) {
  measure(state, [](const std::vector<NoiseRun>& runs) {
    for (const NoiseRun& run : runs) fill_by_library(run);
  });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::vector<std::int64_t> lengths = {4, 10, 16, 64};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    benchmark::RegisterBenchmark((std::string("vectors ") + hwy::TargetName(target)).c_str(),
                                 vectors, target)
        ->ArgsProduct({lengths});
  benchmark::RegisterBenchmark("library", library)->ArgsProduct({lengths});
  benchmark::RunSpecifiedBenchmarks();
}
