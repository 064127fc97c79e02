// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as MSH 2.2 from its arrays.
#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "gmsh_element_types.hpp"
#include "io_msh.hpp"
#include "number_writer.hpp"

namespace roughmesh::detail {
namespace {

// How often an element of the block is listed: once for each of its groups.
std::size_t n_listings(const ElementBlock& block) {
  return std::max<std::size_t>(block.physical_groups.size(), 1);
}

Tag total_listings(const Mesh& mesh) {
  Tag n = 0;
  for (const ElementBlock& block : mesh.blocks)
    n += block.size() * static_cast<Tag>(n_listings(block));
  return n;
}

Tag largest_tag(const Mesh& mesh) {
  Tag largest = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (const Tag tag : block.tags) largest = std::max(largest, tag);
  return largest;
}

class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output, Encoding encoding)
      : mesh_(&mesh), numbers_(output, encoding), next_tag_(largest_tag(mesh)) {}

  void write_all() {
    write_msh_format(numbers_, "2.2");
    write_msh_names(numbers_, *mesh_);
    write_nodes();
    write_elements();
    write_periodic();
  }

 private:
  // The check has seen that they fit.
  void integer(Tag value) { numbers_.number(static_cast<std::int32_t>(value)); }
  void end(std::string_view section) {
    numbers_.text(fmt::format("{}$End{}\n", numbers_.is_text() ? "" : "\n", section));
  }

  void write_nodes() {
    numbers_.text(fmt::format("$Nodes\n{}\n", mesh_->nodes.size()));
    for (std::size_t i = 0; i < mesh_->nodes.size(); ++i) {
      integer(mesh_->node_tags[i]);
      numbers_.vector(mesh_->nodes[i]);
      numbers_.end_line();
    }
    end("Nodes");
  }

  void write_elements() {
    numbers_.text(fmt::format("$Elements\n{}\n", total_listings(*mesh_)));
    for (const ElementBlock& block : mesh_->blocks)
      for (std::size_t k = 0; k < n_listings(block) && block.size() > 0; ++k) write_run(block, k);
    end("Elements");
  }

  // All elements of a block in one of its groups. Only the first listing has the element's own
  // number, because a number stands once in a file.
  void write_run(const ElementBlock& block, std::size_t k) {
    constexpr Tag n_tags = 2;
    const Tag type = gmsh_number(block.type);
    const Tag group = block.physical_groups.empty() ? 0 : block.physical_groups[k];
    if (!numbers_.is_text()) integer(type), integer(block.size()), integer(n_tags);
    for (Index i = 0; i < block.size(); ++i) {
      integer(k == 0 ? block.tags[static_cast<std::size_t>(i)] : ++next_tag_);
      if (numbers_.is_text()) integer(type), integer(n_tags);
      integer(group);
      integer(block.entity);
      for (const Index node : block.element(i)) integer(mesh_->node_tags[node]);
      numbers_.end_line();
    }
  }

  // Text in both encodings.
  void write_periodic() {
    if (mesh_->periodic_links.empty()) return;
    numbers_.text(fmt::format("$Periodic\n{}\n", mesh_->periodic_links.size()));
    for (const PeriodicLink& link : mesh_->periodic_links) {
      numbers_.text(fmt::format("{} {} {}\n", link.dimension, link.entity, link.master_entity));
      if (!link.affine.empty()) write_affine(link.affine);
      numbers_.text(fmt::format("{}\n", link.nodes.size()));
      for (const auto& [slave, master] : link.nodes)
        numbers_.text(fmt::format("{} {}\n", mesh_->node_tags[slave], mesh_->node_tags[master]));
    }
    numbers_.text("$EndPeriodic\n");
  }

  void write_affine(const std::vector<double>& affine) {
    std::string line = "Affine";
    for (const double value : affine) {
      line += ' ';
      line += shortest(value);
    }
    numbers_.text(line + "\n");
  }

  const Mesh* mesh_;
  NumberWriter numbers_;
  Tag next_tag_;  ///< the last number given
};

void check_int(Tag value, std::string_view thing, const std::filesystem::path& path) {
  if (!std::in_range<std::int32_t>(value))
    throw InputError(
        fmt::format("{}: the number {} of {} is beyond 2^31 - 1, which MSH 2.2 cannot hold; write "
                    "MSH 4.1",
                    path.string(), value, thing));
}

}  // namespace

void check_for_msh2(const Mesh& mesh, const std::filesystem::path& path) {
  check_for_msh(mesh, path);
  for (const Tag tag : mesh.node_tags) check_int(tag, "a node", path);
  for (const ElementBlock& block : mesh.blocks) {
    check_int(block.entity, "an entity", path);
    for (const Tag group : block.physical_groups) check_int(group, "a group", path);
  }
  check_int(largest_tag(mesh), "an element", path);
  check_int(largest_tag(mesh) + total_listings(mesh) - n_elements(mesh), "an element", path);
}

void write_new_msh2(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  Writer(mesh, output, options.encoding.value_or(Encoding::text)).write_all();
}

}  // namespace roughmesh::detail
