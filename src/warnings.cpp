// SPDX-License-Identifier: BSD-3-Clause
#include "warnings.hpp"

#include <cmath>

#include <fmt/format.h>

#include "roughmesh/mesh_io.hpp"

namespace roughmesh::detail {

namespace {

void warn_of_curve(Report& report, const Surface& curve) {
  if (curve.n_sharp_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} sharp corners (more than {:g} degrees): they move along averaged normals, which lowers "
        "the roughness there; round the corners for exact statistics",
        curve.n_sharp_edges, report.request.edge_angle));
  if (curve.n_nonmanifold_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} points join three or more lines: normals at them are a compromise; choose one --group "
        "at a time",
        curve.n_nonmanifold_edges));
}

void warn_of_faces(Report& report, const Surface& surface) {
  if (surface.n_sharp_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} sharp edges (more than {:g} degrees): their nodes move along averaged normals, which "
        "lowers the roughness there; round the edges for exact statistics",
        surface.n_sharp_edges, report.request.edge_angle));
  if (surface.n_nonmanifold_edges > 0)
    report.warnings.push_back(fmt::format(
        "{} edges join three or more faces: normals along them are a compromise; choose one "
        "--group at a time",
        surface.n_nonmanifold_edges));
}

}  // namespace

void warn_of_surface(Report& report, const Surface& surface) {
  const bool is_curve = surface.dimension == 1;
  if (is_curve)
    warn_of_curve(report, surface);
  else
    warn_of_faces(report, surface);
  if (surface.n_coincident_nodes > 0)
    report.warnings.push_back(fmt::format(
        "{} nodes lie where nodes of the rough surface lie, but on none of its {}; they stay, so a "
        "gap opens or closes there; choose the {} of both sides if they belong together",
        surface.n_coincident_nodes, is_curve ? "lines" : "faces", is_curve ? "lines" : "faces"));
  if (surface.n_duplicate_faces > 0)
    report.warnings.push_back(fmt::format("{} {} stand on the nodes of another one and count once",
                                          surface.n_duplicate_faces, is_curve ? "lines" : "faces"));
}

void warn_of_scale(Report& report, const Mesh& mesh, const Surface& surface) {
  const double rq = report.request.rms;
  for (std::string& warning : resolution_warnings(report.resolution, rq))
    report.warnings.push_back(std::move(warning));
  const double spacing = coordinate_spacing(mesh);
  if (rq < 1000 * spacing)
    report.warnings.push_back(fmt::format(
        "--rms {:g} is only {:.3g} spacings of the numbers the file can hold ({:.3g}): heights "
        "are rounded; use a file with more digits",
        rq, rq / spacing, spacing));
  const double h = surface.mesh_size.median;
  if (rq < 1e-6 * h)
    report.warnings.push_back(
        fmt::format("--rms {:g} is {:.1e} of the mesh size {:.3g}; check the unit", rq, rq / h, h));
  const bool is_curve = surface.dimension == 1;
  const double size = is_curve ? surface.area : std::sqrt(surface.area);
  const double length = report.lengths.formula;
  if (length < 1e-2 * h)
    report.warnings.push_back(
        fmt::format("correlation length {:g} is {:.1e} of the mesh size {:.3g}; check the unit",
                    length, length / h, h));
  if (length > size)
    report.warnings.push_back(fmt::format(
        "correlation length {:g} is larger than the {} {:.3g}): it moves nearly as a whole; check "
        "the unit",
        length, is_curve ? "curve (length" : "surface (square root of its area", size));
}

void warn_of_field(Report& report) {
  if (report.audit.covariance_error > report.request.tolerance)
    report.warnings.push_back(
        fmt::format("audited covariance error {:.3g} is above the tolerance {:g}",
                    report.audit.covariance_error, report.request.tolerance));
  if (report.field.variance_change > 1e-3)
    report.warnings.push_back(fmt::format(
        "this autocorrelation is not positive definite for this distance: {} negative "
        "eigenvalues were set to zero, which changes variances by up to {:.3g}; use a shorter "
        "length or --distance euclidean",
        report.field.negative_eigenvalues, report.field.variance_change));
}

void warn_of_curved_elements(Report& report, const MeshCheck& check) {
  if (check.n_curved > 0)
    report.warnings.push_back(
        fmt::format("{} curved elements were checked at their corners only; look at them with the "
                    "checks of your "
                    "solver, or use linear elements",
                    check.n_curved));
}

void warn_of_walls(Report& report, const VolumeMover& mover) {
  if (mover.n_wall_nodes() > 0)
    report.warnings.push_back(fmt::format(
        "{} nodes of the rough surface lie on faces that are not roughened; they move along the "
        "normals of the rough surface while the other nodes of those faces stay, so elements there "
        "invert first",
        mover.n_wall_nodes()));
}

}  // namespace roughmesh::detail
