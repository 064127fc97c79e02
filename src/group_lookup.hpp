// SPDX-License-Identifier: BSD-3-Clause
// Physical groups by name or number.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The group with exactly this name, else with this number; of the preferred dimension if there is
/// one, else the first in the order of Mesh::groups.
std::optional<PhysicalGroup> find_group(const Mesh& mesh, const std::string& text,
                                        int preferred_dimension);

/// True if the block has elements, all of which are in the group.
bool is_in_group(const ElementBlock& block, const PhysicalGroup& group);

bool has_elements(const Mesh& mesh, const PhysicalGroup& group);

/// "name (number)", or the number of a group without a name.
std::string label(const PhysicalGroup& group);

/// Labels of the first ten, and how many more there are.
std::string list_of_labels(std::span<const PhysicalGroup> groups);

}  // namespace roughmesh::detail
