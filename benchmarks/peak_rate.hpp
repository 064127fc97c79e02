// SPDX-License-Identifier: BSD-3-Clause
// What the processor can do at most: the reference of rates.
#pragma once

#include <string>

namespace roughmesh::bench {

/// Multiply-adds of doubles a second, from registers alone, with the widest vectors that the
/// processor has, while `n_threads` threads do the same.
struct PeakRate {
  double multiply_adds = 0;    ///< a second of processor time of one thread
  double processor_share = 0;  ///< of the processor time that the threads could have had
  std::string target;          ///< instruction set
  int lanes = 0;               ///< doubles a vector
};

PeakRate peak_rate(int n_threads);

}  // namespace roughmesh::bench
