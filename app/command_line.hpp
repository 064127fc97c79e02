// SPDX-License-Identifier: BSD-3-Clause
// From arguments to options. The option parser is known to this pair of files only.
#pragma once

#include <string>
#include <vector>

#include "roughmesh/options.hpp"

namespace roughmesh::app {

enum class Verb { help, version, roughen, info };

struct Command {
  Verb verb = Verb::help;
  RoughenOptions options;  ///< of roughen; info uses those that concern mesh and field
  bool has_rms = false;    ///< info: --rms was given
  std::string text;        ///< what help and version print
};

/// Options given as arguments override those of a --job file.
/// @throws InputError  whatever is wrong with the arguments, in one line
Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace roughmesh::app
