// SPDX-License-Identifier: BSD-3-Clause
// What writers of numbered text formats share.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Numbers of the nodes and, block by block, of the elements of a new file: those of the mesh where
/// they are all different and within 1 to `largest`, else 1, 2, 3, ...
struct NewNumbers {
  std::vector<Tag> nodes;
  std::vector<std::vector<Tag>> elements;
};
NewNumbers new_numbers(const Mesh& mesh, Tag largest);

/// A group's name, or GROUP_DIMENSION_TAG for one without.
std::string group_label(const PhysicalGroup& group);

/// Positions in Mesh::blocks of the blocks in each group.
std::map<std::pair<int, Tag>, std::vector<std::size_t>> blocks_of_groups(const Mesh& mesh);

/// Refuses all but elements of order 1 and those of order 2 with nodes on their edges only, and a
/// mesh of points only. `pyramids`: the format has them.
/// @throws InputError
void check_serendipity(const Mesh& mesh, const std::filesystem::path& path, bool pyramids);

}  // namespace roughmesh::detail
