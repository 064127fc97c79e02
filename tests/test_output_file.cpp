// SPDX-License-Identifier: BSD-3-Clause
// A file appears whole or not at all, and nothing else appears.
#include <csignal>
#include <functional>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "output_file.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;
using test::message_of;

namespace {

// Exit status of a child process that runs the action.
int status_of_child(const std::function<int()>& action) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(action());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

mode_t permissions(const std::filesystem::path& path) {
  struct stat facts {};
  EXPECT_EQ(::stat(path.c_str(), &facts), 0);
  return facts.st_mode & 0777;
}

}  // namespace

TEST(WriteText, ReplacesAFileAndKeepsItsPermissions) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.json", "old");
  ::chmod((folder / "a.json").c_str(), 0640);
  write_text("new", folder / "a.json");
  EXPECT_EQ(test::read_bytes(folder / "a.json"), "new");
  EXPECT_EQ(permissions(folder / "a.json"), 0640);
  EXPECT_EQ(folder.n_files(), 1);
}

TEST(WriteText, GivesANewFileTheUsualPermissions) {
  const test::TemporaryFolder folder;
  const mode_t mask = ::umask(027);
  write_text("new", folder / "a.json");
  ::umask(mask);
  EXPECT_EQ(permissions(folder / "a.json"), 0640);
}

TEST(WriteText, FollowsSymbolicLinks) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  test::write_bytes(folder / "there/real", "old");
  std::filesystem::create_symlink("there/real", folder / "link");
  write_text("new", folder / "link");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(test::read_bytes(folder / "there/real"), "new");
}

TEST(WriteText, NamesPathReasonAndRemedy) {
  const test::TemporaryFolder folder;
  const std::filesystem::path missing = folder / "missing/a.json";
  EXPECT_EQ(
      message_of([&] { write_text("x", missing); }),
      missing.string() + ": cannot be written: No such file or directory; make the folder first");
  EXPECT_EQ(message_of([&] { write_text("x", folder.path()); }),
            folder.path().string() + ": cannot be written: Is a directory; name a file in it");
}

TEST(WriteText, RespectsAFileThatForbidsWriting) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.json", "old");
  ::chmod((folder / "a.json").c_str(), 0444);
  EXPECT_NE(message_of([&] { write_text("x", folder / "a.json"); }).find("Permission denied"),
            std::string::npos);
  EXPECT_EQ(test::read_bytes(folder / "a.json"), "old");
}

TEST(WriteText, ReportsAFullDisk) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
  EXPECT_EQ(
      message_of([] { write_text("x", "/dev/full"); }),
      "/dev/full: cannot be written: No space left on device; free some space or choose another "
      "folder");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

// A file size limit stands in for a disk that fills up half-way.
TEST(WriteMesh, LeavesNothingWhereTheDiskFillsUp) {
  const test::TemporaryFolder folder;
  const Mesh mesh = test::icosphere(5);
  write_mesh(mesh, folder / "whole.msh");
  const std::string before = test::read_bytes(folder / "whole.msh");
  ASSERT_GT(before.size(), 500'000U);
  const int status = status_of_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{300'000, 300'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = message_of([&] { write_mesh(mesh, folder / "whole.msh"); });
    const bool is_clear =
        message.find("whole.msh: cannot be written: File too large") != message.npos;
    return is_clear && folder.n_files() == 1 ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(test::read_bytes(folder / "whole.msh"), before);
}

TEST(OutputFile, DisappearsUnlessCommitted) {
  const test::TemporaryFolder folder;
  {
    detail::OutputFile file(folder / "a");
    file.write(std::string(5'000'000, 'x'));
    EXPECT_EQ(folder.n_files(), 1);  // under its temporary name
    EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  }
  EXPECT_EQ(folder.n_files(), 0);
}

// As in the handler of an interrupt: the process ends without any destructor.
TEST(DiscardUnfinishedFiles, RemovesWhatAnInterruptLeaves) {
  const test::TemporaryFolder folder;
  const int status = status_of_child([&] {
    write_text("whole", folder / "finished");
    std::signal(SIGTERM, [](int) {
      discard_unfinished_files();
      ::_exit(130);
    });
    detail::OutputFile first(folder / "a");
    detail::OutputFile second(folder / "b");
    first.write(std::string(5'000'000, 'x'));
    if (folder.n_files() != 3) return 1;
    std::raise(SIGTERM);
    return 2;
  });
  EXPECT_EQ(status, 130);
  EXPECT_EQ(folder.n_files(), 1);
  EXPECT_EQ(test::read_bytes(folder / "finished"), "whole");
}
