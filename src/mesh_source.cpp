// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_source.hpp"

#include <utility>

#include "hash.hpp"

namespace roughmesh::detail {
namespace {

// A hash of hashes: one for each array and text, and the numbers as they are.
class Digest {
 public:
  template <typename T>
  void add(const std::vector<T>& values) {
    words_.push_back(hash(std::span(values)));
  }
  void add(const std::string& text) { words_.push_back(hash(std::string_view(text))); }
  template <typename... Numbers>
  void add_numbers(Numbers... numbers) {
    (words_.push_back(static_cast<std::uint64_t>(numbers)), ...);
  }
  std::uint64_t value() const { return hash(std::span(words_)); }

 private:
  std::vector<std::uint64_t> words_;
};

void add_block(Digest& digest, const ElementBlock& block) {
  digest.add_numbers(block.type.shape, block.type.order, block.type.n_nodes, block.entity);
  digest.add(block.physical_groups);
  digest.add(block.nodes);
  digest.add(block.tags);
}

void add_link(Digest& digest, const PeriodicLink& link) {
  digest.add_numbers(link.dimension, link.entity, link.master_entity);
  digest.add(link.affine);
  digest.add_numbers(link.nodes.size());
  for (const auto& [slave, master] : link.nodes) digest.add_numbers(slave, master);
}

}  // namespace

std::uint64_t topology_hash(const Mesh& mesh) {
  Digest digest;
  digest.add_numbers(mesh.nodes.size(), mesh.blocks.size(), mesh.groups.size());
  digest.add(mesh.node_tags);
  for (const ElementBlock& block : mesh.blocks) add_block(digest, block);
  for (const PhysicalGroup& group : mesh.groups) {
    digest.add_numbers(group.dimension, group.tag);
    digest.add(group.name);
  }
  for (const PeriodicLink& link : mesh.periodic_links) add_link(digest, link);
  return digest.value();
}

void attach_source(Mesh& mesh, MeshSource source, FileBytes file) {
  source.file = std::move(file);
  source.positions = mesh.nodes;
  source.topology = topology_hash(mesh);
  mesh.source = std::make_shared<const MeshSource>(std::move(source));
}

}  // namespace roughmesh::detail
