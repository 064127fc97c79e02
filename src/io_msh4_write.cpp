// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as MSH 4.1 text from its arrays.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "gmsh_element_types.hpp"
#include "io_msh.hpp"

namespace roughmesh::detail {
namespace {

// MSH 4.1 gives groups to entities only, so blocks that share an entity but not their groups are
// written with an entity each.
struct Entity {
  int dimension = 0;
  Tag tag = 0;
  std::vector<Tag> groups;
  std::vector<const ElementBlock*> blocks;
};

std::vector<Entity> list_entities(const Mesh& mesh) {
  std::map<std::tuple<int, Tag, std::vector<Tag>>, std::vector<const ElementBlock*>> blocks;
  std::array<Tag, 4> largest{};
  for (const ElementBlock& block : mesh.blocks) {
    const int dim = dimension(block.type.shape);
    blocks[{dim, block.entity, block.physical_groups}].push_back(&block);
    Tag& tag = largest[static_cast<std::size_t>(dim)];
    tag = std::max(tag, block.entity);
  }
  std::vector<Entity> entities;
  std::set<std::pair<int, Tag>> taken;
  for (const auto& [key, list] : blocks) {
    const auto& [dim, tag, groups] = key;
    const bool is_free = tag > 0 && taken.insert({dim, tag}).second;
    entities.push_back(
        {dim, is_free ? tag : ++largest[static_cast<std::size_t>(dim)], groups, list});
  }
  return entities;
}

class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output)
      : mesh_(&mesh), output_(&output), entities_(list_entities(mesh)) {}

  void write_all() {
    line("$MeshFormat\n4.1 0 8\n$EndMeshFormat");
    write_names();
    write_entities();
    write_nodes();
    write_elements();
    write_periodic();
  }

 private:
  template <typename... Values>
  void text(fmt::format_string<Values...> format, Values&&... values) {
    output_->write(fmt::format(format, std::forward<Values>(values)...));
  }
  void line(std::string_view line) { text("{}\n", line); }

  void write_names() {
    const auto is_named = [](const PhysicalGroup& group) { return !group.name.empty(); };
    const auto n = std::count_if(mesh_->groups.begin(), mesh_->groups.end(), is_named);
    if (n == 0) return;
    text("$PhysicalNames\n{}\n", n);
    for (const PhysicalGroup& group : mesh_->groups)
      if (is_named(group)) text("{} {} \"{}\"\n", group.dimension, group.tag, group.name);
    line("$EndPhysicalNames");
  }

  void write_entities() {
    std::array<int, 4> n{};
    for (const Entity& entity : entities_) ++n[static_cast<std::size_t>(entity.dimension)];
    text("$Entities\n{}\n", fmt::join(n, " "));
    for (const Entity& entity : entities_) write_entity(entity);
    line("$EndEntities");
  }

  void write_entity(const Entity& entity) {
    Eigen::AlignedBox3d box;
    for (const ElementBlock* block : entity.blocks)
      for (const Index node : block->nodes) box.extend(mesh_->nodes[node]);
    const Vec3 low = box.min(), high = box.max();
    text("{} {} {} {}", entity.tag, low[0], low[1], low[2]);
    if (entity.dimension > 0) text(" {} {} {}", high[0], high[1], high[2]);
    text(" {}", entity.groups.size());
    for (const Tag group : entity.groups) text(" {}", group);
    line(entity.dimension > 0 ? " 0" : "");
  }

  // One block: which entity a node lies on is not known, and readers need any that exists.
  void write_nodes() {
    const auto [least, greatest] =
        std::minmax_element(mesh_->node_tags.begin(), mesh_->node_tags.end());
    const std::size_t n = mesh_->nodes.size();
    const Entity& entity = entities_.back();
    text("$Nodes\n1 {} {} {}\n{} {} 0 {}\n", n, *least, *greatest, entity.dimension, entity.tag, n);
    for (const Tag tag : mesh_->node_tags) text("{}\n", tag);
    for (const Vec3& x : mesh_->nodes) text("{} {} {}\n", x[0], x[1], x[2]);
    line("$EndNodes");
  }

  void write_elements() {
    std::size_t n_blocks = 0;
    Tag least = std::numeric_limits<Tag>::max(), greatest = 0;
    for (const Entity& entity : entities_)
      for (const ElementBlock* block : entity.blocks) {
        ++n_blocks;
        for (const Tag tag : block->tags) {
          least = std::min(least, tag);
          greatest = std::max(greatest, tag);
        }
      }
    text("$Elements\n{} {} {} {}\n", n_blocks, n_elements(*mesh_), least, greatest);
    for (const Entity& entity : entities_)
      for (const ElementBlock* block : entity.blocks) write_block(entity, *block);
    line("$EndElements");
  }

  void write_block(const Entity& entity, const ElementBlock& block) {
    text("{} {} {} {}\n", entity.dimension, entity.tag, gmsh_number(block.type), block.size());
    for (Index i = 0; i < block.size(); ++i) {
      text("{}", block.tags[static_cast<std::size_t>(i)]);
      for (const Index node : block.element(i)) text(" {}", mesh_->node_tags[node]);
      line("");
    }
  }

  void write_periodic() {
    if (mesh_->periodic_links.empty()) return;
    text("$Periodic\n{}\n", mesh_->periodic_links.size());
    for (const PeriodicLink& link : mesh_->periodic_links) {
      text("{} {} {}\n{}", link.dimension, link.entity, link.master_entity, link.affine.size());
      for (const double value : link.affine) text(" {}", value);
      text("\n{}\n", link.nodes.size());
      for (const auto& [slave, master] : link.nodes)
        text("{} {}\n", mesh_->node_tags[slave], mesh_->node_tags[master]);
    }
    line("$EndPeriodic");
  }

  const Mesh* mesh_;
  OutputFile* output_;
  std::vector<Entity> entities_;
};

}  // namespace

void check_for_msh(const Mesh& mesh, const std::filesystem::path& path) {
  for (const ElementBlock& block : mesh.blocks)
    if (gmsh_number(block.type) == 0)
      throw InputError(fmt::format("{}: MSH has no {} with {} nodes; use another element",
                                   path.string(), name(block.type), block.type.n_nodes));
}

void write_new_msh4(const Mesh& mesh, const WriteOptions&, OutputFile& output) {
  Writer(mesh, output).write_all();
}

}  // namespace roughmesh::detail
