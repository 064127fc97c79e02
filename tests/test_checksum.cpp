// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "roughmesh/mesh_io.hpp"

#include "hash.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/msh_files.hpp"

using namespace roughmesh;

// XXH3_64bits with seed 0: the empty input from the tables of xxHash, "a" from those of
// python-xxhash.
TEST(Hash, GivesPublishedValues) {
  EXPECT_EQ(detail::hash(std::string_view("")), 0x2d06800538d394c2U);
  EXPECT_EQ(detail::hash(std::string_view("a")), 16629034431890738719U);
}

TEST(Checksum, IsThatOfTheBytesOfTheFile) {
  const test::TemporaryFolder folder;
  const std::string bytes = "3 1\n0 0 0 1 0 0 0 1 0\n3 0 1 2";
  const auto checksum_of = [&](const std::string& content) {
    test::write_bytes(folder / "a.ply2", content);
    return checksum(read_mesh(folder / "a.ply2"));
  };
  const std::string sum = checksum_of(bytes);
  EXPECT_EQ(sum.size(), 16U);
  EXPECT_EQ(sum.find_first_not_of("0123456789abcdef"), sum.npos);
  EXPECT_EQ(std::stoull(sum, nullptr, 16), detail::hash(std::string_view(bytes)));
  EXPECT_EQ(checksum_of(bytes), sum);
  std::string changed = bytes;
  changed[4] ^= 1;  // the first coordinate becomes 1
  EXPECT_NE(checksum_of(changed), sum);
  EXPECT_NE(checksum_of(bytes + "\n"), sum);
}

// The sum names the input: it stays when nodes move, and the file of the moved mesh has another.
TEST(Checksum, BelongsToTheFileNotToThePositions) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.msh", test::msh_bytes(test::plate(2), {.version = 2}));
  Mesh mesh = read_mesh(folder / "a.msh");
  const std::string sum = checksum(mesh);
  mesh.nodes[0][2] = 0.5;
  EXPECT_EQ(checksum(mesh), sum);
  write_mesh(mesh, folder / "b.msh");
  EXPECT_NE(checksum(read_mesh(folder / "b.msh")), sum);
}

TEST(Checksum, IsEmptyForAMeshMadeInMemory) { EXPECT_EQ(checksum(test::plate(1)), ""); }
