// SPDX-License-Identifier: BSD-3-Clause
// Linear systems whose unknowns are displacements, with others given.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "roughmesh/mesh.hpp"

#include "conjugate_gradients.hpp"

namespace roughmesh::detail {

/// Of a sparse matrix.
struct Entry {
  Index column = 0;
  double value = 0;
};

/// A row under construction: some fifteen columns, where a search from the start beats any index. A
/// hub with very many neighbours collects what comes after the first ones, to be merged in the end.
class Row {
 public:
  void clear() { entries_.clear(); }
  void add(Index column, double value) {
    const auto at = is_long() ? entries_.end()
                              : std::find_if(entries_.begin(), entries_.end(),
                                             [&](const Entry& e) { return e.column == column; });
    if (at == entries_.end())
      entries_.push_back({column, value});
    else
      at->value += value;
  }
  std::span<const Entry> sorted() {
    if (is_long()) {
      merge();
    } else {
      std::sort(entries_.begin(), entries_.end(), by_column);
    }
    return entries_;
  }

 private:
  static constexpr std::size_t most_searched = 64;

  static bool by_column(const Entry& a, const Entry& b) { return a.column < b.column; }
  bool is_long() const { return entries_.size() >= most_searched; }

  // Stable, so that the values of a column are added in the order in which they came.
  void merge() {
    std::stable_sort(entries_.begin(), entries_.end(), by_column);
    std::size_t last = 0;
    for (std::size_t i = 1; i < entries_.size(); ++i) {
      if (entries_[i].column == entries_[last].column)
        entries_[last].value += entries_[i].value;
      else
        entries_[++last] = entries_[i];
    }
    entries_.resize(last + 1);
  }

  std::vector<Entry> entries_;
};

/// Consecutive rows of a matrix.
struct RowRange {
  std::vector<Index> sizes;
  std::vector<Index> columns;
  std::vector<double> values;

  void append(std::span<const Entry> row) {
    sizes.push_back(static_cast<Index>(row.size()));
    for (const Entry& entry : row) {
      columns.push_back(entry.column);
      values.push_back(entry.value);
    }
  }
};

/// K u = -C g, with the rows of K (by unknowns) and C (by given displacements) side by side.
class ExtensionSystem {
 public:
  /// Appends the rows `begin` to `end` of K and C, columns of each in ascending order.
  using MakeRows = std::function<void(std::size_t begin, std::size_t end, RowRange& stiffness,
                                      RowRange& coupling)>;

  /// @param make_rows  called from several threads, for disjoint ranges
  /// @param sliding    unknowns that stay in a plane or on a line
  ExtensionSystem(Index n_unknown, Index n_given, const MakeRows& make_rows,
                  std::vector<SlidingRow> sliding = {});

  /// @param given  n_given displacements, finite
  /// @return       n_unknown displacements; the same bits on any number of threads
  /// @throws NumericalError  conjugate gradients did not come near a solution
  std::vector<Vec3> extend(std::span<const Vec3> given) const;

  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const Matrix& stiffness() const { return stiffness_; }  ///< K, which has to be positive definite

 private:
  static void join(const std::vector<RowRange>& ranges, Index n_rows, Index n_columns,
                   Matrix& matrix);

  Matrix stiffness_;
  Matrix coupling_;
  std::vector<SlidingRow> sliding_;
};

}  // namespace roughmesh::detail
