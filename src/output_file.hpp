// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {

class UnfinishedFile;

/// Written beside its path under a temporary name and renamed by commit(); the temporary file is
/// removed by the destructor otherwise. A path that is neither a regular file nor missing, such as
/// /dev/stdout, is written directly. Permission bits of a file that is replaced are kept, and a
/// symbolic link stays one.
class OutputFile {
 public:
  /// @throws InputError  no permission, missing folder, a directory
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);  ///< @throws InputError  full disk, file size limit
  void commit();                       ///< @throws InputError  likewise
  const std::filesystem::path& path() const { return path_; }

 private:
  void open_beside();
  void open_directly();
  void keep_permissions() const;
  void flush();
  void write_all(std::string_view bytes) const;
  void close_checked();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;    ///< as the caller names it
  std::filesystem::path target_;  ///< with symbolic links followed
  std::filesystem::path beside_;  ///< temporary name; empty when written directly
  UnfinishedFile* unfinished_ = nullptr;
  int descriptor_ = -1;
  std::string buffer_;
};

}  // namespace roughmesh::detail
