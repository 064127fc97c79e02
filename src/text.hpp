// SPDX-License-Identifier: BSD-3-Clause
// Parts of lines of text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace roughmesh::detail {

bool equal_ignoring_case(std::string_view a, std::string_view b);  ///< of ASCII letters
std::string_view trimmed(std::string_view text);                   ///< without space at its ends
std::vector<std::string_view> words(std::string_view line);        ///< what stands between spaces
std::string upper(std::string_view text);                          ///< a to z in capitals

}  // namespace roughmesh::detail
