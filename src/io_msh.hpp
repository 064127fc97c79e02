// SPDX-License-Identifier: BSD-3-Clause
// Parts of the MSH reader: sections common to all versions, those of 2.2, those of 4.1.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "file_formats.hpp"
#include "node_lookup.hpp"
#include "number_writer.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

/// What $Entities or $PartitionedEntities say about one entity.
struct MshEntity {
  Tag elementary = 0;  ///< its own number, or that of the entity a partition was cut from
  std::vector<Tag> groups;
};

using DimensionAndTag = std::pair<int, Tag>;

/// An MSH file while it is read, section by section.
struct MshReader {
  explicit MshReader(const FileBytes& file) : scanner(file) {}

  Scanner scanner;
  Mesh mesh;
  std::vector<std::uint64_t> offsets;  ///< of the first coordinate of each node
  NodeLookup lookup;
  std::map<DimensionAndTag, std::string> names;   ///< of physical groups
  std::map<DimensionAndTag, MshEntity> entities;  ///< 4.1 only
  bool has_nodes = false;
  bool has_elements = false;

  bool is_text() const { return scanner.encoding() == Encoding::text; }
  /// The bytes that a number takes at least: a digit and a space in text.
  std::size_t least(std::size_t binary_bytes) const { return is_text() ? 2 : binary_bytes; }

  void start_nodes(Tag n, std::size_t min_bytes_each);  ///< checks the number and reserves
  void add_position();                                  ///< of the next node
  void finish_nodes();                                  ///< numbers are unique from here on

  /// The number of a physical group, whose sign is that of an orientation.
  Tag group(Tag tag) const;

  void start_elements();
  const ElementType& element_type(Tag number) const;
  void check_element_count(Tag n) const;
  Index node(Tag tag) const;  ///< fails where no node has the number

  void add_periodic_pair(PeriodicLink& link, Tag slave, Tag master) const;
};

void read_msh2_nodes(MshReader& reader);
void read_msh2_elements(MshReader& reader);
void read_msh2_periodic(MshReader& reader);
/// Elements with the same nodes in several blocks of one type and entity become one in the groups
/// of all, in the order in which they first appear.
void merge_copies_in_groups(std::vector<ElementBlock>& blocks);

void read_msh4_entities(MshReader& reader);
void read_msh4_partitioned_entities(MshReader& reader);
void read_msh4_nodes(MshReader& reader);
void read_msh4_elements(MshReader& reader);
void read_msh4_periodic(MshReader& reader);

/// Refuses elements that MSH has no number for.
/// @throws InputError
void check_for_msh(const Mesh& mesh, const std::filesystem::path& path);

/// $MeshFormat and $PhysicalNames, which versions share.
void write_msh_format(NumberWriter& numbers, std::string_view version);
void write_msh_names(NumberWriter& numbers, const Mesh& mesh);
/// Names that have to be written differently.
std::vector<std::string> losses_of_msh(const Mesh& mesh);

void write_new_msh4(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

/// Refuses also numbers beyond 2^31 - 1, which 2.2 has no room for.
/// @throws InputError
void check_for_msh2(const Mesh& mesh, const std::filesystem::path& path);
void write_new_msh2(const Mesh& mesh, const WriteOptions& options, OutputFile& output);

}  // namespace roughmesh::detail
