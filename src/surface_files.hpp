// SPDX-License-Identifier: BSD-3-Clause
// What the formats of bare surfaces share: faces as blocks, and which part of a mesh goes into
// such a file.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "mesh_source.hpp"
#include "scanner.hpp"

namespace roughmesh::detail {

inline constexpr ElementType point_type{ElementShape::point, 1, 1};
inline constexpr ElementType line_type{ElementShape::line, 1, 2};
inline constexpr ElementType triangle_type{ElementShape::triangle, 1, 3};
inline constexpr ElementType quadrangle_type{ElementShape::quadrangle, 1, 4};

/// Gathers elements into one block for each (type, set of groups), in order of first appearance.
class BlockBuilder {
 public:
  void set_groups(std::vector<Tag> groups);  ///< of the elements to come; ascending
  void add(const ElementType& type, Tag number, std::span<const Index> nodes);
  void add_face(Tag number, std::span<const Index> corners) {
    add(corners.size() == 4 ? quadrangle_type : triangle_type, number, corners);
  }
  std::vector<ElementBlock> take() { return std::move(blocks_); }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t find_block(const ElementType& type);

  std::vector<ElementBlock> blocks_;
  std::map<std::pair<ElementShape, std::vector<Tag>>, std::size_t> places_;
  std::vector<Tag> groups_;
  std::array<std::size_t, 4> current_ = {none, none, none, none};  // block, by shape
};

/// @throws FormatError  neither 3 nor 4
void check_face_size(const Scanner& scanner, Tag n_corners);

/// A node number that counts from 0. @throws FormatError  no such node
Index checked_node(const Scanner& scanner, Tag number, Index n_nodes);

/// Numbers the nodes of a mesh 1, 2, 3, ...
void number_nodes(Mesh& mesh);

/// The part of a mesh that a file of elements of dimension `least_dimension` to 2 holds. Nodes that
/// only other elements use are left out.
struct SurfacePart {
  SurfacePart(const Mesh& mesh, int least_dimension);

  std::vector<Index> nodes;    ///< positions in Mesh::nodes, ascending
  std::vector<Index> numbers;  ///< for each node of the mesh its place in `nodes`, or -1
  std::vector<const ElementBlock*> blocks;  ///< not empty, in the order of the mesh
};

std::int64_t n_elements(const SurfacePart& part, int dimension);

/// @throws InputError  no surface elements, or elements of that part that are of higher order
void check_surface_part(const Mesh& mesh, const std::filesystem::path& path, int least_dimension);

/// Name of the group: its own or, if that is empty, "group_5"; without control characters.
std::string group_name(const Mesh& mesh, int dimension, Tag tag);

}  // namespace roughmesh::detail
