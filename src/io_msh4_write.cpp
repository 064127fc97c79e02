// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as MSH 4.1 from its arrays.
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
#include "number_writer.hpp"

namespace roughmesh::detail {
namespace {

// MSH 4.1 gives groups to entities only, so blocks that share an entity but not their groups are
// written with an entity each.
struct Entity {
  int dimension = 0;
  Tag tag = 0;
  std::vector<Tag> groups;
  std::vector<const ElementBlock*> blocks;
  const PeriodicLink* link = nullptr;  ///< of an entity without elements: one that names it
};

// Readers want to know the entities that periodic links name, points and curves among them, which
// need not have elements.
void add_linked_entities(const Mesh& mesh, std::set<std::pair<int, Tag>>& taken,
                         std::vector<Entity>& entities) {
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const Tag tag : {link.entity, link.master_entity})
      if (taken.insert({link.dimension, tag}).second)
        entities.push_back({link.dimension, tag, {}, {}, &link});
  std::stable_sort(entities.begin(), entities.end(),
                   [](const Entity& a, const Entity& b) { return a.dimension < b.dimension; });
}

std::vector<Entity> list_entities(const Mesh& mesh) {
  std::map<std::tuple<int, Tag, std::vector<Tag>>, std::vector<const ElementBlock*>> blocks;
  std::array<Tag, 4> largest{};
  for (const ElementBlock& block : mesh.blocks) {
    const int dim = dimension(block.type.shape);
    blocks[{dim, block.entity, block.physical_groups}].push_back(&block);
    Tag& tag = largest[static_cast<std::size_t>(dim)];
    tag = std::max(tag, block.entity);
  }
  for (const PeriodicLink& link : mesh.periodic_links) {
    Tag& tag = largest[static_cast<std::size_t>(link.dimension)];
    tag = std::max({tag, link.entity, link.master_entity});
  }
  std::vector<Entity> entities;
  std::set<std::pair<int, Tag>> taken;
  for (const auto& [key, list] : blocks) {
    const auto& [dim, tag, groups] = key;
    const bool is_free = tag > 0 && taken.insert({dim, tag}).second;
    entities.push_back(
        {dim, is_free ? tag : ++largest[static_cast<std::size_t>(dim)], groups, list, nullptr});
    taken.insert({dim, entities.back().tag});
  }
  add_linked_entities(mesh, taken, entities);
  return entities;
}

class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output, Encoding encoding)
      : mesh_(&mesh),
        path_(output.path()),
        numbers_(output, encoding),
        entities_(list_entities(mesh)) {}

  void write_all() {
    write_msh_format(numbers_, "4.1");
    write_msh_names(numbers_, *mesh_);
    write_entities();
    write_nodes();
    write_elements();
    write_periodic();
  }

 private:
  template <typename... Values>
  void ints(Values... values) {
    (numbers_.number(int32(values)), ...);
  }
  template <typename... Values>
  void sizes(Values... values) {
    (numbers_.number(static_cast<std::uint64_t>(values)), ...);
  }
  void end_line() { numbers_.end_line(); }
  std::int32_t int32(Tag value) const {
    if (std::in_range<std::int32_t>(value)) return static_cast<std::int32_t>(value);
    throw InputError(
        fmt::format("{}: the number {} of an entity or group is beyond 2^31 - 1, which MSH cannot "
                    "hold; renumber the groups",
                    path_.string(), value));
  }

  void begin(std::string_view section) { numbers_.text(fmt::format("${}\n", section)); }
  void end(std::string_view section) {
    numbers_.text(fmt::format("{}$End{}\n", numbers_.is_text() ? "" : "\n", section));
  }

  void write_entities() {
    std::array<int, 4> n{};
    for (const Entity& entity : entities_) ++n[static_cast<std::size_t>(entity.dimension)];
    begin("Entities");
    sizes(n[0], n[1], n[2], n[3]);
    end_line();
    for (const Entity& entity : entities_) write_entity(entity);
    end("Entities");
  }

  void write_entity(const Entity& entity) {
    Eigen::AlignedBox3d box;
    for (const ElementBlock* block : entity.blocks)
      for (const Index node : block->nodes) box.extend(mesh_->nodes[node]);
    if (entity.link != nullptr)
      for (const auto& [slave, master] : entity.link->nodes)
        box.extend(mesh_->nodes[entity.tag == entity.link->entity ? slave : master]);
    if (box.isEmpty()) box.extend(Vec3(0, 0, 0));
    ints(entity.tag);
    numbers_.vector(box.min());
    if (entity.dimension > 0) numbers_.vector(box.max());
    sizes(entity.groups.size());
    for (const Tag group : entity.groups) ints(group);
    if (entity.dimension > 0) sizes(0);
    end_line();
  }

  // One block: which entity a node lies on is not known, and readers need any that exists.
  void write_nodes() {
    const auto [least, greatest] =
        std::minmax_element(mesh_->node_tags.begin(), mesh_->node_tags.end());
    const std::size_t n = mesh_->nodes.size();
    const Entity& entity = *std::find_if(entities_.rbegin(), entities_.rend(),
                                         [](const Entity& each) { return !each.blocks.empty(); });
    begin("Nodes");
    sizes(1, n, *least, *greatest);
    end_line();
    ints(entity.dimension, entity.tag, 0);
    sizes(n);
    end_line();
    for (const Tag tag : mesh_->node_tags) sizes(tag), end_line();
    for (const Vec3& x : mesh_->nodes) numbers_.vector(x), end_line();
    end("Nodes");
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
    begin("Elements");
    sizes(n_blocks, n_elements(*mesh_), least, greatest);
    end_line();
    for (const Entity& entity : entities_)
      for (const ElementBlock* block : entity.blocks) write_block(entity, *block);
    end("Elements");
  }

  void write_block(const Entity& entity, const ElementBlock& block) {
    ints(entity.dimension, entity.tag, gmsh_number(block.type));
    sizes(block.size());
    end_line();
    for (Index i = 0; i < block.size(); ++i) {
      sizes(block.tags[static_cast<std::size_t>(i)]);
      for (const Index node : block.element(i)) sizes(mesh_->node_tags[node]);
      end_line();
    }
  }

  void write_periodic() {
    if (mesh_->periodic_links.empty()) return;
    begin("Periodic");
    sizes(mesh_->periodic_links.size());
    end_line();
    for (const PeriodicLink& link : mesh_->periodic_links) write_link(link);
    end("Periodic");
  }

  void write_link(const PeriodicLink& link) {
    ints(link.dimension, link.entity, link.master_entity);
    end_line();
    sizes(link.affine.size());
    for (const double value : link.affine) numbers_.number(value);
    end_line();
    sizes(link.nodes.size());
    end_line();
    for (const auto& [slave, master] : link.nodes)
      sizes(mesh_->node_tags[slave], mesh_->node_tags[master]), end_line();
  }

  const Mesh* mesh_;
  std::filesystem::path path_;
  NumberWriter numbers_;
  std::vector<Entity> entities_;
};

