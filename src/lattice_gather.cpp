// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_gather.hpp"

#include <algorithm>

// Highway compiles this file once for every instruction set, and chooses one when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lattice_gather.cpp"
// In this order.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace roughmesh::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, gather_lanes>;
using Vector = hn::Vec<Lanes>;

/// Kernels of one axis at as many places as a vector has lanes: place `lane` has its weights in
/// weight[p * lanes + lane].
struct AxisBatch {
  alignas(64) std::array<double, std::size_t{most_lattice_points} * gather_lanes> weight;
  alignas(64) std::array<double, gather_lanes> first;
};

/// exp(-c (d - p)^2) for p = 0, 1, ... by two exponentials: the factor from one p to the next is
/// exp(2 c d) exp(-c (2 p + 1)). L. Greengard and J.-Y. Lee (2004), doi:10.1137/S003614450343200X.
void write_batch(const LatticeAxis& axis, const double* places, AxisBatch& batch) {
  const Lanes d;
  const std::size_t n_lanes = hn::Lanes(d);
  const Vector x = hn::Mul(hn::LoadU(d, places), hn::Set(d, axis.inverse_spacing()));
  const Vector first = axis.varies() ? hn::Floor(hn::Add(x, hn::Set(d, axis.lead()))) : hn::Zero(d);
  const Vector offset = hn::Sub(x, first);
  const Vector scaled = hn::Mul(offset, hn::Set(d, axis.exponent()));
  const Vector step = hn::Exp(d, hn::Add(scaled, scaled));
  Vector weight = hn::Exp(d, hn::Neg(hn::Mul(scaled, offset)));
  Vector squares = hn::Mul(weight, weight);
  hn::StoreU(first, d, batch.first.data());
  hn::StoreU(weight, d, batch.weight.data());
  for (int p = 1; p < axis.n_points(); ++p) {
    weight = hn::Mul(hn::Mul(weight, hn::Set(d, axis.step(p))), step);
    squares = hn::MulAdd(weight, weight, squares);
    hn::StoreU(weight, d, batch.weight.data() + p * n_lanes);
  }
  const Vector factor = axis.amplitude() > 0 ? hn::Set(d, axis.amplitude())
                                             : hn::Div(hn::Set(d, 1.0), hn::Sqrt(squares));
  for (int p = 0; p < axis.n_points(); ++p) {
    double* const w = batch.weight.data() + p * n_lanes;
    hn::StoreU(hn::Mul(factor, hn::LoadU(d, w)), d, w);
  }
}

void pick(const LatticeAxis& axis, const AxisBatch& batch, std::size_t lane, AxisWeights& result) {
  const std::size_t n_lanes = hn::Lanes(Lanes());
  result.first = static_cast<std::int64_t>(batch.first[lane]);
  for (int p = 0; p < axis.n_points(); ++p) result.weight[p] = batch.weight[p * n_lanes + lane];
}

/// The same from the last multiple of the lanes in a column of the box on, with zeros around the
/// kernel; returns how many vectors that makes.
std::ptrdiff_t pick_aligned(const LatticeAxis& axis, const AxisBatch& batch, std::size_t lane,
                            std::int64_t column_first, AxisWeights& result) {
  const Lanes d;
  const auto n_lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const auto first = static_cast<std::int64_t>(batch.first[lane]);
  const std::ptrdiff_t lead = (first - column_first) % n_lanes;
  const std::ptrdiff_t n_vectors = (lead + axis.n_points() + n_lanes - 1) / n_lanes;
  result.first = first - lead;
  hn::Store(hn::Zero(d), d, result.weight.data());
  hn::Store(hn::Zero(d), d, result.weight.data() + (n_vectors - 1) * n_lanes);
  for (int p = 0; p < axis.n_points(); ++p)
    result.weight[lead + p] = batch.weight[p * n_lanes + lane];
  return n_vectors;
}

void write_weights(const LatticeAxis& axis, std::span<const double> places,
                   std::span<AxisWeights> result) {
  const std::size_t n_lanes = hn::Lanes(Lanes());
  AxisBatch batch;
  std::array<double, gather_lanes> x;
  for (std::size_t i = 0; i < places.size(); i += n_lanes) {
    const std::size_t n = std::min(n_lanes, places.size() - i);
    for (std::size_t lane = 0; lane < n_lanes; ++lane) x[lane] = places[i + std::min(lane, n - 1)];
    write_batch(axis, x.data(), batch);
    for (std::size_t lane = 0; lane < n; ++lane) pick(axis, batch, lane, result[i + lane]);
  }
}

/// The columns of a box under the kernel at one place, and their weights, each n_lanes numbers
/// apart.
struct Columns {
  const double* origin;
  std::int64_t x_stride, y_stride;
  const double *wx, *wy;
  int nx, ny;
};

