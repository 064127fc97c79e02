// SPDX-License-Identifier: BSD-3-Clause
// Runs the gmsh program as a child process. Linked into this one, it could end it, run commands
// from a file, and would bring its licence (docs/geometry.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "roughmesh/error.hpp"

#include "scratch_folder.hpp"

namespace roughmesh::detail {

struct GmshCall {
  std::string program = "gmsh";             ///< a name that is looked for in PATH, or a path
  std::vector<std::string> arguments = {};  ///< given as they are: no shell sees them
  double timeout = 600;                     ///< seconds of wall-clock time, > 0
  std::filesystem::path folder = {};        ///< to run in; empty: the scratch folder
  /// Size of each file that it writes, and of its memory with room for programs and libraries.
  /// Absent: the memory that is free, beyond which a mesh could not be read.
  std::optional<std::uint64_t> most_bytes = {};
  bool has_size = true;  ///< of the mesh, asked for by the user: another may help
};

struct GmshOutcome {
  int exit_status = 0;
  std::string output;  ///< stdout and stderr as they came, the first megabyte, without colours
};

/// Runs with no input, an environment of its own in which `folder` is the home (so that no option
/// file of the user is read), and all output kept. The child and its children are
/// killed at the time limit and on an interrupt (ScratchFolder).
///
/// @throws InputError      no such program; the time is over; a file beyond the limit
/// @throws NumericalError  killed by a signal: crashed
GmshOutcome run_gmsh(const ScratchFolder& folder, const GmshCall& call);

/// Gmsh's own first error line, without its prefix, made safe to print; the first line that is not
/// empty where there is none; empty where there is no output.
std::string first_error(const std::string& output);

}  // namespace roughmesh::detail
