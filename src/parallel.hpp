// SPDX-License-Identifier: BSD-3-Clause
// Threads: the only file that knows them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

namespace roughmesh::detail {

/// Calls body(begin, end) on disjoint ranges that cover [0, n), on several threads. The ranges
/// depend on n and grain only, never on the number of threads, so that a sum per range is the same
/// on any of them.
void parallel_for(std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// A value for each thread, made when a thread first asks for its own.
template <class T>
class PerThread {
 public:
  T& local() { return values_.local(); }

 private:
  tbb::enumerable_thread_specific<T> values_;
};

/// Sorts on several threads. `less` has to tell any two elements apart: then the result is the same
/// on any number of them.
template <class T, class Less>
void parallel_sort(std::span<T> values, Less&& less) {
  tbb::parallel_sort(values.begin(), values.end(), std::forward<Less>(less));
}

/// Threads of parallel_for and of the linear algebra library while it lives; 0 means one per core.
class ThreadLimit {
 public:
  explicit ThreadLimit(int n_threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  int n_threads() const { return n_threads_; }

 private:
  struct Limits;
  int n_threads_ = 0;
  std::unique_ptr<Limits> limits_;
};

}  // namespace roughmesh::detail
