// SPDX-License-Identifier: BSD-3-Clause
// The same heights of the method `lattice` on other meshes, threads and in any company.
#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "roughmesh/field.hpp"

#include "parallel.hpp"
#include "support/instruction_sets.hpp"
#include "support/lattice_cases.hpp"
#include "support/lattice_rows.hpp"

namespace roughmesh {
namespace {

using test::largest_difference;
using test::lattice_sampler;

const Autocorrelation gaussian({.family = Family::gaussian, .length = 0.4});
const Autocorrelation exponential({.family = Family::exponential, .length = 0.4});

std::vector<double> heights(const std::vector<Vec3>& places, const Autocorrelation& rho,
                            const FieldOptions& options = {}) {
  return lattice_sampler(places, rho, Distance::euclidean(), options).heights(2020, 3);
}

/// Every family with its options under which heights are a function of the place.
struct SameField {
  std::string name;
  Autocorrelation rho;
  FieldOptions options;
};

std::vector<SameField> same_fields() {
  std::vector<SameField> fields = {{"gaussian", gaussian, {}}};
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4))
    fields.push_back({name + " under a cutoff", Autocorrelation(autocorrelation), {.cutoff = 0.1}});
  return fields;
}

/// Places or heights with these numbers.
template <class T>
std::vector<T> picked(const std::vector<T>& all, const std::vector<Index>& numbers) {
  std::vector<T> result;
  result.reserve(numbers.size());
  for (const Index i : numbers) result.push_back(all[static_cast<std::size_t>(i)]);
  return result;
}

// The nodes of a mesh come first in its refinement.
TEST(SameLatticeField, OnARefinedMesh) {
  const std::vector<Vec3> coarse = test::icosphere(2).nodes, fine = test::icosphere(4).nodes;
  ASSERT_EQ(coarse[100], fine[100]);
  for (const auto& [name, rho, options] : same_fields()) {
    std::vector<double> d = heights(fine, rho, options);
    d.resize(coarse.size());
    EXPECT_LT(largest_difference(heights(coarse, rho, options), d), 1e-12) << name;
  }
}

// Whatever other places there are: few, of another bounding box, far away, or close by.
TEST(SameLatticeField, OnAnyPartOfAMesh) {
  std::vector<Vec3> whole = test::icosphere(3).nodes;
  whole.emplace_back(50, -60, 70);
  whole.emplace_back(-1e4, 2, 3);
  whole.emplace_back(whole[17] + Vec3(1e-7, 0, 0));
  for (const SameField& field : same_fields()) {
    const std::vector<double> d = heights(whole, field.rho, field.options);
    const auto expect_same = [&](const std::vector<Index>& numbers) {
      EXPECT_LT(largest_difference(heights(picked(whole, numbers), field.rho, field.options),
                                   picked(d, numbers)),
                1e-12)
          << field.name;
    };
    expect_same({17});
    expect_same({30, 31});
    expect_same({5, 9, 17, 300, 640});
    std::vector<Index> cap;  // of the sphere
    for (Index i = 0; i < 642; ++i)
      if (whole[static_cast<std::size_t>(i)].x() > 0.8) cap.push_back(i);
    ASSERT_GT(cap.size(), 40U);
    expect_same(cap);
  }
}

// Cells that tell a billion lengths apart hold 10^10 lattice points: too many to make at once.
TEST(SameLatticeField, InABodyOfManyLengths) {
  const std::vector<Vec3> sphere = test::scaled(test::icosphere(2).nodes, 400);
  std::vector<Vec3> both = test::moved(sphere, {4e9, 0, 0});
  both.insert(both.begin(), sphere.begin(), sphere.end());
  std::vector<double> d = heights(both, gaussian);
  d.resize(sphere.size());
  EXPECT_LT(largest_difference(heights(sphere, gaussian), d), 1e-12);
}

TEST(SameLatticeField, WhateverTheOrderOfThePlaces) {
  const std::vector<Vec3> places = test::icosphere(3).nodes;
  std::vector<Index> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  const std::vector<Vec3> shuffled = picked(places, order);
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4)) {
    const Autocorrelation rho(autocorrelation);
    EXPECT_LT(largest_difference(heights(shuffled, rho), picked(heights(places, rho), order)),
              1e-12)
        << name;
  }
}

TEST(SameLatticeField, IsSaidOfOneGaussianAndUnderACutoffOnly) {
  const std::vector<Vec3> places = test::icosphere(2).nodes;
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(0.4)) {
    const Autocorrelation rho(autocorrelation);
    const auto is_same = [&](const FieldOptions& options) {
      return lattice_sampler(places, rho, Distance::euclidean(), options)
          .summary()
          .lattice->same_on_other_meshes;
    };
    EXPECT_EQ(is_same({}), name == "gaussian") << name;
    EXPECT_TRUE(is_same({.cutoff = 0.1})) << name;
  }
  const Autocorrelation square({.family = Family::stretched, .length = 0.4, .power = 2.0});
  EXPECT_TRUE(lattice_sampler(places, square, Distance::euclidean())
                  .summary()
                  .lattice->same_on_other_meshes);
}

