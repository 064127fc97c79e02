// SPDX-License-Identifier: BSD-3-Clause
// A private temporary folder, and the child process that works in it.
#pragma once

#include <filesystem>
#include <string_view>

#include <sys/types.h>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {

class ScratchEntry;

/// Made with rights for its owner only, removed with all its content by the destructor; also by
/// discard_unfinished_files(), which the handler of an interrupt calls and which first kills the
/// child that works in it.
class ScratchFolder {
 public:
  /// @throws InputError  no temporary folder can be made
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

  /// The process group that is killed on an interrupt; 0 for none.
  void set_child(pid_t group) const;

 private:
  std::filesystem::path path_;
  ScratchEntry* entry_ = nullptr;
};

/// Async-signal-safe: for discard_unfinished_files().
void discard_scratch_folders() noexcept;

}  // namespace roughmesh::detail
