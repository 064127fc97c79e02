// SPDX-License-Identifier: BSD-3-Clause
// What writers of new files share.
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

/// Tag of the first group of a block; 0 if it is in none.
Tag first_group(const ElementBlock& block);

/// Name of a group on one line, control characters being spaces. One without is called "group_5",
/// or "GROUP_2_5" in a format in which groups of all dimensions share their names.
enum class GroupNames { of_dimension, of_all_dimensions };
std::string group_name(const PhysicalGroup& group, GroupNames names);
/// Likewise, of those of a dimension, whether or not the mesh lists it.
std::string group_name(const Mesh& mesh, int dimension, Tag tag);

/// Positions in Mesh::blocks of the blocks in each group.
std::map<std::pair<int, Tag>, std::vector<std::size_t>> blocks_of_groups(const Mesh& mesh);

/// Without volumes and in the plane z = 0.
bool is_plane(const Mesh& mesh);

/// Refuses all but elements of order 1 and those of order 2 with nodes on their edges only, and a
/// mesh of points only. `pyramids`: the format has them.
/// @throws InputError
void check_serendipity(const Mesh& mesh, const std::filesystem::path& path, bool pyramids);

}  // namespace roughmesh::detail
