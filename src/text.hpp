// SPDX-License-Identifier: BSD-3-Clause
// Parts of lines of text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace roughmesh::detail {

std::string_view trimmed(std::string_view text);             ///< without space around it
std::vector<std::string_view> words(std::string_view line);  ///< what stands between spaces
std::string upper(std::string_view text);                    ///< a to z in capitals

}  // namespace roughmesh::detail
