// SPDX-License-Identifier: BSD-3-Clause
#include "interrupt.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>

#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

namespace roughmesh::app {
namespace {

std::atomic<int> signal_that_came = 0;
std::atomic<bool> has_grace = false, has_terminal = false, has_files = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

template <std::size_t N>
void print(const char (&text)[N]) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text, N - 1);
}

// Only async-signal-safe calls. The shell's convention makes an interrupt exit code 130.
[[noreturn]] void leave(int signal_number) {
  discard_unfinished_files();
  if (has_terminal) print("\n");  // below the progress bar
  if (has_files)
    print(
        "roughmesh: interrupted; finished realizations are kept, go on with --first and a --report "
        "of its own\n");
  else
    print("roughmesh: interrupted; nothing was written\n");
  _exit(128 + signal_number);
}

extern "C" void on_interrupt(int signal_number) {
  if (!has_grace || signal_that_came != 0) leave(signal_number);
  signal_that_came = signal_number;
  alarm(1);
}

extern "C" void on_alarm(int) { leave(signal_that_came); }

}  // namespace

void handle_signals() {
  has_terminal = isatty(STDERR_FILENO) != 0;
  for (const int signal_number : {SIGINT, SIGTERM}) std::signal(signal_number, on_interrupt);
  // Under nohup a hang-up stays ignored.
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGALRM, on_alarm);
  // Closed pipes and file size limits are reported by the failing write instead.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

GracePeriod::GracePeriod() { has_grace = true; }
GracePeriod::~GracePeriod() { has_grace = false; }

void note_finished_files() { has_files = true; }

int interrupted() { return signal_that_came; }

}  // namespace roughmesh::app
