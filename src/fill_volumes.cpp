// SPDX-License-Identifier: BSD-3-Clause
#include "fill_volumes.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "corners.hpp"
#include "fill_guards.hpp"
#include "fill_script.hpp"
#include "gmsh_process.hpp"
#include "messages.hpp"
#include "surface_faces.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::string_view another_gmsh = "try a newer gmsh (--gmsh PATH) or lower --rms";

[[noreturn]] void fail_misfit(const std::string& what) {
  throw NumericalError(fmt::format("gmsh filled the volume, but {}; {}", what, another_gmsh));
}

// Gmsh goes on after most errors, so that only what it wrote tells whether it succeeded.
Mesh run_fill(const ScratchFolder& folder, const GmshProgram& gmsh) {
  const GmshOutcome outcome =
      run_gmsh(folder, {.program = gmsh.path,
                        .arguments = {"-", std::string(fill_script_name), "-nt", "1", "-v", "3"},
                        .timeout = gmsh.timeout,
                        .has_size = false});
  const std::string said = first_error(outcome.output);
  const bool has_mesh = std::filesystem::exists(folder / filled_name);
  if (outcome.exit_status != 0 || !has_mesh)
    throw NumericalError(fmt::format("{}: could not fill the volume (exit status {}){}{}; {}",
                                     gmsh.path, outcome.exit_status, said.empty() ? "" : ": ", said,
                                     another_gmsh));
  try {
    return read_mesh(folder / filled_name);
  } catch (const FormatError& error) {
    const std::string_view what = error.what();
    throw NumericalError(fmt::format("{}: wrote a mesh that cannot be read ({}); {}", gmsh.path,
                                     what.substr(folder.path().string().size() + 1), another_gmsh));
  }
}

// Numbers of the task's nodes and, after them, of new ones: of each node of the mesh that gmsh
// made.
std::vector<Index> number_nodes(const Mesh& made, const FillTask& task,
                                std::vector<Vec3>& new_nodes) {
  const auto n = static_cast<Tag>(task.nodes.size());
  std::vector<Index> number(made.nodes.size());
  Tag n_kept = 0;
  for (std::size_t i = 0; i < made.nodes.size(); ++i) {
    const Tag tag = made.node_tags[i];
    if (tag >= 1 && tag <= n) {
      if (made.nodes[i] != task.nodes[static_cast<std::size_t>(tag - 1)])
        fail_misfit("moved a node of the surface");
      number[i] = static_cast<Index>(tag - 1);
      ++n_kept;
      continue;
    }
    number[i] = static_cast<Index>(task.nodes.size() + new_nodes.size());
    new_nodes.push_back(made.nodes[i]);
  }
  if (n_kept != n) fail_misfit("lost nodes of the surface");
  return number;
}

FilledVolumes take_tetrahedra(const Mesh& made, const FillTask& task) {
  FilledVolumes filled;
  filled.tetrahedra.resize(task.volumes.size());
  const std::vector<Index> number = number_nodes(made, task, filled.new_nodes);
  for (const ElementBlock& block : made.blocks) {
    if (dimension(block.type.shape) != 3) continue;
    const bool is_known =
        block.entity >= 1 && block.entity <= static_cast<Tag>(task.volumes.size());
    if (!is_known || block.type.shape != ElementShape::tetrahedron || block.type.order != 1)
      fail_misfit("made something else than tetrahedra of it");
    auto& out = filled.tetrahedra[static_cast<std::size_t>(block.entity - 1)];
    for (Index e = 0; e < block.size(); ++e) {
      Tetrahedron& t = out.emplace_back();
      std::transform(block.element(e).begin(), block.element(e).end(), t.begin(),
                     [&](Index node) { return number[node]; });
    }
  }
  return filled;
}

void check_signs(const FillTask& task, const FilledVolumes& filled) {
  const auto place_of = [&](Index node) -> const Vec3& {
    const auto i = static_cast<std::size_t>(node);
    return i < task.nodes.size() ? task.nodes[i] : filled.new_nodes[i - task.nodes.size()];
  };
  for (const auto& tetrahedra : filled.tetrahedra)
    for (const Tetrahedron& t : tetrahedra)
      if (!(determinant(place_of(t[0]), place_of(t[1]), place_of(t[2]), place_of(t[3])) > 0))
        fail_misfit(fmt::format("made an inverted tetrahedron at {}", place(place_of(t[0]))));
}

std::vector<FaceKey> keys_of(const FillTask& task, const std::vector<Index>& sheets) {
  std::vector<FaceKey> keys;
  for (const Index s : sheets)
    for (const auto& triangle : task.sheets[s].triangles) keys.push_back(face_key(triangle));
  std::sort(keys.begin(), keys.end());
  return keys;
}

// Positive tetrahedra whose faces occur twice, but for those of the boundary, which occur once, are
// a mesh of the volume, wherever their nodes lie.
void check_faces(const FillTask& task, const VolumeToFill& volume,
                 const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<FaceKey> faces, once, twice;
  for (const Tetrahedron& t : tetrahedra)
    for (const std::vector<int>& local : local_faces(ElementShape::tetrahedron)) {
      const std::array<Index, 3> face = {t[local[0]], t[local[1]], t[local[2]]};
      faces.push_back(face_key(face));
    }
  std::sort(faces.begin(), faces.end());
  for (std::size_t first = 0, end = 0; first < faces.size(); first = end) {
    while (end < faces.size() && faces[end] == faces[first]) ++end;
    if (end - first > 2) fail_misfit("tetrahedra overlap");
    (end - first == 1 ? once : twice).push_back(faces[first]);
  }
  if (once != keys_of(task, volume.boundary)) fail_misfit("its boundary is another");
  const std::vector<FaceKey> inside = keys_of(task, volume.inside);
  if (!std::includes(twice.begin(), twice.end(), inside.begin(), inside.end()))
    fail_misfit("elements cross a surface inside it");
}

bool is_program(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

bool GmshProgram::exists() const {
  if (path.find('/') != std::string::npos) return is_program(path);
  const char* const folders = std::getenv("PATH");
  std::string_view rest = folders == nullptr ? "" : folders;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (is_program(std::filesystem::path(rest.substr(0, end)) / path)) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

FilledVolumes fill_volumes(const FillTask& task, const GmshProgram& gmsh) {
  check_fill_task(task);
  const ScratchFolder folder;
  write_fill_files(task, folder);
  FilledVolumes filled = take_tetrahedra(run_fill(folder, gmsh), task);
  check_signs(task, filled);
  for (std::size_t v = 0; v < task.volumes.size(); ++v)
    check_faces(task, task.volumes[v], filled.tetrahedra[v]);
  return filled;
}

}  // namespace roughmesh::detail
