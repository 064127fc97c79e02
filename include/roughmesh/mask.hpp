// SPDX-License-Identifier: BSD-3-Clause
// How much of the roughness each point of a surface gets: fade-out, fixed groups, boxes, spheres,
// formulas.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh {

/// From 0 on a border to 1 at the distance `width` from it (docs/math.md, eq. 40 and 41). Distance
/// is Euclidean, to the nearest point of the border edges or of the elements of the group, which
/// are points, segments and polygons; volume elements count by their faces.
struct Fade {
  double width = 0;  ///< > 0 and finite, a length
  /// Name or number of a physical group of any dimension (an exact name goes before a number, one
  /// dimension below the surface before any other, then the lowest). Empty: the border of the
  /// surface, where one selected face ends (or one line of a curve).
  std::string group = {};
};

/// 1 in the box, falling to 0 at the distance `fade` from it (docs/math.md, eq. 42).
struct BoxMask {
  Vec3 min = Vec3::Zero();  ///< each at most that of max; may be minus infinity
  Vec3 max = Vec3::Zero();  ///< may be infinity
  double fade = 0;          ///< >= 0 and finite, a length; 0: a jump at the side of the box
  bool outside = false;     ///< 1 minus that: 0 in the box, 1 from `fade` on
};

/// 1 in the ball, falling to 0 at the distance `fade` from it (docs/math.md, eq. 42).
struct SphereMask {
  Vec3 centre = Vec3::Zero();
  double radius = 0;     ///< > 0 and finite, a length
  double fade = 0;       ///< >= 0 and finite, a length; 0: a jump at the sphere
  bool outside = false;  ///< 1 minus that
};

/// The value of an expression, clipped to [0, 1].
struct FormulaMask {
  /// At most 1,000 characters. Numbers; the point x, y, z and its unit normal nx, ny, nz; pi, e;
  /// + - * / ^ ( ); < <= > >= == != && ||, which give 0 or 1; a ? b : c; sin, cos, tan, asin, acos,
  /// atan, atan2, sinh, cosh, tanh, exp, log (natural), log10, sqrt, abs, floor, ceil, and min and
  /// max of any number of arguments. -x^2 is -(x^2), a^b^c is a^(b^c).
  std::string expression;
};

/// Masks of one surface; a point gets the product of all of them.
struct MaskOptions {
  std::vector<Fade> fade = {};
  /// Names or numbers of physical groups of any dimension, found as in Fade: points that are nodes
  /// of their elements get 0.
  std::vector<std::string> fixed = {};
  std::vector<BoxMask> boxes = {};
  std::vector<SphereMask> spheres = {};
  std::vector<FormulaMask> formulas = {};

  bool empty() const {
    return fade.empty() && fixed.empty() && boxes.empty() && spheres.empty() && formulas.empty();
  }
};

/// Weights mu_i in [0, 1] of the points (docs/math.md, eq. 43), to multiply heights by: n numbers
/// in the order of surface.points, all 1 without a mask. Exactly 0 on the border of a fade. The
/// same bits for any numbering of the mesh and any number of threads.
///
/// @param surface  selected from this mesh
/// @throws InputError  a value out of the range above; no such group, a group without elements, a
///                     fixed group without a point of the surface; a fade from the border of a
///                     closed surface; a formula that cannot be read, is not a number at a point or
///                     has several values; masks that leave no point above 0
std::vector<double> mask_weights(const Mesh& mesh, const Surface& surface,
                                 const MaskOptions& options);

/// Node areas of the points of weight 1, and 0 for the others: what height_statistics and
/// expected_sq need in order to leave a faded band out.
/// @param weights  n numbers, in the order of surface.points
/// @throws InputError  another number of weights
std::vector<double> full_weight_areas(const Surface& surface, std::span<const double> weights);

}  // namespace roughmesh
