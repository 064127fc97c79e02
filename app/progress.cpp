// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace roughmesh::app {
namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::max(0.0, seconds));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min", whole / 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

/// Realizations that are like those done so far, the running one included.
double seconds_left(const ProgressState& state, double now) {
  const double each =
      (state.last_end - state.first_start.value_or(0)) / static_cast<double>(state.n_done);
  return each * static_cast<double>(state.n_wanted - state.n_done) - (now - state.last_end);
}

}  // namespace

void ProgressState::begin(const Progress& progress, double now) {
  stage = progress.stage;
  stage_start = now;
  if (progress.realization && !first_start) first_start = now;
}

void ProgressState::finish_realization(double now) {
  ++n_done;
  last_end = now;
}

std::string progress_line(const ProgressState& state, double now) {
  constexpr std::uint64_t width = 20;
  std::string line;
  if (state.n_wanted > 1) {
    const double share = static_cast<double>(state.n_done) / static_cast<double>(state.n_wanted);
    const std::string filled(static_cast<std::size_t>(width * share), '#');
    line = fmt::format("[{:<{}}] {}/{}  ", filled, width, state.n_done, state.n_wanted);
  }
  line += state.stage;
  if (state.n_done > 0) return line + "  " + duration(seconds_left(state, now)) + " left";
  return line + "  " + duration(now - state.stage_start);
}

ProgressBar::ProgressBar(const RoughenOptions& options) {
  state_.n_wanted = options.realizations;
  if (!options.quiet && isatty(STDERR_FILENO) != 0)
    display_ = std::thread([this] { show_until_stopped(); });
}

ProgressBar::~ProgressBar() {
  if (!display_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  stopped_.notify_one();
  display_.join();
}

double ProgressBar::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - origin_).count();
}

void ProgressBar::begin(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  state_.begin(progress, now());
}

void ProgressBar::finish_realization() {
  const std::lock_guard lock(mutex_);
  state_.finish_realization(now());
}

void ProgressBar::show_until_stopped() {
  constexpr std::chrono::milliseconds pause(200);
  std::unique_lock lock(mutex_);
  while (!stopped_.wait_for(lock, pause, [&] { return is_stopped_; })) {
    fmt::print(stderr, "\r{:79}", progress_line(state_, now()));
    std::fflush(stderr);
  }
  fmt::print(stderr, "\r{:79}\r", "");
  std::fflush(stderr);
}

}  // namespace roughmesh::app
