// SPDX-License-Identifier: BSD-3-Clause
// What a fuzzer does with bytes: reads them as users' files are read, and writes what it got.
#pragma once

#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "roughmesh/mesh_io.hpp"

#include "file_formats.hpp"

namespace roughmesh::fuzz {

inline detail::FileBytes file_of(std::string_view bytes, const std::string& extension) {
  detail::FileBytes file{"fuzz" + extension, std::make_unique<char[]>(bytes.size() + 1),
                         bytes.size()};
  std::memcpy(file.data.get(), bytes.data(), bytes.size());
  return file;
}

/// A mesh that a reader returns has consistent arrays; whoever takes it relies on that.
inline void require_consistent(const Mesh& mesh) {
  if (mesh.node_tags.size() != mesh.nodes.size()) std::abort();
  for (const ElementBlock& block : mesh.blocks) {
    if (block.nodes.size() != block.tags.size() * static_cast<std::size_t>(block.type.n_nodes))
      std::abort();
    for (const Index node : block.nodes)
      if (node < 0 || node >= mesh.n_nodes()) std::abort();
  }
  for (const PeriodicLink& link : mesh.periodic_links)
    for (const auto& [slave, master] : link.nodes)
      if (std::min(slave, master) < 0 || std::max(slave, master) >= mesh.n_nodes()) std::abort();
  for (const Vec3& x : mesh.nodes)
    if (!x.allFinite()) std::abort();
}

/// Reads a mesh file and writes it with every node moved, as a copy and anew.
inline void read_and_write(std::string_view bytes, const std::string& extension) {
  const std::filesystem::path nowhere = "/dev/null";
  detail::FileBytes file = file_of(bytes, extension);
  const detail::FileFormat& format = detail::recognize(file);
  Mesh mesh = format.read(std::move(file));
  require_consistent(mesh);
  for (Vec3& x : mesh.nodes) x += Vec3(0.5, -0.25, 0.125);
  try {
    write_mesh(mesh, nowhere, {.format = mesh.format});
  } catch (const InputError&) {
    // A position that the format cannot hold.
  }
  mesh.source = nullptr;
  if (format.write_new != nullptr) write_mesh(mesh, nowhere, {.format = mesh.format});
}

/// Runs one input of a kind; what is refused in the proper way is good.
template <class Read>
void run(Read&& read) {
  try {
    read();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace roughmesh::fuzz
