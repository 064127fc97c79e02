// SPDX-License-Identifier: BSD-3-Clause
// Numbers as Fortran programs write them.
#pragma once

#include <optional>
#include <string_view>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// "1.5", "+.5", "5.", "1.5E-3", "1.5D-03", "1.5-3": all of the text, without space around it.
/// Nothing where it is no number, not finite or too large for a double.
std::optional<double> fortran_real(std::string_view text);

/// Digits with or without a sign, all of the text; nothing else and nothing beyond 2^63 - 1.
std::optional<Tag> whole_number(std::string_view text);

}  // namespace roughmesh::detail
