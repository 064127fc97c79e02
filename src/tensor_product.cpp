// SPDX-License-Identifier: BSD-3-Clause
#include "tensor_product.hpp"

// Highway compiles this file once for every instruction set, and chooses one when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tensor_product.cpp"
// In this order.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace roughmesh::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Size = std::ptrdiff_t;

// Without masks, which read past the end of an array on some instruction sets: Highway allows a
// masked load to fault, and one of SSE is a whole vector at an address that must be aligned.

/// Of add_products(), as many of the columns from `first` on as vectors of d fill; then of shorter
/// vectors, down to one number.
template <std::size_t most_lanes>
void add_columns(const double* a, Size n_rows, Size n_columns, const double* b, Size width,
                 Size first, double* result) {
  const hn::CappedTag<double, most_lanes> d;
  const auto n_lanes = static_cast<Size>(hn::Lanes(d));
  for (; first + n_lanes <= width; first += n_lanes)
    for (Size i = 0; i < n_rows; ++i) {
      auto sum = hn::LoadU(d, result + i * width + first);
      for (Size k = 0; k < n_columns; ++k)
        sum =
            hn::MulAdd(hn::Set(d, a[i * n_columns + k]), hn::LoadU(d, b + k * width + first), sum);
      hn::StoreU(sum, d, result + i * width + first);
    }
  if constexpr (most_lanes > 1)
    if (first < width) add_columns<most_lanes / 2>(a, n_rows, n_columns, b, width, first, result);
}

void add_products(const double* a, Size n_rows, Size n_columns, const double* b, Size width,
                  double* result) {
  add_columns<tensor_lanes>(a, n_rows, n_columns, b, width, 0, result);
}

/// The last vector of a row reaches into the next one, where weights are zero.
double weighted_sum(const double* x, const double* y, const double* z, const double* values, int nx,
                    int ny, int nz) {
  const hn::CappedTag<double, tensor_lanes> d;
  const auto n_lanes = static_cast<int>(hn::Lanes(d));
  auto total = hn::Zero(d);
  for (int first = 0; first < nz; first += n_lanes) {
    auto sum = hn::Zero(d);
    const double* row = values + first;
    for (int i = 0; i < nx; ++i) {
      auto plane = hn::Zero(d);
      for (int j = 0; j < ny; ++j, row += nz)
        plane = hn::MulAdd(hn::Set(d, y[j]), hn::LoadU(d, row), plane);
      sum = hn::MulAdd(hn::Set(d, x[i]), plane, sum);
    }
    total = hn::MulAdd(hn::LoadU(d, z + first), sum, total);
  }
  return hn::GetLane(hn::SumOfLanes(d, total));
}

}  // namespace roughmesh::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace roughmesh::detail {

HWY_EXPORT(add_products);
HWY_EXPORT(weighted_sum);

double interpolate(const std::array<NodeWeights, 3>& weights, const double* values,
                   const std::array<int, 3>& size) {
  return HWY_DYNAMIC_DISPATCH(weighted_sum)(weights[0].data(), weights[1].data(), weights[2].data(),
                                            values, size[0], size[1], size[2]);
}

SmallMatrix zero_matrix(int n_rows, int n_columns) {
  return {
      n_rows, n_columns,
      std::vector<double>(static_cast<std::size_t>(n_rows) * static_cast<std::size_t>(n_columns))};
}

void add_product(const SmallMatrix& a, const double* b, int width, double* result) {
  HWY_DYNAMIC_DISPATCH(add_products)
  (a.entries.data(), a.n_rows, a.n_columns, b, width, result);
}

void add_tensor_product(const std::array<SmallMatrix, 3>& matrices, std::span<const double> values,
                        std::span<double> result) {
  const auto& [x, y, z] = matrices;
  const int plane = y.n_columns * z.n_columns;
  SmallMatrix after_x = zero_matrix(x.n_rows, plane);
  add_product(x, values.data(), plane, after_x.entries.data());
  SmallMatrix after_y = zero_matrix(x.n_rows * y.n_rows, z.n_columns);
  for (int i = 0; i < x.n_rows; ++i)
    add_product(y, &after_x(i, 0), z.n_columns, &after_y(i * y.n_rows, 0));
  SmallMatrix transposed = zero_matrix(z.n_columns, z.n_rows);
  for (int k = 0; k < z.n_rows; ++k)
    for (int c = 0; c < z.n_columns; ++c) transposed(c, k) = z(k, c);
  add_product(after_y, transposed.entries.data(), z.n_rows, result.data());
}

}  // namespace roughmesh::detail
#endif
