// SPDX-License-Identifier: BSD-3-Clause
// Entry point: errors become one line on stderr and an exit code.
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command_line.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "memory.hpp"

namespace {

using namespace roughmesh;

enum ExitCode { done = 0, check_failed = 1, bad_input = 2, bad_format = 3, numerical = 4 };

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
  app::keep_freed_memory();
  app::handle_signals();
  try {
    run({argv + 1, argv + argc});
    return done;
  } catch (const app::Interrupt& interrupt) {
    fail(done, interrupt.what());
    return 128 + app::interrupted();
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
