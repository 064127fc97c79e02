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

using Lanes = hn::ScalableTag<double>;
using Vector = hn::Vec<Lanes>;

using Size = std::ptrdiff_t;

void add_products(const double* a, Size n_rows, Size n_columns, const double* b, Size width,
                  double* result) {
  const Lanes d;
  const auto n_lanes = static_cast<Size>(hn::Lanes(d));
  for (Size first = 0; first < width; first += n_lanes) {
    const auto n = static_cast<std::size_t>(width - first);
    const auto mask = hn::FirstN(d, n);
    for (Size i = 0; i < n_rows; ++i) {
      Vector sum = hn::MaskedLoad(mask, d, result + i * width + first);
      for (Size k = 0; k < n_columns; ++k)
        sum = hn::MulAdd(hn::Set(d, a[i * n_columns + k]),
                         hn::MaskedLoad(mask, d, b + k * width + first), sum);
      hn::BlendedStore(sum, mask, d, result + i * width + first);
    }
  }
}

double weighted_sum(const double* x, const double* y, const double* z, const double* values, int nx,
                    int ny, int nz) {
  const Lanes d;
  const auto n_lanes = static_cast<int>(hn::Lanes(d));
  Vector total = hn::Zero(d);
  for (int first = 0; first < nz; first += n_lanes) {
    const auto mask = hn::FirstN(d, static_cast<std::size_t>(nz - first));
    Vector sum = hn::Zero(d);
    const double* row = values + first;
    for (int i = 0; i < nx; ++i) {
      Vector plane = hn::Zero(d);
      for (int j = 0; j < ny; ++j, row += nz)
        plane = hn::MulAdd(hn::Set(d, y[j]), hn::MaskedLoad(mask, d, row), plane);
      sum = hn::MulAdd(hn::Set(d, x[i]), plane, sum);
    }
    total = hn::MulAdd(hn::MaskedLoad(mask, d, z + first), sum, total);
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
