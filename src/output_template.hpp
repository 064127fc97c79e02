// SPDX-License-Identifier: BSD-3-Clause
// {realization} and {realization:0N} in names of files.
#pragma once

#include <cstddef>
#include <string>

namespace roughmesh::detail {

/// Where the first placeholder begins; npos without one.
std::size_t placeholder_begin(const std::string& text);

std::string without_placeholders(const std::string& text);

}  // namespace roughmesh::detail
