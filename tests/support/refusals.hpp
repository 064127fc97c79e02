// SPDX-License-Identifier: BSD-3-Clause
// Files that are not what they claim to be: read or refused in one line, never a crash.
#pragma once

#include <filesystem>
#include <ostream>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"

namespace roughmesh::test {

enum class Kind { format_error, input_error };

/// A file that is refused.
struct Refusal {
  std::string name;  ///< letters, digits and underscores
  std::string file;
  std::string bytes;
  Kind kind = Kind::format_error;
  std::string part_of_message = {};
};

inline void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.name; }

inline std::string replaced(std::string bytes, const std::string& what, const std::string& by) {
  const std::size_t place = bytes.find(what);
  if (place == std::string::npos) throw std::logic_error("test: nothing to replace: " + what);
  return bytes.replace(place, what.size(), by);
}

/// What reading the file throws, as one line that names it.
inline void expect_error(const std::filesystem::path& path, Kind kind, const std::string& part) {
  std::string message = "no error";
  try {
    read_mesh(path);
  } catch (const FormatError& error) {
    EXPECT_EQ(kind, Kind::format_error) << error.what();
    message = error.what();
  } catch (const InputError& error) {
    EXPECT_EQ(kind, Kind::input_error) << error.what();
    message = error.what();
  }
  EXPECT_EQ(message.find(path.string()), 0) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << message;
  EXPECT_LT(message.size(), path.string().size() + 200) << message;
}

inline void expect_refusal(const TemporaryFolder& folder, const Refusal& refusal) {
  write_bytes(folder / refusal.file, refusal.bytes);
  expect_error(folder / refusal.file, refusal.kind, refusal.part_of_message);
}

/// The file is refused in one line, or it is a mesh that is whole and comes out as it went in.
inline void expect_read_or_refused(const std::filesystem::path& path) {
  const std::filesystem::path copy = path.parent_path() / ("copy" + path.extension().string());
  try {
    const Mesh mesh = read_mesh(path);
    for (const Vec3& x : mesh.nodes) EXPECT_TRUE(x.allFinite());
    for (const ElementBlock& block : mesh.blocks)
      for (const Index node : block.nodes) EXPECT_TRUE(node >= 0 && node < mesh.n_nodes());
    std::filesystem::remove(copy);
    write_mesh(mesh, copy);
    EXPECT_EQ(read_bytes(copy), read_bytes(path));
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find_first_of("\n\r"), std::string::npos);
  }
}

/// A new file in place of an old one: file systems that write a replaced file to the disk at once
/// would make thousands of trials slow.
inline void write_trial(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::remove(path);
  write_bytes(path, bytes);
}

/// Cut at every byte.
inline void expect_truncations_survived(const TemporaryFolder& folder, const std::string& file,
                                        const std::string& whole) {
  for (std::size_t n = 0; n < whole.size(); ++n) {
    SCOPED_TRACE("cut at byte " + std::to_string(n));
    write_trial(folder / file, whole.substr(0, n));
    expect_read_or_refused(folder / file);
  }
}

/// Up to four bytes at random places become any others.
inline void expect_damage_survived(const TemporaryFolder& folder, const std::string& file,
                                   const std::string& whole, int n_trials = 300) {
  std::mt19937 random(11);
  for (int k = 0; k < n_trials; ++k) {
    SCOPED_TRACE("trial " + std::to_string(k));
    std::string bytes = whole;
    for (int damage = 0; damage < 1 + k % 4; ++damage)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    write_trial(folder / file, bytes);
    expect_read_or_refused(folder / file);
  }
}

}  // namespace roughmesh::test
