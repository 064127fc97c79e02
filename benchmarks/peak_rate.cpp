// SPDX-License-Identifier: BSD-3-Clause
#include "peak_rate.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <thread>
#include <vector>

// Highway compiles the part between BEFORE_NAMESPACE and AFTER_NAMESPACE once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "peak_rate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace roughmesh::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

int lanes() { return static_cast<int>(hn::Lanes(hn::ScalableTag<double>())); }

const char* target() { return hwy::TargetName(HWY_TARGET); }

// Ten independent chains hide the latency of two units and leave registers for the factors. The
// values stay bounded: x <- x / 2 + 1 / 2.
double multiply_adds(std::int64_t repetitions) {
  const hn::ScalableTag<double> d;
  const auto half = hn::Set(d, 0.5);
  auto a = hn::Iota(d, 1), b = hn::Iota(d, 2), c = hn::Iota(d, 3), e = hn::Iota(d, 4),
       f = hn::Iota(d, 5), g = hn::Iota(d, 6), h = hn::Iota(d, 7), i = hn::Iota(d, 8),
       j = hn::Iota(d, 9), k = hn::Iota(d, 10);
  for (std::int64_t repetition = 0; repetition < repetitions; ++repetition) {
    a = hn::MulAdd(a, half, half);
    b = hn::MulAdd(b, half, half);
    c = hn::MulAdd(c, half, half);
    e = hn::MulAdd(e, half, half);
    f = hn::MulAdd(f, half, half);
    g = hn::MulAdd(g, half, half);
    h = hn::MulAdd(h, half, half);
    i = hn::MulAdd(i, half, half);
    j = hn::MulAdd(j, half, half);
    k = hn::MulAdd(k, half, half);
  }
  const auto sum = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)),
                           hn::Add(hn::Add(hn::Add(f, g), hn::Add(h, i)), hn::Add(j, k)));
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace roughmesh::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace roughmesh::bench {
namespace {

HWY_EXPORT(lanes);
HWY_EXPORT(target);
HWY_EXPORT(multiply_adds);

constexpr std::int64_t chains = 10;
constexpr std::int64_t repetitions = 20'000'000;
constexpr int trials = 5;

double seconds_on_threads(int n_threads) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<double> sums(static_cast<std::size_t>(n_threads));  // so that nothing is left out
  std::vector<std::thread> threads;
  for (double& sum : sums)
    threads.emplace_back([&sum] { sum = HWY_DYNAMIC_DISPATCH(multiply_adds)(repetitions); });
  for (std::thread& thread : threads) thread.join();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

PeakRate peak_rate(int n_threads) {
  PeakRate peak;
  peak.lanes = HWY_DYNAMIC_DISPATCH(lanes)();
  peak.target = HWY_DYNAMIC_DISPATCH(target)();
  const double work = static_cast<double>(chains * repetitions) * peak.lanes * n_threads;
  for (int trial = 0; trial < trials; ++trial) {
    const std::clock_t processor_start = std::clock();
    const double seconds = seconds_on_threads(n_threads);
    const double used = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
    if (work / used < peak.multiply_adds) continue;
    peak.multiply_adds = work / used;
    peak.processor_share = used / seconds / n_threads;
  }
  return peak;
}

}  // namespace roughmesh::bench
#endif
