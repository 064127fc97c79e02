// SPDX-License-Identifier: BSD-3-Clause
// Every file of the fuzzers' corpus is read or refused in the proper way, in every build.
#include <filesystem>

#include <gtest/gtest.h>

#include "fuzz/readers.hpp"
#include "support/files.hpp"

using namespace roughmesh;

namespace {

const std::filesystem::path corpus =
    std::filesystem::path(ROUGHMESH_SOURCE_DIR) / "tests/fuzz/corpus";

}  // namespace

TEST(FuzzCorpus, EveryMeshFileIsReadOrRefused) {
  int n_files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
    const std::string kind = entry.path().parent_path().filename();
    if (!entry.is_regular_file() || kind == "job" || kind == "table" || kind == "geo") continue;
    SCOPED_TRACE(entry.path());
    const std::string bytes = test::read_bytes(entry.path());
    EXPECT_LT(bytes.size(), 4096U) << "a corpus file should be small";
    EXPECT_NO_THROW(
        fuzz::run([&] { fuzz::read_and_write(bytes, detail::lower_extension(entry.path())); }));
    ++n_files;
  }
  EXPECT_GT(n_files, 0);
}
