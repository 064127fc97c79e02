// SPDX-License-Identifier: BSD-3-Clause
#include "volume_stage.hpp"

#include <utility>

#include <fmt/format.h>

#include "field_ensemble.hpp"
#include "refusals.hpp"
#include "warnings.hpp"

namespace roughmesh::detail {
namespace {

std::vector<Vec3> differences(std::span<const Vec3> after, std::span<const Vec3> before) {
  std::vector<Vec3> result(after.begin(), after.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= before[i];
  return result;
}

VolumeMethod last_method(const RoughenOptions& options) {
  return options.volume == VolumeChoice::move ? VolumeMethod::split : VolumeMethod::none;
}

}  // namespace

VolumeStage::VolumeStage(const Mesh& mesh, const RoughSurfaces& surfaces, const Walls& walls,
                         Report& report, StageTimer& timer)
    : mesh_(mesh),
      surfaces_(surfaces),
      walls_(walls),
      report_(report),
      timer_(timer),
      mover_(timer.time(&Timings::volume, [&] { return make_mover(walls); })),
      remesher_(timer.time(&Timings::volume, [&] { return make_remesher(); })),
      enclosure_(timer.time(&Timings::check, [&] { return Enclosure(mesh); })) {}

std::unique_ptr<const VolumeMover> VolumeStage::make_mover(const Walls& walls) const {
  if (report_.request.volume == VolumeChoice::remesh) return nullptr;
  return std::make_unique<const VolumeMover>(mesh_, surfaces_.surfaces, walls,
                                             last_method(report_.request));
}

std::unique_ptr<const Remesher> VolumeStage::make_remesher() const {
  if (report_.request.volume != VolumeChoice::remesh) return nullptr;
  return std::make_unique<const Remesher>(mesh_, surfaces_.surfaces, report_.request);
}

VolumeStage::Result VolumeStage::follow(std::span<const Vec3> displacements,
                                        const std::vector<Vec3>& surface, const std::string& remedy,
                                        RoughMesh& rough) {
  return remesher_ ? remesh(surface, remedy, rough) : move(displacements, surface, remedy, rough);
}

VolumeStage::Result VolumeStage::remesh(const std::vector<Vec3>& surface, const std::string& remedy,
                                        RoughMesh& rough) {
  take_remeshed(*remesher_, surface, rough);
  refuse_invalid(rough.check, rough.realization, remedy, report_);
  report_remeshed(rough);
  return {VolumeMethod::remesh, surface};
}

VolumeStage::Result VolumeStage::move(std::span<const Vec3> displacements,
                                      const std::vector<Vec3>& surface, std::string remedy,
                                      RoughMesh& rough) {
  const MovedVolume moved =
      timer_.time(&Timings::volume, [&] { return mover_->move(displacements); });
  take_moved(moved, rough);
  if (!rough.check.valid()) {
    std::vector<Vec3> with_walls = surface;
    for (const SlidingNode& each : walls_.sliding) with_walls[each.node] = moved.nodes[each.node];
    if (remesh_at_last(with_walls, remedy, rough))
      return {VolumeMethod::remesh, std::move(with_walls)};
  }
  refuse_invalid(rough.check, rough.realization, remedy, report_);
  report_moved(moved, rough);
  return {
      moved.method,
      {moved.nodes.begin(), moved.nodes.begin() + static_cast<std::ptrdiff_t>(mesh_.nodes.size())}};
}

void VolumeStage::take_moved(const MovedVolume& moved, RoughMesh& rough) {
  const Mesh& smooth = moved.split ? *moved.split : mesh_;
  if (moved.split || has_own_elements_) rough.mesh = smooth;  // else only its nodes differ
  has_own_elements_ = moved.split != nullptr;
  old_nodes_.reset();
  rough.mesh.nodes = moved.nodes;
  rough.displacements = differences(moved.nodes, smooth.nodes);
  rough.check =
      timer_.time(&Timings::check, [&] { return check_mesh(smooth, moved.nodes, enclosure_); });
}

void VolumeStage::take_remeshed(const Remesher& remesher, const std::vector<Vec3>& nodes,
                                RoughMesh& rough) {
  RemeshedVolume remeshed = timer_.time(&Timings::volume, [&] { return remesher.remesh(nodes); });
  rough.mesh = *remeshed.mesh;
  old_nodes_ = std::move(remeshed.old_nodes);
  has_own_elements_ = true;
  rough.displacements = on_nodes_of<Vec3>(rough.mesh, mesh_.nodes, Vec3::Zero());
  for (std::size_t i = 0; i < old_nodes_->size(); ++i)  // with those that follow on bent edges
    rough.displacements[i] = rough.mesh.nodes[i] - rough.displacements[i];
  rough.check = timer_.time(&Timings::check, [&] {
    if (dimension(mesh_) == 3) return check_remeshed(rough.mesh, nodes, enclosure_);
    return check_remeshed(rough.mesh, rough.mesh.nodes, Enclosure(rough.mesh));
  });
}

// Where moving its nodes leaves a mesh invalid. The remedy tells why there is no way out here.
bool VolumeStage::remesh_at_last(const std::vector<Vec3>& nodes, std::string& remedy,
                                 RoughMesh& rough) {
  if (report_.request.volume != VolumeChoice::move || dimension(mesh_) < 3) return false;
  if (!gmsh_program(report_.request).exists()) {
    remedy += "; with the gmsh program (--gmsh PATH) its volume would be meshed anew";
    return false;
  }
  const RoughMesh before = rough;
  const bool had_own_elements = has_own_elements_;
  try {
    take_remeshed(Remesher(mesh_, surfaces_.surfaces, report_.request), nodes, rough);
    if (rough.check.valid()) {
      report_remeshed(rough);
      return true;
    }
    remedy += "; meshing its volume anew left it invalid too";
  } catch (const Error& error) {
    remedy += fmt::format("; meshing its volume anew failed: {}", error.what());
  }
  rough = before;
  has_own_elements_ = had_own_elements;
  old_nodes_.reset();
  return false;
}

void VolumeStage::report_moved(const MovedVolume& moved, const RoughMesh& rough) const {
  if (report_.realizations.empty()) warn_of_curved_elements(report_, rough.check);
  if (moved.split) warn_of_split(report_, rough.realization, mesh_, *moved.split);
  if (moved.method > VolumeMethod::harmonic)
    add_citations(report_.citations,
                  {"Garanzha et al. (2021), Foldover-free maps in 50 lines of code, "
                   "doi:10.1145/3450626.3459847"});
}

void VolumeStage::report_remeshed(const RoughMesh& rough) const {
  warn_of_remeshing(report_, rough.realization, mesh_, rough.mesh);
  if (report_.realizations.empty()) warn_of_curved_elements(report_, rough.check);
  add_citations(
      report_.citations,
      {"Geuzaine and Remacle (2009), Gmsh, doi:10.1002/nme.2579",
       "Marot, Pellerin and Remacle (2019), One machine, one minute, three billion tetrahedra, "
       "doi:10.1002/nme.5987"});
}

}  // namespace roughmesh::detail
