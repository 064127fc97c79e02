// SPDX-License-Identifier: BSD-3-Clause
// A finite element mesh as plain data.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace roughmesh {

using Vec3 = Eigen::Vector3d;  ///< a point or vector, in the length unit of the mesh
using Index = std::int32_t;    ///< position in an array of nodes, points or faces
using Tag = std::int64_t;      ///< number a file gives to a node, element, entity or group

enum class ElementShape : std::uint8_t {
  point,
  line,
  triangle,
  quadrangle,
  tetrahedron,
  hexahedron,
  prism,
  pyramid
};

/// Shape, polynomial order and number of nodes; corner nodes come first, in Gmsh's order
/// (https://gmsh.info/doc/texinfo/gmsh.html, "Node ordering").
struct ElementType {
  ElementShape shape = ElementShape::point;
  int order = 1;
  int n_nodes = 1;

  friend bool operator==(const ElementType&, const ElementType&) = default;
};

int dimension(ElementShape shape);          ///< 0 to 3
int n_corners(ElementShape shape);          ///< 1 to 8
std::string name(const ElementType& type);  ///< for messages: "triangle", "tetrahedron of order 2"

/// Local corner numbers of the faces of a shape of dimension 3, each face ordered so that its
/// normal by the right-hand rule points out of an element of positive volume; of the lines around a
/// shape of dimension 2, in the order of its corners; empty for other shapes. Node n_corners + k of
/// an element of order 2 with further nodes on its faces belongs to the k-th of them that can have
/// one, counted after those of the edges.
std::span<const std::vector<int>> local_faces(ElementShape shape);

/// Local corner numbers of the two ends of each edge. Node n_corners + k of an element of order 2
/// lies on edge k. Empty for points.
std::span<const std::array<int, 2>> local_edges(ElementShape shape);

/// Elements of one type that lie on one entity and in the same physical groups.
struct ElementBlock {
  ElementType type;
  Tag entity = 0;  ///< elementary entity of dimension(type.shape); 0 if the file has none
  std::vector<Tag> physical_groups;  ///< tags of the groups of that dimension it belongs to
  std::vector<Index> nodes;          ///< n * type.n_nodes positions in Mesh::nodes
  std::vector<Tag> tags;             ///< n numbers of the elements in the file

  Index size() const { return static_cast<Index>(tags.size()); }
  std::span<const Index> element(Index i) const {
    const auto n = static_cast<std::size_t>(type.n_nodes);
    return {nodes.data() + static_cast<std::size_t>(i) * n, n};
  }
};

/// Named set of elements of one dimension, Gmsh's "physical group".
struct PhysicalGroup {
  int dimension = 0;
  Tag tag = 0;
  std::string name;  ///< empty if the file gives none
};

/// Node pairs that the file declares to be images of each other.
struct PeriodicLink {
  int dimension = 0;
  Tag entity = 0;
  Tag master_entity = 0;
  std::vector<double> affine;                  ///< 16 numbers, row by row, or empty
  std::vector<std::pair<Index, Index>> nodes;  ///< (slave, master), positions in Mesh::nodes
};

enum class MeshFormat : std::uint8_t {
  none,  ///< a mesh made in memory
  msh2,
  msh4,
  stl,
  ply,
  ply2,
  obj,
  off,
  abaqus,
  nastran,
  unv,
  medit,
  su2,
  vtk,  ///< legacy VTK
  vtu
};

std::string name(MeshFormat format);  ///< "msh2", ..., "vtu"; "none" for a mesh made in memory

/// The bytes a mesh was read from and where each coordinate stands in them; made by read_mesh.
class MeshSource;

struct Mesh {
  std::vector<Vec3> nodes;            ///< n positions
  std::vector<Tag> node_tags;         ///< n numbers of the nodes in the file
  std::vector<ElementBlock> blocks;   ///< in the order of the file
  std::vector<PhysicalGroup> groups;  ///< named or used by an element; sorted by (dimension, tag)
  std::vector<PeriodicLink> periodic_links;
  MeshFormat format = MeshFormat::none;
  std::shared_ptr<const MeshSource> source;  ///< null for a mesh made in memory

  Index n_nodes() const { return static_cast<Index>(nodes.size()); }
};

int dimension(const Mesh& mesh);  ///< largest dimension of its elements; -1 without elements
std::int64_t n_elements(const Mesh& mesh);                 ///< over all blocks
std::int64_t n_elements(const Mesh& mesh, int dimension);  ///< of one dimension

}  // namespace roughmesh
