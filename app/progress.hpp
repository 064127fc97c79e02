// SPDX-License-Identifier: BSD-3-Clause
// Where a run is, on a terminal: one line that rewrites itself.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "roughmesh/pipeline.hpp"

namespace roughmesh::app {

/// What the line tells. Times are seconds on one clock.
struct ProgressState {
  std::uint64_t n_wanted = 1, n_done = 0;  ///< realizations
  std::string stage = "read";              ///< that runs
  double stage_start = 0;
  std::optional<double> first_start = {};  ///< of the first realization
  double last_end = 0;                     ///< of the last realization that is done

  void begin(const Progress& progress, double now);
  void finish_realization(double now);
};

/// "[#####               ] 25/100  field  12 s left". Realizations are taken to go on as those done
/// so far, without what all have in common.
std::string progress_line(const ProgressState& state, double now);

/// Shows it several times a second on a terminal, from a thread of its own; elsewhere and with
/// --quiet, nothing.
class ProgressBar {
 public:
  explicit ProgressBar(const RoughenOptions& options);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void begin(const Progress& progress);
  void finish_realization();

 private:
  double now() const;
  void show_until_stopped();

  std::chrono::steady_clock::time_point origin_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool is_stopped_ = false;
  ProgressState state_;
  std::thread display_;
};

}  // namespace roughmesh::app
