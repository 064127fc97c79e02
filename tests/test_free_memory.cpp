// SPDX-License-Identifier: BSD-3-Clause
// Free memory is the least of what the system and the control groups around the process leave.
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "roughmesh/error.hpp"

#include "free_memory.hpp"

namespace roughmesh::detail {
namespace {

namespace fs = std::filesystem;

/// A folder with the proc/ and sys/ of a machine that the test makes up.
class FreeMemory : public testing::Test {
 protected:
  FreeMemory()
      : root_(fs::temp_directory_path() / ("roughmesh-memory-" + std::to_string(getpid()))) {
    fs::remove_all(root_);
  }
  ~FreeMemory() override { fs::remove_all(root_); }

  void write(const std::string& file, const std::string& content) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << content;
  }

  fs::path root_;
};

TEST_F(FreeMemory, IsUnknownWhereTheSystemDoesNotTell) { EXPECT_FALSE(free_memory(root_)); }

TEST_F(FreeMemory, IsWhatTheSystemHasAvailable) {
  write("proc/meminfo", "MemTotal:  9000 kB\nMemFree:  100 kB\nMemAvailable:   2000 kB\n");
  EXPECT_EQ(free_memory(root_), 2000u * 1024);
}

// Limit 1,000, used 700, of which 100 are cached files that the system gives up: 400 are left.
TEST_F(FreeMemory, IsLimitedByAControlGroupOfVersion2) {
  write("proc/meminfo", "MemAvailable: 2000 kB\n");
  write("proc/self/cgroup", "0::/batch/job\n");
  write("sys/fs/cgroup/batch/job/memory.max", "1000\n");
  write("sys/fs/cgroup/batch/job/memory.current", "700\n");
  write("sys/fs/cgroup/batch/job/memory.stat", "anon 600\ninactive_file 100\n");
  EXPECT_EQ(free_memory(root_), 400u);
  write("sys/fs/cgroup/batch/job/memory.max", "max\n");
  EXPECT_EQ(free_memory(root_), 2000u * 1024);
}

TEST_F(FreeMemory, IsLimitedByTheGroupsAround) {
  write("proc/self/cgroup", "0::/batch/job\n");
  write("sys/fs/cgroup/batch/memory.max", "500\n");
  write("sys/fs/cgroup/batch/memory.current", "600\n");
  EXPECT_EQ(free_memory(root_), 0u);
}

TEST_F(FreeMemory, IsLimitedByAControlGroupOfVersion1) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/a\n4:hugetlb,memory:/b\n");
  write("sys/fs/cgroup/memory/b/memory.limit_in_bytes", "1000\n");
  write("sys/fs/cgroup/memory/b/memory.usage_in_bytes", "900\n");
  write("sys/fs/cgroup/memory/b/memory.stat", "inactive_file 1\ntotal_inactive_file 50\n");
  EXPECT_EQ(free_memory(root_), 150u);
}

TEST_F(FreeMemory, IsNotMisledByFilesThatMakeNoSense) {
  write("proc/meminfo", "MemAvailable: many kB\n\n:::\n");
  write("proc/self/cgroup", "\n0\n::\n");
  EXPECT_FALSE(free_memory(root_));
}

TEST(RequireMemory, TellsWhatIsNeededAndWhatHelps) {
  EXPECT_NO_THROW(require_memory(1, "field of 1 points", "use a coarser mesh"));
  try {
    require_memory(0x1p70, "field of 7 points", "use a coarser mesh");
    if (free_memory()) ADD_FAILURE() << "2^70 bytes are not free";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("field of 7 points: 1099511627776.00 GiB of memory needed, "))
        << text;
    EXPECT_TRUE(text.ends_with(" GiB free; use a coarser mesh or a machine with more memory"))
        << text;
  }
}

}  // namespace
}  // namespace roughmesh::detail
