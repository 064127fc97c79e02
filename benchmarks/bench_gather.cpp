// SPDX-License-Identifier: BSD-3-Clause
// Bar: the gather loop of `lattice` runs at 25 % or more of the processor's peak multiply-add rate,
// for a Gaussian with l = 2.5 h on 10^6 points at tolerance 1e-4. Useful are P^3 multiply-adds a
// point, P being the lattice points that a kernel takes along an axis. Beside the loop alone stands
// the whole of heights(), which makes the noise as well. Rates are those of a second of processor
// time of one thread, while all cores do the same, so that other programs count for little.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <hwy/aligned_allocator.h>

#include "roughmesh/field.hpp"

#include "lattice_axis.hpp"
#include "lattice_gather.hpp"
#include "lattice_level.hpp"
#include "lattice_space.hpp"
#include "peak_rate.hpp"
#include "sphere_points.hpp"

namespace {

using namespace roughmesh;

constexpr Index n_points = 1'000'000;
constexpr double tolerance = 1e-4;
constexpr double length_over_spacing = 2.5;
constexpr int samples = 9;
constexpr int repetitions = 200;  // of the loop
constexpr int trials = 5;

struct Seconds {
  double wall, processor;  // processor: of all threads together
};

template <class Work>
Seconds seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  work();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
}

/// The kernel that one Gaussian needs in three dimensions.
detail::KernelWidth kernel_width() {
  const auto widths = detail::kernel_widths();
  return *std::find_if(widths.begin(), widths.end(),
                       [](const detail::KernelWidth& w) { return 3 * w.error <= tolerance; });
}

/// What one thread works on: the points of a cell, sorted as the sampler sorts them, and a box of
/// numbers under them.
class Patch {
 public:
  Patch(const detail::SortedPlaces& sorted, double length, const detail::KernelWidth& width) {
    const detail::LatticeAxis axis(length, width);
    axes_.fill(axis);
    const auto [first, end] = fullest_cell(sorted, detail::cell_points(3) / axis.inverse_spacing());
    places_.assign(&sorted.places()[first], &sorted.places()[first] + (end - first));
    for (std::uint32_t i = 0; i < places_.size(); ++i) members_.push_back(i);
    sums_.resize(places_.size());
    make_box();
  }

  Patch(const Patch&) = delete;
  Patch& operator=(const Patch&) = delete;

  void gather() { detail::gather(axes_, box_, members_, places_.data(), sums_.data()); }

  std::size_t n_points() const { return places_.size(); }

 private:
  static detail::SortedPlaces::Range fullest_cell(const detail::SortedPlaces& sorted, double edge) {
    const std::vector<detail::SortedPlaces::Range> cells = sorted.cells(edge);
    return *std::max_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
      return a.second - a.first < b.second - b.first;
    });
  }

  void make_box() {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] =
          std::minmax_element(places_.begin(), places_.end(), [a](const Vec3& x, const Vec3& y) {
            return x[static_cast<int>(a)] < y[static_cast<int>(a)];
          });
      box_.first[a] = axes_[a].first_point((*low)[static_cast<int>(a)]);
      if (a == 2) box_.first[a] = detail::first_of_column(box_.first[a]);
      box_.size[a] =
          axes_[a].first_point((*high)[static_cast<int>(a)]) + axes_[a].n_points() - box_.first[a];
    }
    const auto n_values = static_cast<std::size_t>(box_.n_values());
    values_ = hwy::AllocateAligned<double>(n_values);
    std::fill_n(values_.get(), n_values, 1e-3);
    box_.values = values_.get();
  }

  std::array<detail::LatticeAxis, 3> axes_;
  std::vector<Vec3> places_;
  std::vector<std::uint32_t> members_;
  hwy::AlignedFreeUniquePtr<double[]> values_;
  std::vector<double> sums_;
  detail::LatticeBox box_;
};

/// Points that the loop alone serves in a second of one thread.
double gather_rate(const std::vector<Vec3>& points, double length, const detail::KernelWidth& width,
                   int n_threads) {
  const detail::SortedPlaces sorted(points, length);
  std::vector<std::unique_ptr<Patch>> patches;
  for (int t = 0; t < n_threads; ++t)
    patches.push_back(std::make_unique<Patch>(sorted, length, width));
  double best = INFINITY;
  for (int trial = 0; trial < trials; ++trial) {
    const Seconds taken = seconds([&] {
      std::vector<std::jthread> threads;
      for (const auto& patch : patches)
        threads.emplace_back([&patch] {
          for (int k = 0; k < repetitions; ++k) patch->gather();
        });
    });
    best = std::min(best, taken.processor);
  }
  return static_cast<double>(patches[0]->n_points()) * repetitions * n_threads / best;
}

Seconds sample_seconds(const std::vector<Vec3>& points, double length) {
  const Correlation correlation(points, Autocorrelation({.length = length}), Distance::euclidean());
  const FieldSampler sampler(correlation, {.method = Method::lattice, .tolerance = tolerance});
  std::vector<double> wall, processor;
  for (std::uint64_t realization = 0; realization < samples; ++realization) {
    const Seconds taken = seconds([&] { sampler.heights(0, realization); });
    wall.push_back(taken.wall);
    processor.push_back(taken.processor);
  }
  return {bench::median(wall), bench::median(processor)};
}

void print_rate(const char* what, double points_a_second, double useful, double peak) {
  fmt::print("{:<24} {:6.2f} million points, {:5.2f} 10^9 multiply-adds: {:.0f} % of the peak\n",
             what, points_a_second * 1e-6, points_a_second * useful * 1e-9,
             100 * points_a_second * useful / peak);
}

}  // namespace

int main() {
  const auto n_threads = static_cast<int>(std::thread::hardware_concurrency());
  const bench::PeakRate peak = bench::peak_rate(n_threads);
  const std::vector<Vec3> points = bench::sphere_points(n_points);
  const double length = length_over_spacing * bench::sphere_spacing(n_points);
  const detail::KernelWidth width = kernel_width();
  const double useful = std::pow(width.n_points, 3);
  fmt::print(
      "{} points, Gaussian, l = 2.5 h, tolerance {:g}: P = {}; {} threads, {} with {} doubles "
      "a vector\n",
      points.size(), tolerance, width.n_points, n_threads, peak.target, peak.lanes);
  fmt::print("a second of processor time of one thread (the threads had {:.0f} % of the cores):\n",
             100 * peak.processor_share);
  fmt::print("{:<24} {:28.2f} 10^9 multiply-adds\n", "peak (reference)", peak.multiply_adds * 1e-9);
  print_rate("gather alone (bar: 25 %)", gather_rate(points, length, width, n_threads), useful,
             peak.multiply_adds);
  const Seconds sample = sample_seconds(points, length);
  print_rate("heights(), with noise", n_points / sample.processor, useful, peak.multiply_adds);
  fmt::print("heights(): {:.3f} s, {:.2f} million points a second on all threads\n", sample.wall,
             n_points / sample.wall * 1e-6);
}
