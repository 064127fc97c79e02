// SPDX-License-Identifier: BSD-3-Clause
// Programs that fail as gmsh might.
#pragma once

#include <filesystem>
#include <string>

#include <sys/stat.h>

#include "support/files.hpp"

namespace roughmesh::test {

/// A shell script that stands in for gmsh.
class FakeGmsh {
 public:
  explicit FakeGmsh(const std::string& body) : path_(folder_ / "gmsh") {
    write_bytes(path_, "#!/bin/sh\n" + body);
    ::chmod(path_.c_str(), 0700);
  }
  std::string path() const { return path_.string(); }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace roughmesh::test
