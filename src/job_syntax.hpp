// SPDX-License-Identifier: BSD-3-Clause
// What a job file must not do to the libraries that parse it: nest so deeply that functions which
// call themselves (copies, destructors) run out of stack, or hold what toml++ 3.3 does not
// expect. One pass over the text, before it is parsed.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace roughmesh::detail {

inline constexpr std::size_t deepest_job =
    32;  ///< lists and tables within each other; options need 4

/// @throws FormatError  nested more than `deepest_job` deep
void check_json_syntax(std::string_view text, const std::string& source);

/// @throws FormatError  likewise, brackets or parts of a key; a table header without a name; a text
///                      where neither a key nor a value may begin; outside of texts and comments,
///                      signs beyond ASCII, signs that TOML has not there, and values that are no
///                      numbers or truths
/// @throws InputError   dates and times
void check_toml_syntax(std::string_view text, const std::string& source);

}  // namespace roughmesh::detail
