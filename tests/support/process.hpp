// SPDX-License-Identifier: BSD-3-Clause
// Runs programs as a user would.
#pragma once

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include <sys/wait.h>

#include "support/files.hpp"

namespace roughmesh::test {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string out, err;
};

/// One line of shell, run in `folder`.
inline Outcome run_in(const TemporaryFolder& folder, const std::string& line) {
  const std::string out = (folder.path() / ".stdout").string();
  const std::string err = (folder.path() / ".stderr").string();
  const std::string command =
      "cd '" + folder.path().string() + "' && { " + line + " ; } >'" + out + "' 2>'" + err + "'";
  const int status = std::system(command.c_str());
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_bytes(out),
                  read_bytes(err)};
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return outcome;
}

inline bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace roughmesh::test
