// SPDX-License-Identifier: BSD-3-Clause
// The surface that becomes rough: faces, field points, normals, areas.
#pragma once

#include <array>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh {

struct SurfaceOptions {
  /// Names or numbers of physical groups (an exact name goes before a number), or "all". In a
  /// planar mesh with line elements groups of lines are meant, and "all" is every line; a group of
  /// dimension 2 may be chosen there as well and then moves out of the plane. In any other mesh
  /// groups of dimension 2 are meant, and "all" is every such element, the whole boundary where
  /// there are none. Empty: the only such group; without groups, the whole boundary of a volume
  /// mesh, the whole mesh of faces only or of lines only.
  std::vector<std::string> groups = {};
  bool flip = false;  ///< turn every normal round
  /// Edges whose two face normals enclose more than this count as sharp, in radians.
  double sharp_angle = 40.0 / 180.0 * std::numbers::pi;
};

/// Smallest, median and largest edge length of the selected faces, or length of the lines.
struct MeshSize {
  double min = 0, median = 0, max = 0;
};

/// Triangles and quadrangles, or lines, of the chosen groups, on *field points*. An element of
/// order 2 is as many linear faces as its nodes make (docs/math.md, eq. 38), so that each of its
/// nodes has a height of its own. Nodes of these faces at equal
/// positions are one point, and points stand in canonical order (docs/math.md, section "Points"):
/// by position, whatever numbers and order the file has. All that is random or computed on the
/// surface is indexed by point.
struct Surface {
  int dimension = 2;  ///< 2: faces of a 3-D mesh; 1: lines of a planar one
  /// Of lines: unit normal of their plane; they run counter-clockwise about it around what lies
  /// behind them. Zero for faces.
  Vec3 plane_normal = Vec3::Zero();
  std::vector<Vec3> points;   ///< n positions, canonical order
  std::vector<Vec3> normals;  ///< n unit vectors, outward (docs/math.md, eq. 2 and 35)
  std::vector<double> areas;  ///< n node areas (lengths of lines); they add up to `area`
  /// m >= n mesh nodes of the selected faces, ascending. The two sides of a crack move together if
  /// both are selected, and come apart if one is.
  std::vector<Index> nodes;
  std::vector<Index> point_of_node;  ///< m points, in the order of `nodes`

  /// n_faces + 1 positions in face_points. Faces stand in the order of their sorted points, which
  /// depends on positions only; a face with fewer than three distinct points is left out.
  std::vector<Index> face_offsets;
  std::vector<Index> face_points;  ///< corners of each face, oriented along the normals
  std::vector<Tag>
      face_tags;         ///< n_faces element numbers in the file; 0 for a derived boundary face
  Index n_elements = 0;  ///< elements they come from; fewer than faces where the order is 2

  double area = 0;           ///< of lines: length
  MeshSize mesh_size;        ///< h is mesh_size.median
  Index n_components = 0;    ///< pieces connected through edges (lines: through points)
  Index n_border_edges = 0;  ///< edges of one face (end points of lines); 0 if closed
  /// Points of these edges, smaller first, in ascending order; of lines the end point, twice.
  std::vector<std::array<Index, 2>> border_edges;
  Index n_nonmanifold_edges = 0;  ///< edges of three and more faces (points of so many lines)
  Index n_sharp_edges = 0;        ///< edges (points of lines) beyond SurfaceOptions::sharp_angle
  Index n_duplicate_faces = 0;    ///< elements on the same points as an earlier one; counted once
  /// Nodes at positions of points that no selected face uses; they stay.
  Index n_coincident_nodes = 0;
  std::vector<std::string> groups;  ///< what was selected, for the report

  Index n_points() const { return static_cast<Index>(points.size()); }
  Index n_faces() const { return static_cast<Index>(face_tags.size()); }
  std::span<const Index> face(Index i) const {
    const auto f = static_cast<std::size_t>(i);
    return {face_points.data() + face_offsets[f],
            static_cast<std::size_t>(face_offsets[f + 1] - face_offsets[f])};
  }
};

/// Selects and orients the faces; of lines read curve for surface, point for edge, area for volume.
/// Orientation is made consistent over each piece that is connected
/// through edges of two faces. A closed piece is turned outward (positive enclosed volume). An open
/// piece points out of the volume it bounds, between two volumes out of the one with the lower
/// entity number; if its faces disagree, most of them decide. Any other open piece keeps the
/// orientation that most of its area has in the file; of two halves, that of its first face there.
/// `flip` turns the result. Normals use the weights of N. Max (1999), J. Graphics Tools 4(2):1-6,
/// doi:10.1080/10867651.1999.10487501.
///
/// @throws InputError  unknown group, group of another dimension, no surface, several groups and
///                     none chosen (lists them), groups of lines in a mesh that is not planar,
///                     groups of different dimensions, one-sided (unorientable) surface, elements
///                     of order above 2, a point all of whose faces have no area, sharp_angle
///                     outside [0, pi]
Surface select_surface(const Mesh& mesh, const SurfaceOptions& options = {});

/// Area vector of a polygon with these corner positions: its length is the area of a flat face, its
/// direction the right-hand normal.
Vec3 area_vector(std::span<const Vec3> corners);

/// The points of the surface moved by one vector each, n of them; faces and all else stay.
std::vector<Vec3> moved_points(const Surface& surface, std::span<const Vec3> displacements);

/// Volume enclosed by the faces at the given point positions (n of them), area by lines; for an
/// open surface, that of the cones from the mean position. Of a quadrangle, mean over its two
/// splittings.
double enclosed_volume(const Surface& surface, std::span<const Vec3> positions);

}  // namespace roughmesh
