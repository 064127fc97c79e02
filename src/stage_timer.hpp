// SPDX-License-Identifier: BSD-3-Clause
// Tells of the stages of a run as they begin, and adds up what each takes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "roughmesh/pipeline.hpp"
#include "roughmesh/report.hpp"

namespace roughmesh::detail {

/// Adds the wall-clock time of its life to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

/// @param timings, watch  outlive it
class StageTimer {
 public:
  StageTimer(Timings& timings, const Watch& watch) : timings_(timings), watch_(watch) {}
  StageTimer(Timings&, Watch&&) = delete;

  /// Stages that follow belong to this one.
  void begin_realization(std::uint64_t realization) { realization_ = realization; }

  /// Runs a stage: tells that it begins, and adds its time to that of its name.
  template <class Stage>
  std::invoke_result_t<Stage> time(double Timings::*seconds, Stage&& stage) {
    double& spent = timings_.*seconds;
    if (watch_) watch_({name_of(spent), realization_});
    const Stopwatch stopwatch(spent);
    return stage();
  }

 private:
  std::string_view name_of(const double& seconds) const {
    std::string_view found;
    for_each_timing(timings_, [&](std::string_view name, const double& each) {
      if (&each == &seconds) found = name;
    });
    return found;
  }

  Timings& timings_;
  const Watch& watch_;
  std::optional<std::uint64_t> realization_;  // being made
};

}  // namespace roughmesh::detail