// A name stands between double quotes in a line of its own.
std::string msh_name(std::string name) {
  for (char& c : name) {
    if (c == '"') c = '\'';
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '_';
  }
  return name;
}

}  // namespace

void check_for_msh(const Mesh& mesh, const std::filesystem::path& path) {
  for (const ElementBlock& block : mesh.blocks)
    if (gmsh_number(block.type) == 0)
      throw InputError(fmt::format("{}: MSH has no {} with {} nodes; use another element",
                                   path.string(), name(block.type), block.type.n_nodes));
}

void write_msh_format(NumberWriter& numbers, std::string_view version) {
  numbers.text(fmt::format("$MeshFormat\n{} {} 8\n", version, numbers.is_text() ? 0 : 1));
  if (!numbers.is_text()) {
    numbers.number(std::int32_t{1});  // tells the byte order
    numbers.text("\n");
  }
  numbers.text("$EndMeshFormat\n");
}

std::vector<std::string> losses_of_msh(const Mesh& mesh) {
  const auto n = std::count_if(mesh.groups.begin(), mesh.groups.end(), [](const auto& group) {
    return msh_name(group.name) != group.name;
  });
  if (n == 0) return {};
  return {fmt::format("quotes and control characters in the names of {} physical groups", n)};
}

void write_msh_names(NumberWriter& numbers, const Mesh& mesh) {
  const auto is_named = [](const PhysicalGroup& group) { return !group.name.empty(); };
  const auto n = std::count_if(mesh.groups.begin(), mesh.groups.end(), is_named);
  if (n == 0) return;
  numbers.text(fmt::format("$PhysicalNames\n{}\n", n));
  for (const PhysicalGroup& group : mesh.groups)
    if (is_named(group))
      numbers.text(fmt::format("{} {} \"{}\"\n", group.dimension, group.tag, msh_name(group.name)));
  numbers.text("$EndPhysicalNames\n");
}

void write_new_msh4(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  Writer(mesh, output, options.encoding.value_or(Encoding::text)).write_all();
}

}  // namespace roughmesh::detail
