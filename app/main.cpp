// SPDX-License-Identifier: BSD-3-Clause
// Entry point: errors become one line on stderr and an exit code.
#include <csignal>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "command_line.hpp"
#include "commands.hpp"

namespace {

using namespace roughmesh;

enum ExitCode { done = 0, check_failed = 1, bad_input = 2, bad_format = 3, numerical = 4 };

// Only async-signal-safe calls: finished files stay, the one being written goes. The shell's
// convention makes an interrupt exit code 130.
extern "C" void on_interrupt(int signal_number) {
  discard_unfinished_files();
  const char message[] =
      "roughmesh: interrupted; finished realizations are kept, go on with --first\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, message, sizeof message - 1);
  _exit(128 + signal_number);
}

void handle_signals() {
  for (const int signal_number : {SIGINT, SIGTERM}) std::signal(signal_number, on_interrupt);
  // Under nohup a hang-up stays ignored.
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  // Closed pipes and file size limits are reported by the failing write instead.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int fail(ExitCode code, const std::string& message) {
  fmt::print(stderr, "roughmesh: {}\n", app::printable(message));
  return code;
}

void run(const std::vector<std::string>& arguments) {
  const app::Command command = app::parse_command_line(arguments);
  switch (command.verb) {
    case app::Verb::help:
    case app::Verb::version:
      fmt::print("{}", command.text);
      break;
    case app::Verb::roughen:
      app::run_roughen(command.options);
      break;
    case app::Verb::info:
      app::run_info(command.options, command.has_rms);
      break;
  }
  if (std::fflush(stdout) != 0)
    throw InputError("standard output: cannot be written; is the disk full?");
}

}  // namespace

int main(int argc, char** argv) {
  handle_signals();
  try {
    run({argv + 1, argv + argc});
    return done;
  } catch (const CheckError& error) {
    return fail(check_failed, error.what());
  } catch (const InputError& error) {
    return fail(bad_input, error.what());
  } catch (const FormatError& error) {
    return fail(bad_format, error.what());
  } catch (const NumericalError& error) {
    return fail(numerical, error.what());
  } catch (const std::bad_alloc&) {
    return fail(bad_input,
                "memory: too little is free for this mesh; use a smaller mesh or a larger machine");
  } catch (const std::exception& error) {
    return fail(numerical, fmt::format("unexpected: {}; please report this", error.what()));
  }
}