/// Sum of the columns under the weights of the first two axes, n_vectors side by side.
template <int n_vectors>
HWY_INLINE void sum_columns(const Columns& columns, Vector* sums) {
  const Lanes d;
  const auto [origin, x_stride, y_stride, wx, wy, nx, ny] = columns;
  const std::size_t n_lanes = hn::Lanes(d);
  for (int v = 0; v < n_vectors; ++v) sums[v] = hn::Zero(d);
  for (int i = 0; i < nx; ++i) {
    Vector plane[n_vectors];  // NOLINT(*-avoid-c-arrays): a register file, not a container
    for (int v = 0; v < n_vectors; ++v) plane[v] = hn::Zero(d);
    const double* row = origin + i * x_stride;
    for (int j = 0; j < ny; ++j, row += y_stride) {
      const Vector w = hn::Set(d, wy[j * n_lanes]);
      for (int v = 0; v < n_vectors; ++v)
        plane[v] = hn::MulAdd(w, hn::Load(d, row + v * n_lanes), plane[v]);
    }
    const Vector w = hn::Set(d, wx[i * n_lanes]);
    for (int v = 0; v < n_vectors; ++v) sums[v] = hn::MulAdd(w, plane[v], sums[v]);
  }
}

template <int n_vectors>
HWY_INLINE double sum_box(const Columns& columns, const double* wz) {
  const Lanes d;
  Vector sums[n_vectors];  // NOLINT(*-avoid-c-arrays)
  sum_columns<n_vectors>(columns, sums);
  Vector total = hn::Zero(d);
  for (int v = 0; v < n_vectors; ++v)
    total = hn::MulAdd(sums[v], hn::Load(d, wz + v * hn::Lanes(d)), total);
  return hn::GetLane(hn::SumOfLanes(d, total));
}

HWY_INLINE double sum_at(Columns columns, const double* wz, std::ptrdiff_t n_vectors) {
  const auto n_lanes = static_cast<std::ptrdiff_t>(hn::Lanes(Lanes()));
  double sum = 0;
  for (; n_vectors >= 4; n_vectors -= 4, columns.origin += 4 * n_lanes, wz += 4 * n_lanes)
    sum += sum_box<4>(columns, wz);
  if (n_vectors == 3) sum += sum_box<3>(columns, wz);
  if (n_vectors == 2) sum += sum_box<2>(columns, wz);
  if (n_vectors == 1) sum += sum_box<1>(columns, wz);
  return sum;
}

void gather_members(const std::array<LatticeAxis, 3>& axes, const LatticeBox& box,
                    std::span<const std::uint32_t> members, const Vec3* places, double* sums) {
  const std::size_t n_lanes = hn::Lanes(Lanes());
  std::array<std::array<double, gather_lanes>, 3> x;
  std::array<AxisBatch, 3> batch;
  AxisWeights z;
  for (std::size_t m = 0; m < members.size(); m += n_lanes) {
    const std::size_t n = std::min(n_lanes, members.size() - m);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        x[a][lane] = places[members[m + std::min(lane, n - 1)]][static_cast<int>(a)];
      write_batch(axes[a], x[a].data(), batch[a]);
    }
    for (std::size_t lane = 0; lane < n; ++lane) {
      const std::ptrdiff_t n_vectors = pick_aligned(axes[2], batch[2], lane, box.first[2], z);
      const double* const column =
          box.column(static_cast<std::int64_t>(batch[0].first[lane]) - box.first[0],
                     static_cast<std::int64_t>(batch[1].first[lane]) - box.first[1]);
      const Columns columns{column + (z.first - box.first[2]),
                            box.size[1] * box.column_length(),
                            box.column_length(),
                            &batch[0].weight[lane],
                            &batch[1].weight[lane],
                            axes[0].n_points(),
                            axes[1].n_points()};
      sums[m + lane] = sum_at(columns, z.weight.data(), n_vectors);
    }
  }
}

}  // namespace roughmesh::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace roughmesh::detail {

HWY_EXPORT(write_weights);
HWY_EXPORT(gather_members);

void kernel_weights(const LatticeAxis& axis, std::span<const double> places,
                    std::span<AxisWeights> result) {
  HWY_DYNAMIC_DISPATCH(write_weights)(axis, places, result);
}

AxisWeights kernel_weights(const LatticeAxis& axis, double x) {
  AxisWeights result;
  kernel_weights(axis, {&x, 1}, {&result, 1});
  return result;
}

void gather(const std::array<LatticeAxis, 3>& axes, const LatticeBox& box,
            std::span<const std::uint32_t> members, const Vec3* places, double* sums) {
  HWY_DYNAMIC_DISPATCH(gather_members)(axes, box, members, places, sums);
}

}  // namespace roughmesh::detail
#endif
