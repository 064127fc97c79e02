// SPDX-License-Identifier: BSD-3-Clause
#include "fill_surface.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "messages.hpp"
#include "new_tags.hpp"
#include "size_lattice.hpp"

namespace roughmesh::detail {
namespace {

constexpr ElementType triangle_type{ElementShape::triangle, 1, 3};
constexpr ElementType tetrahedron_type{ElementShape::tetrahedron, 1, 4};

// Of each node the mean edge of the triangles around it; 0 off them.
std::vector<double> mean_edges(const Mesh& mesh, const NestedSurfaces& nested) {
  std::vector<double> sums(mesh.nodes.size(), 0);
  std::vector<Index> n_edges(mesh.nodes.size(), 0);
  for (const auto& component : nested.components)
    for (const auto& t : component.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        for (const Index end : {t[k], t[(k + 1) % 3]}) {
          sums[end] += (mesh.nodes[t[k]] - mesh.nodes[t[(k + 1) % 3]]).norm();
          ++n_edges[end];
        }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(n_edges[i], Index{1});
  return sums;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::AlignedBox3d bounding_box(std::span<const Vec3> nodes, std::span<const Index> used) {
  Eigen::AlignedBox3d box;
  for (const Index node : used) box.extend(nodes[node]);
  return box;
}

/// Puts surface, box and tetrahedra together under numbers and groups of their own.
class Assembly {
 public:
  Assembly(const Mesh& input, std::span<const Vec3> positions) : mesh_(input) {
    mesh_.nodes.assign(positions.begin(), positions.end());
    node_tags_.keep_off(input.node_tags);
    for (const ElementBlock& block : input.blocks) element_tags_.keep_off(block.tags);
  }

  Index add_node(const Vec3& x) {
    mesh_.nodes.push_back(x);
    mesh_.node_tags.push_back(node_tags_.next());
    return mesh_.n_nodes() - 1;
  }

  void add_block(const ElementType& type, const std::string& group, std::vector<Index> nodes) {
    const int dim = dimension(type.shape);
    NewTags entities("entity");
    for (const ElementBlock& block : mesh_.blocks)
      if (dimension(block.type.shape) == dim) entities.keep_off(block.entity);
    ElementBlock block{type, entities.next(), {add_group(dim, group)}, std::move(nodes), {}};
    block.tags.resize(block.nodes.size() / static_cast<std::size_t>(type.n_nodes));
    for (Tag& tag : block.tags) tag = element_tags_.next();
    mesh_.blocks.push_back(std::move(block));
  }

  // Of faces that have none.
  void name_faces(const std::string& group) {
    Tag tag = 0;
    for (ElementBlock& block : mesh_.blocks) {
      if (dimension(block.type.shape) != 2 || !block.physical_groups.empty()) continue;
      if (tag == 0) tag = add_group(2, group);
      block.physical_groups = {tag};
    }
  }

  Mesh take() && {
    std::sort(mesh_.groups.begin(), mesh_.groups.end(), [](const auto& a, const auto& b) {
      return std::pair(a.dimension, a.tag) < std::pair(b.dimension, b.tag);
    });
    return std::move(mesh_);
  }

 private:
  Tag add_group(int dim, const std::string& group) {
    NewTags tags("group");
    for (const PhysicalGroup& each : mesh_.groups)
      if (each.dimension == dim) tags.keep_off(each.tag);
    const Tag tag = tags.next();
    mesh_.groups.push_back({dim, tag, group});
    return tag;
  }

  Mesh mesh_;
  NewTags node_tags_{"node"}, element_tags_{"element"};
};

}  // namespace

SurfaceFiller::SurfaceFiller(const Mesh& mesh, std::optional<double> box, GmshProgram gmsh)
    : mesh_(mesh), gmsh_(std::move(gmsh)), nested_(find_nested_surfaces(mesh)) {
  const std::vector<double> edges = mean_edges(mesh, nested_);
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    if (edges[node] == 0) continue;
    used_nodes_.push_back(node);
    sizes_.push_back(edges[node]);
  }
  if (box) add_box(*box);
}

// Its squares are what edges have grown to on the shortest way from the surface.
void SurfaceFiller::add_box(double factor) {
  const Eigen::AlignedBox3d inner = bounding_box(mesh_.nodes, used_nodes_);
  const Vec3 half = inner.sizes() * (factor / 2);
  const Vec3 centre = inner.center();
  const double gap = (factor - 1) / 2 * inner.sizes().minCoeff();
  box_ =
      make_box_surface({Vec3(centre - half), Vec3(centre + half)}, median(sizes_) + growth * gap);
}

// One sheet and one volume for each component; the volume around it has it as a boundary too.
void SurfaceFiller::add_components(std::span<const Index> number, FillTask& task) const {
  const std::size_t n_components = nested_.components.size();
  task.volumes.resize(n_components + (box_ ? 1 : 0));
  for (std::size_t c = 0; c < n_components; ++c) {
    const auto& component = nested_.components[c];
    Sheet& sheet = task.sheets.emplace_back(Sheet{component.triangles, component.elements});
    for (auto& t : sheet.triangles)
      for (Index& node : t) node = number[node];
    const auto s = static_cast<Index>(c);
    task.volumes[c].boundary.push_back(s);
    if (component.around >= 0)
      task.volumes[component.around].boundary.push_back(s);
    else if (box_)
      task.volumes.back().boundary.push_back(s);
  }
}

void SurfaceFiller::add_box_sheet(FillTask& task) const {
  const auto first = static_cast<Index>(task.nodes.size());
  task.volumes.back().boundary.push_back(static_cast<Index>(task.sheets.size()));
  Sheet& sheet = task.sheets.emplace_back(Sheet{box_->triangles, {}});
  for (auto& t : sheet.triangles)
    for (Index& node : t) node += first;
  sheet.elements.assign(sheet.triangles.size(), 0);
  task.nodes.insert(task.nodes.end(), box_->nodes.begin(), box_->nodes.end());
}

FillTask SurfaceFiller::make_task(std::span<const Vec3> positions) const {
  FillTask task;
  std::vector<Index> number(mesh_.nodes.size(), -1);
  for (const Index node : used_nodes_) {
    number[node] = static_cast<Index>(task.nodes.size());
    task.nodes.push_back(positions[node]);
  }
  add_components(number, task);
  std::vector<double> sizes = sizes_;
  if (box_) {
    add_box_sheet(task);
    sizes.resize(task.nodes.size(), (box_->nodes[1] - box_->nodes[0]).norm());
  }
  task.sizes = growing_sizes(task.nodes, sizes);
  return task;
}

Mesh SurfaceFiller::with_groups(std::span<const Vec3> positions,
                                const FilledVolumes& filled) const {
  Assembly assembly(mesh_, positions);
  assembly.name_faces("surface");
  std::vector<Index> number = used_nodes_;  // in the mesh, of each node of the task
  if (box_) {
    const auto first = static_cast<Index>(number.size());
    for (const Vec3& x : box_->nodes) number.push_back(assembly.add_node(x));
    std::vector<Index> nodes;
    for (const auto& t : box_->triangles)
      for (const Index node : t) nodes.push_back(number[first + node]);
    assembly.add_block(triangle_type, "box", std::move(nodes));
  }
  for (const Vec3& x : filled.new_nodes) number.push_back(assembly.add_node(x));
  const std::size_t n_inside = nested_.components.size();
  for (std::size_t v = 0; v < filled.tetrahedra.size(); ++v) {
    std::vector<Index> nodes;
    for (const Tetrahedron& t : filled.tetrahedra[v])
      for (const Index node : t) nodes.push_back(number[node]);
    const std::string name = v == n_inside   ? "outside"
                             : n_inside == 1 ? "inside"
                                             : fmt::format("inside_{}", v + 1);
    assembly.add_block(tetrahedron_type, name, std::move(nodes));
  }
  return std::move(assembly).take();
}

RemeshedVolume SurfaceFiller::fill(std::span<const Vec3> positions) const {
  if (box_) {
    Eigen::AlignedBox3d box;
    for (const Vec3& x : box_->nodes) box.extend(x);
    for (const Index node : used_nodes_)
      if (!(positions[node].array() > box.min().array()).all() ||
          !(positions[node].array() < box.max().array()).all())
        throw CheckError(fmt::format("the surface reaches the box at {}; give a larger --box",
                                     place(positions[node])));
  }
  auto mesh = std::make_shared<const Mesh>(
      with_groups(positions, fill_volumes(make_task(positions), gmsh_)));
  RemeshedVolume result{std::move(mesh), std::vector<Index>(mesh_.nodes.size())};
  std::iota(result.old_nodes.begin(), result.old_nodes.end(), Index{0});
  return result;
}

}  // namespace roughmesh::detail
