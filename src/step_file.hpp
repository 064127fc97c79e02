// SPDX-License-Identifier: BSD-3-Clause
// What roughmesh itself reads of a STEP file (ISO 10303-21): that it is one, and its length unit.
#pragma once

#include <optional>
#include <string_view>

namespace roughmesh::detail {

/// Does it begin as the exchange structure of ISO 10303-21 does? Space may stand before.
bool is_step(std::string_view bytes);

/// Length unit of the geometry, in millimetres: the LENGTH_UNIT that the first
/// GLOBAL_UNIT_ASSIGNED_CONTEXT names (ISO 10303-41), an SI_UNIT of METRE with its prefix, or a
/// CONVERSION_BASED_UNIT by its factor. Empty where the file does not say it. Linear in the size.
std::optional<double> step_length_unit(std::string_view bytes);

}  // namespace roughmesh::detail
