// SPDX-License-Identifier: BSD-3-Clause
#include "parallel.hpp"

#include <algorithm>
#include <thread>

#include <cblas.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace roughmesh::detail {

void parallel_for(std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t step = std::max<std::size_t>(grain, 1);
  const std::size_t n_ranges = (n + step - 1) / step;
  tbb::parallel_for(std::size_t{0}, n_ranges,
                    [&](std::size_t i) { body(i * step, std::min(n, (i + 1) * step)); });
}

struct ThreadLimit::Limits {
  explicit Limits(int n)
      : previous_blas_threads(openblas_get_num_threads()),
        tbb_limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n)) {
    openblas_set_num_threads(n);
  }
  ~Limits() { openblas_set_num_threads(previous_blas_threads); }
  Limits(const Limits&) = delete;
  Limits& operator=(const Limits&) = delete;

  int previous_blas_threads;
  tbb::global_control tbb_limit;
};

ThreadLimit::ThreadLimit(int n_threads)
    : n_threads_(n_threads > 0
                     ? n_threads
                     : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))),
      limits_(std::make_unique<Limits>(n_threads_)) {}

ThreadLimit::~ThreadLimit() = default;

}  // namespace roughmesh::detail
