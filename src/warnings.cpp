// SPDX-License-Identifier: BSD-3-Clause
#include "warnings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "messages.hpp"

namespace roughmesh::detail {
namespace {

/// Names the surface where there are several.
void warn(Report& report, const std::vector<std::string>& groups, const std::string& text) {
  const bool is_alone = report.request.surfaces.size() == 1;
  std::string warning =
      is_alone ? text : fmt::format("surface {}: {}", fmt::join(groups, ", "), text);
  if (std::find(report.warnings.begin(), report.warnings.end(), warning) == report.warnings.end())
    report.warnings.push_back(std::move(warning));
}

/// The largest number of two digits that is not above.
double two_digits_below(double value) {
  if (!(value > 0)) return 0;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::floor(value / unit) * unit;
}

/// What a surface is made of.
struct Words {
  const char* faces;
  const char* edges;
};

Words words_for(const Surface& surface) {
  return surface.dimension == 1 ? Words{"lines", "corners"} : Words{"faces", "edges"};
}

/// A few grains less do not matter; a share of Rq that is missing does.
void warn_of_cutoff(Report& report, const SurfaceReport& surface, const Roughness& request) {
  constexpr double few = 0.01;
  const auto& lattice = surface.field.lattice;
  if (!lattice || !request.cutoff || !(lattice->lost_variance > few)) return;
  const double left = std::sqrt(1 - lattice->lost_variance);
  warn(report, surface.groups,
       fmt::format("--cutoff {:g} leaves out {:.3g} % of the variance, so that Rq is {:.4g} where "
                   "--rms asks for {:g}; take a shorter --cutoff, or --rms {:.4g} for that Rq "
                   "without the finer part",
                   *request.cutoff, 100 * lattice->lost_variance, left * request.rms, request.rms,
                   request.rms / left));
}

/// What helps where no random field has the correlation that was asked for.
const char* remedy_for_indefinite(const Roughness& request) {
  return request.acf == Family::table
             ? "damp the oscillations of the table, or give its pairs closer together"
             : "use a shorter length or --distance euclidean";
}

void warn_of_field(Report& report, const SurfaceReport& surface, const Roughness& request) {
  if (surface.audit.covariance_error > report.request.tolerance)
    warn(report, surface.groups,
         fmt::format("audited covariance error {:.3g} is above the tolerance {:g}",
                     surface.audit.covariance_error, report.request.tolerance));
  const auto& cholesky = surface.field.cholesky;
  if (cholesky && cholesky->variance_change > 1e-3)
    warn(report, surface.groups,
         fmt::format("this autocorrelation is not positive definite for this distance: {} negative "
                     "eigenvalues were set to zero, which changes variances by up to {:.3g}; {}",
                     cholesky->negative_eigenvalues, cholesky->variance_change,
                     remedy_for_indefinite(request)));
}

}  // namespace

void warn_of_surface(Report& report, const Surface& surface, const Roughness& request) {
  const Words words = words_for(surface);
  if (surface.n_sharp_edges > 0 && request.edges == EdgeRule::average)
    warn(report, surface.groups,
         fmt::format("{} sharp {} (more than {:g} degrees): their nodes move along averaged "
                     "normals, which lowers the roughness there; --edges offset keeps it",
                     surface.n_sharp_edges, words.edges, request.edge_angle));
  if (surface.n_nonmanifold_edges > 0)
    warn(report, surface.groups,
         fmt::format("{} {} join three or more {}: normals there are a compromise; choose one "
                     "--group at a time",
                     surface.n_nonmanifold_edges, words.edges, words.faces));
  if (surface.n_coincident_nodes > 0)
    warn(report, surface.groups,
         fmt::format("{} nodes lie where nodes of the rough surface lie, but on none of its {}; "
                     "they stay, so a gap opens or closes there; choose the {} of both sides if "
                     "they belong together",
                     surface.n_coincident_nodes, words.faces, words.faces));
  if (surface.n_duplicate_faces > 0)
    warn(report, surface.groups,
         fmt::format("{} {} stand on the nodes of another one and count once",
                     surface.n_duplicate_faces, words.faces));
}

void warn_of_period(Report& report, const Surface& surface, const Roughness& request) {
  constexpr double rounding = 1e-6;
  Eigen::AlignedBox3d box;
  for (const Vec3& x : surface.points) box.extend(x);
  for (std::size_t axis = 0; axis < request.period.size(); ++axis) {
    const double period = request.period[axis];
    if (!(period > 0)) continue;
    const double width = box.sizes()[static_cast<Eigen::Index>(axis)], n = width / period;
    if (std::abs(n - std::round(n)) <= rounding) continue;
    warn(report, surface.groups,
         fmt::format(
             "--period is {:g} along {}, but the surface is {:g} wide there, {:.4g} periods: "
             "its two sides will not match; give the width of the periodic cell",
             period, "xyz"[axis], width, n));
  }
}

void warn_of_constant_heights(Report& report, const std::vector<std::string>& groups,
                              double sq_over_rq) {
  if (!(sq_over_rq * sq_over_rq < report.request.tolerance)) return;
  warn(report, groups,
       fmt::format("heights are nearly the same all over the surface: their Sq is {:.2g} of --rms, "
                   "less than a covariance error of {:g} leaves certain; take a shorter --length "
                   "(along the surface, where there are several)",
                   sq_over_rq, report.request.tolerance));
}

void warn_of_taper(Report& report, const Surface& surface, const TaperReport& taper) {
  if (taper.n_points == 0) return;
  warn(
      report, surface.groups,
      fmt::format("heights are lowered at {} points near {} below 45 degrees (the sharpest, {:.3g} "
                  "degrees, is at {}), so that the two sides keep apart: Sq of the surface is "
                  "{:.3g} % of what it is without; round them for whole heights",
                  taper.n_points, words_for(surface).edges, taper.angle * 180 / std::numbers::pi,
                  place(taper.place), 100 * taper.sq_share));
}

void warn_of_scale(Report& report, const SurfaceReport& surface, const Roughness& request) {
  const double rq = request.rms;
  const double h = surface.mesh_size.median;
  // What is finer than the mesh a cutoff above its size takes away.
  const bool is_cut = request.cutoff && *request.cutoff >= h;
  for (const std::string& text : is_cut ? height_warnings(surface.resolution, rq)
                                        : resolution_warnings(surface.resolution, rq))
    warn(report, surface.groups, request.cutoff ? "before the cutoff: " + text : text);
  if (rq < 1e-6 * h)
    warn(
        report, surface.groups,
        fmt::format("--rms {:g} is {:.1e} of the mesh size {:.3g}; check the unit", rq, rq / h, h));
  const double size = surface.dimension == 1 ? surface.area : std::sqrt(surface.area);
  const double length = surface.lengths.one_over_e;
  if (length < 1e-2 * h)
    warn(
        report, surface.groups,
        fmt::format("the 1/e distance of the correlation, {:g}, is {:.1e} of the mesh size {:.3g}; "
                    "check the unit",
                    length, length / h, h));
  if (length > size)
    warn(report, surface.groups,
         fmt::format(
             "the 1/e distance of the correlation, {:g}, is larger than the surface (its size "
             "is {:.3g}): it moves nearly as a whole; check the unit",
             length, size));
}

void warn_of_fields(Report& report) {
  for (std::size_t s = 0; s < report.surfaces.size(); ++s) {
    warn_of_field(report, report.surfaces[s], report.request.surfaces[s]);
    warn_of_cutoff(report, report.surfaces[s], report.request.surfaces[s]);
  }
}

void warn_of_curved_elements(Report& report, const MeshCheck& check) {
  if (check.n_corners_only > 0)
    report.warnings.push_back(fmt::format(
        "{} curved elements (pyramids, or faces in space) were checked at their corners only; look "
        "at them with the checks of your solver, or use linear elements",
        check.n_corners_only));
  if (check.curved_inverted_before > 0)
    report.warnings.push_back(fmt::format(
        "{} curved elements are inverted somewhere, as in the input already; mesh again with gmsh "
        "-optimize_ho",
        check.curved_inverted_before));
}

void warn_of_slides(Report& report, std::uint64_t realization, const MovedSurface& moved) {
  const bool is_told = std::any_of(report.realizations.begin(), report.realizations.end(),
                                   [](const RealizationReport& r) { return r.slid_nodes > 0; });
  if (moved.n_slid == 0 || is_told) return;
  report.warnings.push_back(fmt::format(
      "realization {}: heights would fold faces over where the mesh is fine or curved; {} nodes "
      "around them slid along the surface, by up to {:.3g} (slid_nodes of the report tells of each "
      "realization)",
      realization, moved.n_slid, moved.farthest_slide));
}

void warn_of_split(Report& report, std::uint64_t realization, const Mesh& mesh, const Mesh& split) {
  report.warnings.push_back(fmt::format(
      "realization {}: edges were split where inverted elements had no node to move: {} nodes and "
      "{} "
      "elements more than in the input; groups and entities are kept, comments and data of the "
      "file are not",
      realization, split.nodes.size() - mesh.nodes.size(), n_elements(split) - n_elements(mesh)));
}

void warn_of_remeshing(Report& report, std::uint64_t realization, const Mesh& mesh,
                       const Mesh& remeshed) {
  report.warnings.push_back(fmt::format(
      "realization {}: {}: {} nodes and {} volume elements (input: {} and {}); surfaces, groups "
      "and "
      "entities are kept, comments and data of the file are not",
      realization,
      dimension(mesh) == 3 ? "volumes beside the rough surface were meshed anew"
                           : "the surface was filled with tetrahedra",
      remeshed.nodes.size(), n_elements(remeshed, 3), mesh.nodes.size(), n_elements(mesh, 3)));
}

void warn_of_walls(Report& report, Index n_nodes, bool can_slide) {
  if (n_nodes > 0)
    report.warnings.push_back(fmt::format(
        "{} nodes of the rough surface lie on faces that are not roughened{}: they move along the "
        "normals of the rough surface while the other nodes of those faces stay, so elements there "
        "invert first; --fade lets the roughness end before",
        n_nodes,
        can_slide ? " and cannot slide (they are curved, or go on where the rough surface ends)"
                  : ""));
}

void warn_of_thin_wall(Report& report, const Surface& surface, const Roughness& request,
                       const ThinWall& wall) {
  warn(report, surface.groups,
       fmt::format("the {} at {} is {:.3g} thick (up to element {}), which heights to be expected "
                   "would close; --rms {:.2g} keeps it open (estimated)",
                   wall.is_gap ? "gap" : "wall", place(wall.place), wall.distance, wall.element,
                   two_digits_below(wall.passing_share * request.rms)));
}

void warn_of_input_intersections(Report& report, const SurfaceCheck& check) {
  if (check.input_intersections == 0) return;
  report.warnings.push_back(
      fmt::format("{} pairs of faces intersect or touch in the input already, and are not counted "
                  "as self-intersections; mend the mesh if your solver needs a surface that does "
                  "not intersect itself",
                  check.input_intersections));
}

std::string describe_defects(const SurfaceCheck& check) {
  std::vector<std::string> counts;
  const auto add = [&](std::int64_t n, const char* what) {
    if (n > 0) counts.push_back(fmt::format("{} {}", n, what));
  };
  add(check.self_intersections, "pairs of faces that intersect");
  add(check.folded_faces, "folded faces");
  add(check.collapsed_faces, "collapsed faces");
  add(check.closed_walls, "points beyond the other side of a thin wall or gap");
  if (check.findings.empty())
    return fmt::format(
        "so many faces lie upon each other ({} pairs in the input already) that the "
        "search for self-intersections ended early; mend the mesh",
        check.input_intersections);
  const SurfaceFinding& worst = check.findings.front();
  return fmt::format("the rough surface has {}{}; the worst: {} at {}, where nodes moved by {:.3g}",
                     check.is_complete ? "" : "at least ", fmt::join(counts, ", "), worst.what,
                     place(worst.place), worst.height);
}

std::string lower_rms(const SurfaceCheck& check, const RoughenOptions& request) {
  if (check.findings.empty()) return "lower --rms";
  const double share = check.findings.front().passing_share;
  if (request.surfaces.size() > 1)
    return fmt::format("lower every --rms to about {:.2g} % (estimated)",
                       two_digits_below(100 * share));
  return fmt::format("lower --rms to about {:.2g} (estimated)",
                     two_digits_below(share * request.surfaces.front().rms));
}

}  // namespace roughmesh::detail
