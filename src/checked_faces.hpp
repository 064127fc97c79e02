// SPDX-License-Identifier: BSD-3-Clause
// Every face at which a surface could intersect itself, on points that move.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

#include "triangle_tree.hpp"

namespace roughmesh::detail {

/// Where a face comes from.
struct FaceSource {
  Tag element = 0;  ///< its number in the file; of a derived side, that of the element behind it
  ElementShape shape = ElementShape::triangle;
  bool is_side = false;  ///< derived: no element of the file
};

/// All elements of one dimension in the mesh, roughened or not, and the sides of exactly one
/// element of the dimension above, each face once; elements of order 2 as their facets
/// (docs/math.md, eq. 38). They stand along Morton's curve, and only their nodes are points, by
/// first use: near places are near in memory.
struct CheckedFaces {
  int dimension = 2;
  std::vector<Index> nodes;  ///< of each point, its node in the mesh
  std::vector<Vec3> before;  ///< of each point, its place in the input
  /// Of each point, the first that has its place in the input (to 1e-9 of the extent): the sides of
  /// a crack are one there.
  std::vector<Index> joined;

  std::vector<std::array<Index, 4>> corners;  ///< points of each face; -1 behind the last
  std::vector<FaceSource> sources;            ///< of each face
  /// Of each face, the first whose corners are at the same places in the input: the two sides of a
  /// contact are one there, whatever becomes of them.
  std::vector<Index> same_place;

  /// Triangles or segments that stand for the faces: of a quadrangle those of both its splittings,
  /// so that it does not matter which one a solver takes, nor where the file starts. None where
  /// corners are one point in the input.
  std::vector<Facet> facets;
  std::vector<Index> face_of_facet;  ///< ascending; facets of one face stand together
  std::vector<Index> first_facet;    ///< n_faces + 1 positions in facets

  /// Some points of every connected part, and one in `step` of all, ascending.
  std::vector<Index> sample(std::size_t step) const;

  std::span<const Index> face(std::size_t i) const {
    const std::size_t n = corners[i][2] < 0 ? 2 : corners[i][3] < 0 ? 3 : 4;
    return std::span(corners[i]).first(n);
  }
};

/// @param dimension  2 for faces, 1 for the lines of a planar mesh
/// @param left_out   n_nodes flags: faces with such a node are left out; empty: none are
CheckedFaces collect_faces(const Mesh& mesh, int dimension,
                           std::span<const std::uint8_t> left_out = {});

/// Of each point, a number that points have in common where they are one in the input and still
/// after they moved; that of one of these points.
std::vector<Index> joined_after(const CheckedFaces& faces, std::span<const Vec3> after);

}  // namespace roughmesh::detail
