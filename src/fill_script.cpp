// SPDX-License-Identifier: BSD-3-Clause
#include "fill_script.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "roughmesh/mesh_io.hpp"

#include "number_writer.hpp"
#include "output_file.hpp"

namespace roughmesh::detail {
namespace {

constexpr std::string_view surfaces_name = "surfaces.msh", sizes_name = "sizes.dat";

Mesh mesh_of(const FillTask& task) {
  Mesh mesh;
  mesh.nodes = task.nodes;
  mesh.node_tags.resize(task.nodes.size());
  std::iota(mesh.node_tags.begin(), mesh.node_tags.end(), Tag{1});
  Tag next = 1;
  for (std::size_t s = 0; s < task.sheets.size(); ++s) {
    ElementBlock& block = mesh.blocks.emplace_back();
    block.type = {ElementShape::triangle, 1, 3};
    block.entity = static_cast<Tag>(s) + 1;
    for (const auto& triangle : task.sheets[s].triangles)
      block.nodes.insert(block.nodes.end(), triangle.begin(), triangle.end());
    block.tags.resize(task.sheets[s].triangles.size());
    std::iota(block.tags.begin(), block.tags.end(), next);
    next += block.size();
  }
  return mesh;
}

// Gmsh's structured field: corner, spacings, numbers of points, values.
void write_sizes(const SizeLattice& lattice, const std::filesystem::path& path) {
  OutputFile file(path);
  NumberWriter numbers(file, Encoding::binary);
  numbers.vector(lattice.corner);
  numbers.vector(Vec3::Constant(lattice.spacing));
  for (const int n : lattice.n) numbers.number(std::int32_t{n});
  for (const double size : lattice.sizes) numbers.number(size);
  file.commit();
}

std::string numbers_from_one(std::span<const Index> numbers) {
  std::string list;
  for (const Index number : numbers)
    list += fmt::format("{}{}", list.empty() ? "" : ", ", number + 1);
  return list;
}

std::string volume_script(const VolumeToFill& volume, std::size_t number) {
  std::string script = fmt::format("Surface Loop({0}) = {{{1}}};\nVolume({0}) = {{{0}}};\n", number,
                                   numbers_from_one(volume.boundary));
  if (!volume.inside.empty())
    script +=
        fmt::format("Surface{{{}}} In Volume{{{}}};\n", numbers_from_one(volume.inside), number);
  return script;
}

std::string fill_script(const FillTask& task) {
  std::string script = fmt::format("Merge \"{}\";\n", surfaces_name);
  for (std::size_t v = 0; v < task.volumes.size(); ++v)
    script += volume_script(task.volumes[v], v + 1);
  const auto [least, most] = std::minmax_element(task.sizes.sizes.begin(), task.sizes.sizes.end());
  script += fmt::format(
      "Field[1] = Structured;\nField[1].FileName = \"{}\";\nField[1].TextFormat = 0;\n"
      "Background Field = 1;\n"
      "Mesh.MeshSizeMin = {:.17g};\nMesh.MeshSizeMax = {:.17g};\nMesh.MeshSizeFactor = 1;\n",
      sizes_name, *least, *most);
  // Without Renumber = 0 the nodes that are kept would lose their numbers.
  script += fmt::format(
      "Mesh.MeshSizeFromCurvature = 0;\nMesh.MeshSizeFromPoints = 0;\n"
      "Mesh.MeshSizeExtendFromBoundary = 0;\nMesh.Renumber = 0;\nMesh.Algorithm3D = 10;\n"
      "Mesh.SaveAll = 1;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 1;\nMesh.SaveParametric = 0;\n"
      "Mesh 3;\nSave \"{}\";\n",
      filled_name);
  return script;
}

}  // namespace

void write_fill_files(const FillTask& task, const ScratchFolder& folder) {
  write_mesh(mesh_of(task), folder / surfaces_name,
             {.format = MeshFormat::msh4, .encoding = Encoding::binary});
  write_sizes(task.sizes, folder / sizes_name);
  OutputFile script(folder / fill_script_name);
  script.write(fill_script(task));
  script.commit();
}

}  // namespace roughmesh::detail
