// SPDX-License-Identifier: BSD-3-Clause
// What every file format promises, as checks on the bytes of one file.
#pragma once

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/process.hpp"

namespace roughmesh::test {

inline Mesh read_as(const TemporaryFolder& folder, const std::string& name,
                    std::string_view bytes) {
  write_bytes(folder / name, bytes);
  return read_mesh(folder / name);
}

inline std::string replaced(std::string bytes, std::string_view what, std::string_view by) {
  const std::size_t place = bytes.find(what);
  if (place == std::string::npos)
    throw std::logic_error("test: nothing to replace: " + std::string(what));
  return bytes.replace(place, what.size(), by);
}

/// A file that has to be refused in one line that names it.
struct Refusal {
  std::string name;  ///< letters, digits and underscores
  std::string bytes;
  std::string part_of_message;
  bool is_input_error = false;  ///< else FormatError
};

inline void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.name; }

inline void expect_refused(const std::string& file, const Refusal& refusal) {
  const TemporaryFolder folder;
  const std::string path = (folder / file).string();
  std::string message = "no error";
  try {
    read_as(folder, file, refusal.bytes);
  } catch (const FormatError& error) {
    EXPECT_FALSE(refusal.is_input_error) << error.what();
    message = error.what();
  } catch (const InputError& error) {
    EXPECT_TRUE(refusal.is_input_error) << error.what();
    message = error.what();
  }
  EXPECT_EQ(message.find(path), 0) << message;
  EXPECT_NE(message.find(refusal.part_of_message), std::string::npos) << message;
  EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << message;
  EXPECT_LT(message.size(), path.size() + 220) << message;
}

inline void expect_consistent(const Mesh& mesh) {
  EXPECT_EQ(mesh.node_tags.size(), mesh.nodes.size());
  for (const Vec3& x : mesh.nodes) EXPECT_TRUE(x.allFinite());
  for (const ElementBlock& block : mesh.blocks) {
    EXPECT_EQ(block.nodes.size(), block.tags.size() * static_cast<std::size_t>(block.type.n_nodes));
    for (const Index node : block.nodes) {
      EXPECT_GE(node, 0);
      EXPECT_LT(node, mesh.n_nodes());
    }
  }
}

/// Read into a consistent mesh whose unchanged copy has the same bytes, or refused in one line.
/// True if it was read.
inline bool is_read_or_refused(const TemporaryFolder& folder, const std::string& file,
                               const std::string& bytes) {
  try {
    const Mesh mesh = read_as(folder, file, bytes);
    expect_consistent(mesh);
    write_mesh(mesh, folder / ("copy_" + file));
    EXPECT_EQ(read_bytes(folder / ("copy_" + file)), bytes);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find_first_of("\n\r"), std::string::npos) << error.what();
    return false;
  }
}

/// Cut short at every byte. @returns how many of the cut files were read
inline int n_read_when_cut(const std::string& file, const std::string& bytes) {
  const TemporaryFolder folder;
  int n = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SCOPED_TRACE(size);
    n += is_read_or_refused(folder, file, bytes.substr(0, size));
  }
  return n;
}

inline void expect_survives_damage(const std::string& file, const std::string& bytes,
                                   int n_trials = 150) {
  const TemporaryFolder folder;
  std::mt19937 random(11);
  for (int trial = 0; trial < n_trials; ++trial) {
    std::string damaged = bytes;
    for (int k = 0; k < 1 + trial % 4; ++k)
      damaged[random() % damaged.size()] = static_cast<char>(random());
    is_read_or_refused(folder, file, damaged);
  }
}

inline void expect_same_topology(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.format, b.format);
  EXPECT_EQ(a.node_tags, b.node_tags);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(a.blocks[i].type, b.blocks[i].type);
    EXPECT_EQ(a.blocks[i].entity, b.blocks[i].entity);
    EXPECT_EQ(a.blocks[i].physical_groups, b.blocks[i].physical_groups);
    EXPECT_EQ(a.blocks[i].nodes, b.blocks[i].nodes);
    EXPECT_EQ(a.blocks[i].tags, b.blocks[i].tags);
  }
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t i = 0; i < a.groups.size(); ++i) {
    EXPECT_EQ(a.groups[i].dimension, b.groups[i].dimension);
    EXPECT_EQ(a.groups[i].tag, b.groups[i].tag);
    EXPECT_EQ(a.groups[i].name, b.groups[i].name);
  }
}

/// Moves nodes, writes, and compares bytes with what has to come out and the mesh with what went
/// in.
inline void expect_patched(const std::string& file, const std::string& before,
                           const std::string& after, const std::function<void(Mesh&)>& move) {
  const TemporaryFolder folder;
  Mesh mesh = read_as(folder, file, before);
  const Mesh read = mesh;
  move(mesh);
  write_mesh(mesh, folder / ("moved_" + file));
  EXPECT_EQ(read_bytes(folder / ("moved_" + file)), after);
  const Mesh moved = read_mesh(folder / ("moved_" + file));
  EXPECT_EQ(moved.nodes, mesh.nodes);
  expect_same_topology(moved, read);
}

/// Elements of each type as what their nodes' positions and groups are: what stays the same
/// whichever way a format orders blocks and numbers.
inline std::vector<std::string> elements_by_position(const Mesh& mesh, bool with_groups = true) {
  std::vector<std::string> elements;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.size(); ++e) {
      std::string text = name(block.type) + ":";
      for (const Index node : block.element(e)) {
        const Vec3& x = mesh.nodes[static_cast<std::size_t>(node)];
        text += fmt::format(" ({:.12g} {:.12g} {:.12g})", x[0], x[1], x[2]);  // gmsh writes 16
      }
      if (with_groups && !block.physical_groups.empty())
        text += fmt::format(" in {}", block.physical_groups.front());
      elements.push_back(text);
    }
  std::sort(elements.begin(), elements.end());
  return elements;
}

/// The mesh as gmsh understands the file.
inline Mesh seen_by_gmsh(const TemporaryFolder& folder, const std::string& file) {
  const Outcome outcome =
      run_in(folder, "gmsh -save -format msh41 -setnumber Mesh.SaveAll 1 -o seen.msh " + file);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ((outcome.out + outcome.err).find("Error"), std::string::npos) << outcome.out;
  return read_mesh(folder / "seen.msh");
}

/// What a line of Python prints of the file that meshio has read as m.
inline std::string seen_by_meshio(const TemporaryFolder& folder, const std::string& file,
                                  const std::string& statements) {
  write_bytes(folder / "show.py",
              "import meshio, sys\nm = meshio.read(sys.argv[1])\n" + statements);
  const Outcome outcome = run_in(folder, "/usr/bin/python3 show.py " + file);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.out;
}

}  // namespace roughmesh::test
