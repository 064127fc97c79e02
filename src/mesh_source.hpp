// SPDX-License-Identifier: BSD-3-Clause
// What read_mesh keeps of a file so that write_mesh can copy it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh {
namespace detail {

/// A whole file in memory. It is read, not mapped: a mapped file that another process cuts short
/// kills the program.
struct FileBytes {
  std::filesystem::path path;
  std::unique_ptr<char[]> data;  ///< size bytes and a final '\0', at which number parsers stop
  std::size_t size = 0;

  std::string_view view() const { return {data.get(), size}; }
};

/// @throws InputError  missing, a directory, no permission, not a regular file
FileBytes read_file(const std::filesystem::path& path);

enum class NumberFormat : std::uint8_t { text, float32, float64 };

/// Where the numbers of one triangle of an STL stand.
struct StlFacet {
  std::uint64_t normal = 0;                 ///< offset of the first of three numbers
  std::array<std::uint64_t, 3> vertices{};  ///< likewise for each corner
  std::array<Index, 3> nodes{};             ///< of the mesh, one for each corner
};

/// A normal or tangent at a node, as a file states it.
struct NodeVector {
  std::uint64_t offset = 0;  ///< of its first number
  Index node = 0;
  bool is_normal = true;  ///< of all faces at the node; else a tangent or the normal of one face
  Vec3 value = Vec3::Zero();
};

/// Of everything in a mesh but the positions of its nodes.
std::uint64_t topology_hash(const Mesh& mesh);

}  // namespace detail

class MeshSource {
 public:
  detail::FileBytes file;
  detail::NumberFormat coordinates = detail::NumberFormat::text;
  bool swap_bytes = false;               ///< the file's byte order is not this machine's
  std::uint64_t topology = 0;            ///< topology_hash of the mesh as it was read
  std::vector<Vec3> positions;           ///< n positions as they were read
  std::vector<std::uint64_t> offsets;    ///< n offsets of first coordinates, or of the
                                         ///< records that hold them, ascending; not for STL
  std::vector<detail::StlFacet> facets;  ///< STL only, ascending
  int n_coordinates = 3;  ///< of each node and vector; 2 for a plane mesh, whose z is 0
  char comment = '\0';    ///< begins a comment that ends with its line; '\0' for none
  std::vector<detail::NodeVector> vectors;  ///< normals and tangents, ascending
  detail::NumberFormat vector_numbers = detail::NumberFormat::text;
};

namespace detail {

/// The last step of each reader: keeps the file and what the mesh is like as it was read.
void attach_source(Mesh& mesh, MeshSource source, FileBytes file);

}  // namespace detail
}  // namespace roughmesh
