// SPDX-License-Identifier: BSD-3-Clause
// Numbers of nodes and elements that a mesh gets beside those of its file.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "roughmesh/error.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// Numbers that follow the largest one in use.
class NewTags {
 public:
  /// @param what  for the message: "node", "element", ...
  explicit NewTags(const char* what) : what_(what) {}

  void keep_off(Tag used) { last_ = std::max(last_, used); }
  void keep_off(std::span<const Tag> used) {
    for (const Tag tag : used) keep_off(tag);
  }

  /// @throws InputError  there is none left
  Tag next() {
    if (last_ == std::numeric_limits<Tag>::max())
      throw InputError(
          fmt::format("{} {} has the largest number there is, and a new {} needs a larger one; "
                      "renumber the file",
                      what_, last_, what_));
    return ++last_;
  }

 private:
  const char* what_;
  Tag last_ = 0;
};

}  // namespace roughmesh::detail
