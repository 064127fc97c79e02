// SPDX-License-Identifier: BSD-3-Clause
// What cannot be written is refused before the run in the words of after it, and trying leaves
// nothing.
#include <functional>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/quadratic.hpp"

using namespace roughmesh;
using test::message_of;

namespace {

void expect_same_refusal(const Mesh& mesh, const std::filesystem::path& path,
                         const std::string& part) {
  const std::string message = message_of([&] { check_output(mesh, path); });
  EXPECT_NE(message.find(part), message.npos) << message;
  EXPECT_EQ(message, message_of([&] { write_mesh(mesh, path); }));
}

}  // namespace

TEST(CheckOutput, RefusesWhatWriteMeshRefuses) {
  const test::TemporaryFolder folder;
  const Mesh mesh = test::plate(1);
  expect_same_refusal(mesh, folder / "a.doc", "extension \".doc\"");
  expect_same_refusal(mesh, folder / "missing/a.msh", "make the folder first");
  std::filesystem::create_directory(folder / "b.msh");
  expect_same_refusal(mesh, folder / "b.msh", "Is a directory");
  expect_same_refusal(test::quadratic_elements({{ElementShape::pyramid, 2, 14}}), folder / "a.vtu",
                      "VTK has no pyramid of order 2");
  expect_same_refusal(Mesh(), folder / "a.msh", "without nodes");
  EXPECT_EQ(folder.n_files(), 1);  // the folder b.msh
}

TEST(CheckOutput, RefusesAFormatThatAChangedMeshCannotHave) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.ply2", "3 1\n0 0 0 1 0 0 0 1 0\n3 0 1 2");
  Mesh mesh = read_mesh(folder / "a.ply2");
  EXPECT_NO_THROW(check_output(mesh, folder / "a.ply2"));
  mesh.blocks[0].nodes = {0, 2, 1};
  expect_same_refusal(mesh, folder / "a.ply2", "use one of .");
}

TEST(CheckOutput, LeavesNothingWhereItSucceeds) {
  const test::TemporaryFolder folder;
  check_output(test::plate(1), folder / "a.msh");
  check_text_output(folder / "a.json");
  EXPECT_EQ(folder.n_files(), 0);
  test::write_bytes(folder / "old.msh", "old");
  check_output(test::plate(1), folder / "old.msh");
  EXPECT_EQ(test::read_bytes(folder / "old.msh"), "old");
  EXPECT_EQ(folder.n_files(), 1);
}

TEST(CheckOutput, RefusesWithoutPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.msh", "old");
  ::chmod((folder / "a.msh").c_str(), 0444);
  expect_same_refusal(test::plate(1), folder / "a.msh", "Permission denied");
  std::filesystem::create_directory(folder / "closed");
  ::chmod((folder / "closed").c_str(), 0555);
  expect_same_refusal(test::plate(1), folder / "closed/a.msh", "Permission denied");
}

TEST(CheckTextOutput, RefusesWhatWriteTextRefuses) {
  const test::TemporaryFolder folder;
  for (const std::filesystem::path& path : {folder / "missing/a.json", folder.path()}) {
    const std::string message = message_of([&] { check_text_output(path); });
    EXPECT_NE(message, "no error");
    EXPECT_EQ(message, message_of([&] { write_text("x", path); }));
  }
}

// A reader that waits at the other end must not see a writer come and go.
TEST(CheckTextOutput, LeavesAPipeToItsReader) {
  const test::TemporaryFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const auto has_hung_up = [&] {
    pollfd state{reader, POLLIN, 0};
    ::poll(&state, 1, 0);
    return (state.revents & POLLHUP) != 0;
  };
  check_text_output(pipe);
  EXPECT_FALSE(has_hung_up());
  write_text("x", pipe);
  EXPECT_TRUE(has_hung_up());
  ::close(reader);
}
