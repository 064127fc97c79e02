// SPDX-License-Identifier: BSD-3-Clause
// Whatever a gmsh does, one clear line comes of it, and nothing stays behind.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "gmsh_process.hpp"
#include "support/errors.hpp"
#include "support/fake_gmsh.hpp"
#include "support/files.hpp"

using namespace roughmesh;
using namespace roughmesh::detail;

namespace {

GmshOutcome run_fake(const std::string& body, const std::vector<std::string>& arguments = {}) {
  const test::FakeGmsh gmsh(body);
  const ScratchFolder folder;
  return run_gmsh(folder, {gmsh.path(), arguments, 60});
}

template <typename E>
std::string message_of(const test::FakeGmsh& gmsh, double timeout) {
  const ScratchFolder folder;
  try {
    run_gmsh(folder, {gmsh.path(), {}, timeout});
  } catch (const E& error) {
    return error.what();
  }
  return "no error";
}

bool is_running(pid_t process) { return ::kill(process, 0) == 0; }

// Waits up to ten seconds for what another process does.
template <typename Condition>
bool happens(Condition condition) {
  for (int i = 0; i < 1000 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

}  // namespace

TEST(GmshProcess, ExitStatusAndOutputComeBack) {
  const GmshOutcome outcome = run_fake("echo one; echo two >&2; exit 7");
  EXPECT_EQ(outcome.exit_status, 7);
  EXPECT_EQ(outcome.output, "one\ntwo\n");
}

TEST(GmshProcess, ArgumentsReachItAsTheyAre) {
  const std::vector<std::string> odd = {"a b", "$(id)", "\"q\"", "; id", "new\nline", "*"};
  const GmshOutcome outcome = run_fake("for a in \"$@\"; do printf '%s|' \"$a\"; done", odd);
  EXPECT_EQ(outcome.output, "a b|$(id)|\"q\"|; id|new\nline|*|");
}

TEST(GmshProcess, ItsHomeAndFolderAreTheScratchFolderAndItsInputIsEmpty) {
  const test::FakeGmsh gmsh("pwd; echo $HOME; echo $GMSH_HOME; cat");
  const ScratchFolder folder;
  const std::string path = folder.path().string();
  ::setenv("GMSH_HOME", "/somewhere", 1);
  EXPECT_EQ(run_gmsh(folder, {gmsh.path(), {}, 60}).output,
            path + "\n" + path + "\n" + path + "\n");
  ::unsetenv("GMSH_HOME");
}

TEST(GmshProcess, OutputIsBoundedAndNeverStopsTheChild) {
  const GmshOutcome outcome = run_fake("yes | head -c 30000000; exit 3");
  EXPECT_EQ(outcome.exit_status, 3);
  EXPECT_EQ(outcome.output.size(), std::size_t{1} << 20);
}

TEST(GmshProcess, AHangIsKilledWithItsChildrenAtTheTimeLimit) {
  const test::FakeGmsh gmsh("sleep 1000 & echo $! > \"$(dirname \"$0\")/child\"; wait");
  EXPECT_EQ(message_of<InputError>(gmsh, 0.5),
            gmsh.path() +
                ": not done after 0.5 s and stopped; ask for a larger --mesh-size or give "
                "it more time with --timeout");
  const pid_t grandchild = std::stoi(test::read_bytes(gmsh.folder() / "child"));
  EXPECT_TRUE(happens([&] { return !is_running(grandchild); }));
}

TEST(GmshProcess, AChildThatClosesItsOutputIsStillTimed) {
  const test::FakeGmsh gmsh("exec >&- 2>&-; sleep 1000");
  EXPECT_NE(message_of<InputError>(gmsh, 0.3).find("not done after 0.3 s"), std::string::npos);
}

TEST(GmshProcess, WhatALeftChildHoldsOpenIsNotWaitedFor) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(run_fake("sleep 1000 & echo done").output, "done\n");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST(GmshProcess, ACrashIsToldWithWhatGmshSaidLast) {
  const test::FakeGmsh gmsh("echo 'Error   : bad surface' >&2; kill -SEGV $$");
  EXPECT_EQ(message_of<NumericalError>(gmsh, 60),
            gmsh.path() +
                ": crashed (Segmentation fault) after: bad surface; try another "
                "--mesh-size or a newer gmsh (--gmsh PATH)");
}

TEST(GmshProcess, FilesAreLimitedInSize) {
  const test::FakeGmsh gmsh("sleep 0.2; exec head -c 3000000 /dev/zero > big");
  const ScratchFolder folder;
  const auto run = [&](std::uint64_t most) {
    return run_gmsh(folder, {gmsh.path(), {}, 60, {}, most}).exit_status;
  };
  EXPECT_EQ(run(3000000), 0);
  try {
    run(2999999);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("larger --mesh-size"), std::string::npos);
  }
  EXPECT_EQ(std::filesystem::file_size(folder / "big"), 2999999U);
}

TEST(GmshProcess, MemoryIsLimited) {
  const test::FakeGmsh gmsh("sleep 0.2; ulimit -v");
  const ScratchFolder folder;
  const std::uint64_t kib = (std::uint64_t{4} << 20) + 1024;  // 4 GiB for programs, 1 MiB
  EXPECT_EQ(run_gmsh(folder, {gmsh.path(), {}, 60, {}, 1U << 20}).output, fmt::format("{}\n", kib));
}

TEST(GmshProcess, AMissingProgramIsToldWithTheRemedy) {
  const ScratchFolder folder;
  EXPECT_EQ(test::message_of([&] {
              run_gmsh(folder, {"no-such-gmsh", {}, 1});
            }),
            "no-such-gmsh: not found; install it or give --gmsh PATH");
  EXPECT_EQ(test::message_of([&] {
              run_gmsh(folder, {"/no/such/gmsh", {}, 1});
            }),
            "/no/such/gmsh: not found; install it or give --gmsh PATH");
  EXPECT_NE(test::message_of([&] {
              run_gmsh(folder, {"/etc/passwd", {}, 1});
            }).find("/etc/passwd: cannot be started: Permission denied"),
            std::string::npos);
}

TEST(GmshProcess, TheProgramMayBeNamedFromTheCallersFolder) {
  const test::FakeGmsh gmsh("echo found");
  const ScratchFolder folder;
  const std::string relative = std::filesystem::relative(gmsh.path()).string();
  ASSERT_NE(relative.find('/'), std::string::npos);
  EXPECT_EQ(run_gmsh(folder, {relative, {}, 60}).output, "found\n");
}

TEST(GmshProcess, ATimeLimitMustBePositive) {
  const ScratchFolder folder;
  for (const double timeout : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(run_gmsh(folder, {"true", {}, timeout}), InputError) << timeout;
  EXPECT_EQ(run_gmsh(folder, {"true", {}, 1e300}).exit_status, 0);
}

TEST(GmshProcess, TheFirstErrorIsFoundAndMadeSafe) {
  EXPECT_EQ(first_error("Info    : x\nError   : 'a', line 1: bad\nError   : other\n"),
            "'a', line 1: bad");
  EXPECT_EQ(first_error("**** ERR StepFile : Incorrect Syntax ****\n"), "Incorrect Syntax");
  EXPECT_EQ(first_error("\n  something\nelse"), "something");
  EXPECT_EQ(first_error(""), "");
  EXPECT_EQ(first_error("Error"), "Error");
  EXPECT_EQ(first_error("Error : a\x1b]0;title\x07"), "a?]0;title?");
  EXPECT_EQ(first_error("Error : " + std::string(5000, 'x')).size(), 203U);
}

TEST(GmshProcess, ColoursAreTakenOut) {
  EXPECT_EQ(run_fake("printf '\\033[31;1mred\\033[0m plain'").output, "red plain");
}

TEST(ScratchFolder, IsPrivateAndGoesWithItsContent) {
  std::filesystem::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    struct stat facts {};
    ASSERT_EQ(::stat(path.c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777, 0700U);
    std::filesystem::create_directories(folder / "a/b");
    test::write_bytes(folder / "a/b/c", "x");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ScratchFolder, SaysSoWhenNoneCanBeMade) {
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", "/no/such/folder", 1);
  EXPECT_NE(test::message_of([] { const ScratchFolder folder; }).find("set TMPDIR"),
            std::string::npos);
  before == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
}

// An interrupt comes while gmsh runs: its group is killed and the folder goes.
TEST(ScratchFolder, AnInterruptKillsTheChildAndRemovesTheFolder) {
  const test::FakeGmsh gmsh(
      "pwd > \"$(dirname \"$0\")/folder\"; sleep 1000 & echo $! > \"$(dirname \"$0\")/child\"; "
      "wait");
  const pid_t caller = ::fork();
  if (caller == 0) {
    std::signal(SIGTERM, [](int) {
      discard_unfinished_files();
      ::_exit(130);
    });
    const ScratchFolder folder;
    test::write_bytes(folder / "left", "x");
    run_gmsh(folder, {gmsh.path(), {}, 60});
    ::_exit(0);
  }
  ASSERT_TRUE(happens([&] { return !test::read_bytes(gmsh.folder() / "child").empty(); }));
  const pid_t grandchild = std::stoi(test::read_bytes(gmsh.folder() / "child"));
  std::string scratch = test::read_bytes(gmsh.folder() / "folder");
  scratch.pop_back();
  ASSERT_TRUE(std::filesystem::exists(scratch + "/left"));
  ::kill(caller, SIGTERM);
  int status = 0;
  ::waitpid(caller, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_FALSE(std::filesystem::exists(scratch));
  EXPECT_TRUE(happens([&] { return !is_running(grandchild); }));
}
