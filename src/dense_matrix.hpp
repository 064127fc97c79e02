// SPDX-License-Identifier: BSD-3-Clause
// A large dense matrix that owns no more memory than it says.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace roughmesh::detail {

/// Column-major, entries uninitialized: pages that are never written cost nothing, and those that
/// are get placed by the thread that writes them.
class DenseMatrix {
 public:
  /// @throws std::bad_alloc
  DenseMatrix(std::size_t n_rows, std::size_t n_columns)
      : n_rows_(n_rows), n_columns_(n_columns), entries_(allocate(n_rows, n_columns)) {}

  std::size_t n_rows() const { return n_rows_; }
  std::size_t n_columns() const { return n_columns_; }
  double* column(std::size_t j) { return entries_.get() + j * n_rows_; }
  const double* column(std::size_t j) const { return entries_.get() + j * n_rows_; }
  double& operator()(std::size_t i, std::size_t j) { return column(j)[i]; }
  double operator()(std::size_t i, std::size_t j) const { return column(j)[i]; }

  /// Gives the memory of all but the first n columns back, in place where the system can.
  void keep_columns(std::size_t n) {
    auto* const shrunk =
        static_cast<double*>(std::realloc(entries_.get(), n_rows_ * n * sizeof(double)));
    if (!shrunk) return;  // the larger block is still ours and still right
    (void)entries_.release();
    entries_.reset(shrunk);
    n_columns_ = n;
  }

 private:
  struct Free {
    void operator()(double* entries) const { std::free(entries); }
  };

  static double* allocate(std::size_t n_rows, std::size_t n_columns) {
    if (n_columns != 0 && n_rows > static_cast<std::size_t>(-1) / sizeof(double) / n_columns)
      throw std::bad_array_new_length();
    auto* const entries = static_cast<double*>(std::malloc(n_rows * n_columns * sizeof(double)));
    if (!entries) throw std::bad_alloc();
    return entries;
  }

  std::size_t n_rows_;
  std::size_t n_columns_;
  std::unique_ptr<double[], Free> entries_;
};

}  // namespace roughmesh::detail
