// SPDX-License-Identifier: BSD-3-Clause
// What the pipeline prepares once: the surfaces that become rough, and the fields on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "roughmesh/correlation.hpp"
#include "roughmesh/displace.hpp"
#include "roughmesh/field.hpp"
#include "roughmesh/mesh.hpp"
#include "roughmesh/options.hpp"
#include "roughmesh/periodic.hpp"
#include "roughmesh/statistics.hpp"
#include "roughmesh/surface.hpp"

namespace roughmesh::detail {

/// What acute edges do to a surface (docs/math.md, eq. 57).
struct TaperReport {
  Index n_points = 0;         ///< whose heights are lowered
  double sq_share = 1;        ///< what is left of Sq over the surface
  double angle = 0;           ///< of the sharpest edge, in radians
  Vec3 place = Vec3::Zero();  ///< where that is
};

/// How one surface becomes rough: all that does not change from one realization to the next.
struct SurfacePlan {
  Roughness request;            ///< as used: distance and period filled in
  std::vector<double> weights;  ///< n_points, from the masks and the edge rule
  std::vector<double>
      free;  ///< n_points: 0 where `fixed` or the edge rule alone holds a point, else 1
  TaperReport taper;
  std::size_t field = 0;           ///< position among the fields
  std::vector<Index> field_point;  ///< n_points positions among the points of the field
};

/// A field, and where it is known. Surfaces with the same_field() are parts of one: what they have
/// in common is equal on both, and what comes close is correlated.
struct FieldPlan {
  Correlation correlation;    ///< between the points of all its surfaces together
  PeriodicPartners partners;  ///< among those points; every point for itself unless periodic
  int dimension = 3;          ///< of FieldOptions: 2 for the lines of a planar mesh
};

struct RoughSurfaces {
  std::vector<Surface> surfaces;   ///< in the order of the requests
  std::vector<SurfacePlan> plans;  ///< one for each surface
  std::vector<FieldPlan> fields;
};

/// Selects the surfaces and finds out which fields they need. Draws nothing yet.
/// @throws InputError  what select_surface, mask_weights and Correlation throw; a periodic link
///                     that the distance of the surface does not respect
RoughSurfaces prepare_surfaces(const Mesh& mesh, std::span<const Roughness> requests);

/// What becomes of a field that would part nodes which periodic links join.
enum class TornLinks { refused, allowed };

/// Likewise for one surface that is selected already.
RoughSurfaces prepare_surface(const Mesh& mesh, const Surface& surface, const Roughness& request,
                              TornLinks torn_links);

/// Correlation between the points of one surface.
Correlation correlation_of(const SurfacePlan& surface, std::span<const FieldPlan> fields);

/// n_nodes flags: nodes that the roughness moves, of weight above 0 on some surface and not fixed.
std::vector<std::uint8_t> moving_nodes(const RoughSurfaces& rough, const Mesh& mesh);

/// Along each axis the period of the surfaces that have a periodic distance, if any.
std::optional<Vec3> period_of(const RoughSurfaces& rough);

/// Heights z_i = m_i Rq d_i of the points of one surface (docs/math.md, eq. 3 and 43).
/// @param field_heights  d at the points of its field; moved in, their memory is that of the result
std::vector<double> heights_of(const SurfacePlan& surface, std::vector<double> field_heights);

/// What SurfaceMover needs of each surface.
std::vector<EdgeOptions> edge_options(const RoughSurfaces& rough);

/// Nodes that a surface holds, ascending: what one fixes, no other moves.
std::vector<Index> fixed_nodes(const RoughSurfaces& rough, const Mesh& mesh);

}  // namespace roughmesh::detail
