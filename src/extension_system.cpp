// SPDX-License-Identifier: BSD-3-Clause
#include "extension_system.hpp"

#include <fmt/format.h>

#include "roughmesh/error.hpp"

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::size_t rows_per_range = 1024;

/// Very bad elements keep the residual above what is aimed at. What is reached moves nodes as well,
/// and every mesh is checked.
constexpr double largest_residual = 1e-6;

void require_convergence(const Solution& solution) {
  if (solution.converged || solution.residual <= largest_residual) return;
  throw NumericalError(fmt::format(
      "conjugate gradients for the volume stopped after {} iterations at a relative residual of "
      "{:.1e}, above {:.0e}; improve the worst elements of the input mesh",
      solution.iterations, solution.residual, largest_residual));
}

}  // namespace

void ExtensionSystem::join(const std::vector<RowRange>& ranges, Index n_rows, Index n_columns,
                           Matrix& matrix) {
  matrix.resize(n_rows, n_columns);
  Index* offsets = matrix.outerIndexPtr();
  std::size_t row = 0;
  for (const RowRange& range : ranges)
    for (const Index size : range.sizes) {
      offsets[row + 1] = offsets[row] + size;
      ++row;
    }
  matrix.resizeNonZeros(offsets[n_rows]);
  parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t) {
    const Index first = offsets[begin * rows_per_range];
    std::copy(ranges[begin].columns.begin(), ranges[begin].columns.end(),
              matrix.innerIndexPtr() + first);
    std::copy(ranges[begin].values.begin(), ranges[begin].values.end(), matrix.valuePtr() + first);
  });
}

ExtensionSystem::ExtensionSystem(Index n_unknown, Index n_given, const MakeRows& make_rows,
                                 std::vector<SlidingRow> sliding)
    : sliding_(std::move(sliding)) {
  const auto n = static_cast<std::size_t>(n_unknown);
  std::vector<RowRange> stiffness((n + rows_per_range - 1) / rows_per_range);
  std::vector<RowRange> coupling(stiffness.size());
  parallel_for(n, rows_per_range, [&](std::size_t begin, std::size_t end) {
    const std::size_t range = begin / rows_per_range;
    make_rows(begin, end, stiffness[range], coupling[range]);
  });
  join(stiffness, n_unknown, n_unknown, stiffness_);
  join(coupling, n_unknown, n_given, coupling_);
}

std::vector<Vec3> ExtensionSystem::extend(std::span<const Vec3> given) const {
  std::vector<Vec3> load(static_cast<std::size_t>(stiffness_.rows()), Vec3::Zero());
  parallel_for(load.size(), rows_per_range, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (Matrix::InnerIterator entry(coupling_, static_cast<Index>(i)); entry; ++entry)
        load[i] -= entry.value() * given[entry.col()];
  });
  Solution solution = solve(stiffness_, load, sliding_);
  require_convergence(solution);
  return std::move(solution.values);
}

}  // namespace roughmesh::detail