// An exponential has as much detail as a mesh can show, so that another mesh gets other heights.
TEST(SameLatticeField, IsNotSaidOfAnExponentialNorTrueOfIt) {
  const std::vector<Vec3> coarse = test::icosphere(2).nodes;
  std::vector<double> fine = heights(test::icosphere(3).nodes, exponential);
  fine.resize(coarse.size());
  EXPECT_GT(largest_difference(heights(coarse, exponential), fine), 0.1);
}

TEST(SameLatticeField, OnAnyNumberOfThreads) {
  const std::vector<Vec3> places = test::icosphere(4).nodes;
  for (const auto& [name, autocorrelation] : test::some_autocorrelations(0.3)) {
    const Autocorrelation rho(autocorrelation);
    const auto on_threads = [&](int n) {
      const detail::ThreadLimit limit(n);
      return heights(places, rho);
    };
    const std::vector<double> one = on_threads(1);
    EXPECT_EQ(one, on_threads(2)) << name;
    EXPECT_EQ(one, on_threads(7)) << name;
  }
}

/// Heights of a sampler made and drawn from on each instruction set: as on the first of them, but
/// for the rounding of some thousand terms of order 1, with fused multiply-adds or without.
void expect_same_on_every_instruction_set(const std::vector<Vec3>& places,
                                          const Autocorrelation& rho, const Distance& distance,
                                          const FieldOptions& options) {
  std::vector<double> first;
  test::on_every_instruction_set([&] {
    const std::vector<double> d = lattice_sampler(places, rho, distance, options).heights(20, 1);
    if (first.empty()) first = d;
    EXPECT_LT(largest_difference(d, first), 1e-12);
  });
}

// Lengths many times the distance of neighbours: levels are fine and coarse.
TEST(SameLatticeField, OnEveryInstructionSet) {
  const std::vector<Vec3> plate = test::graded_plate(12), sphere = test::icosphere(3).nodes;
  const Distance space = Distance::euclidean();
  const FieldOptions in_plane{.dimension = 2}, in_space{.tolerance = 1e-2};
  for (const auto& [name, autocorrelation] : test::all_autocorrelations(2)) {
    SCOPED_TRACE(name);
    const Autocorrelation rho(autocorrelation);
    expect_same_on_every_instruction_set(plate, rho, space, in_plane);
    expect_same_on_every_instruction_set(sphere, rho, space, in_space);
  }
  for (const Autocorrelation& rho : {gaussian, exponential})
    for (const Vec3& period : {Vec3(2, 3, 0), Vec3(1, 1.25, 1.5)})
      expect_same_on_every_instruction_set(plate, rho, Distance::periodic(period), in_space);
  const Autocorrelation rough({.family = Family::exponential, .length = 2});
  EXPECT_GE(test::n_coarse_levels({plate, rough, space}, in_plane), 2U);
  EXPECT_GE(test::n_coarse_levels({sphere, rough, space}, in_space), 2U);
}

TEST(SameLatticeField, AloneAndAmongTen) {
  const std::vector<Vec3> places = test::icosphere(2).nodes;
  for (const auto& [name, autocorrelation] : test::some_autocorrelations(0.4)) {
    const Autocorrelation rho(autocorrelation);
    const FieldSampler among = lattice_sampler(places, rho, Distance::euclidean());
    std::vector<std::vector<double>> ten;
    for (std::uint64_t k = 0; k < 10; ++k) ten.push_back(among.heights(1, k));
    const FieldSampler alone = lattice_sampler(places, rho, Distance::euclidean());
    EXPECT_EQ(alone.heights(1, 7), ten[7]) << name;
    EXPECT_EQ(among.heights(1, 7), ten[7]) << name;
    EXPECT_GT(largest_difference(ten[6], ten[7]), 0.1) << name;
    EXPECT_GT(largest_difference(among.heights(2, 7), ten[7]), 0.1) << name;
  }
}

// Powers of two change no bit of a place in units of the length, nor of any scale or cell: all are
// products and quotients of lengths, and roots of their squares.
TEST(SameLatticeField, InAnyUnitOfLength) {
  const std::vector<Vec3> places = test::icosphere(2).nodes;
  for (std::size_t k = 0; k < test::all_autocorrelations(1).size(); ++k)
    for (const double unit : {0x1p-30, 1024.0}) {
      const Autocorrelation small(test::all_autocorrelations(0.5)[k].options);
      const Autocorrelation large(test::all_autocorrelations(0.5 * unit)[k].options);
      EXPECT_EQ(heights(places, small), heights(test::scaled(places, unit), large))
          << test::all_autocorrelations(1)[k].name;
    }
}

}  // namespace
}  // namespace roughmesh
