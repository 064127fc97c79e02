// SPDX-License-Identifier: BSD-3-Clause
// What the verbs of the command line do. Results go to stdout, warnings to stderr after success.
#pragma once

#include <string>
#include <vector>

#include "roughmesh/options.hpp"

namespace roughmesh::app {

/// Text for a terminal: one line, with `?` for control characters, which names of files may hold.
std::string printable(std::string text);

/// "a, b, c"
std::string list_of(const std::vector<std::string>& names);

/// The mesh that `input` names; a geometry is meshed first.
Mesh read_input(const RoughenOptions& options);

/// Reads the input, writes each realization and the report, prints a summary.
void run_roughen(const RoughenOptions& options);

/// Prints groups, sizes and what roughness the surface can carry.
/// @param has_rms  options.rms was given; else the limits are stated per unit of Rq
void run_info(const RoughenOptions& options, bool has_rms);

}  // namespace roughmesh::app
