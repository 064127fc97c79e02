// SPDX-License-Identifier: BSD-3-Clause
// Signals that end a run: finished files stay, the one being written goes.
#pragma once

#include <stdexcept>
#include <string>

namespace roughmesh::app {

/// Installs handlers that leave at once with exit code 128 + signal, but for the times below.
void handle_signals();

/// While one lives, an interrupt is given a second in which the program may end by itself.
class GracePeriod {
 public:
  GracePeriod();
  ~GracePeriod();
  GracePeriod(const GracePeriod&) = delete;
  GracePeriod& operator=(const GracePeriod&) = delete;
};

/// From now on an interrupt says how to go on.
void note_finished_files();

/// The signal that came in a grace period; 0: none.
int interrupted();

/// A run that ended by itself after an interrupt.
class Interrupt : public std::runtime_error {
 public:
  explicit Interrupt(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace roughmesh::app
