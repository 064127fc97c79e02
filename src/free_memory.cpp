// SPDX-License-Identifier: BSD-3-Clause
#include "free_memory.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fmt/format.h>

#include "roughmesh/error.hpp"

namespace roughmesh::detail {
namespace {

namespace fs = std::filesystem;

/// Where one version of control groups keeps its numbers.
struct GroupFiles {
  fs::path mount;  ///< below the root folder
  std::string limit;
  std::string usage;
  std::string reclaimable;  ///< entry of memory.stat: cached files the system drops when asked
};

const GroupFiles version_1{"sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
                           "total_inactive_file"};
const GroupFiles version_2{"sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"};

/// The only number of a file; nothing if it is missing or holds a word such as "max".
std::optional<std::uint64_t> read_number(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

/// The number behind `key` in a file of lines "key number".
std::optional<std::uint64_t> read_entry(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    std::uint64_t number = 0;
    if (words >> word >> number && word == key) return number;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> smaller(std::optional<std::uint64_t> a,
                                     std::optional<std::uint64_t> b) {
  if (!a || !b) return a ? a : b;
  return std::min(*a, *b);
}

/// What was freed but kept for later arrays.
void return_unused_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::optional<std::uint64_t> free_in_group(const fs::path& folder, const GroupFiles& files) {
  const auto limit = read_number(folder / files.limit);
  const auto usage = read_number(folder / files.usage);
  if (!limit || !usage) return std::nullopt;
  const auto reclaimable = read_entry(folder / "memory.stat", files.reclaimable).value_or(0);
  const std::uint64_t in_use = *usage - std::min(*usage, reclaimable);
  return *limit - std::min(*limit, in_use);
}

/// Least over a group and the groups around it, each of which may set a limit.
std::optional<std::uint64_t> free_in_groups(const fs::path& root, const std::string& group,
                                            const GroupFiles& files) {
  const fs::path mount = root / files.mount;
  std::optional<std::uint64_t> free = free_in_group(mount, files);
  fs::path folder = mount;
  for (const fs::path& part : fs::path(group).relative_path())
    free = smaller(free, free_in_group(folder /= part, files));
  return free;
}

bool has_word(const std::string& comma_separated, const std::string& word) {
  std::istringstream words(comma_separated);
  for (std::string each; std::getline(words, each, ',');)
    if (each == word) return true;
  return false;
}

/// From the lines "number:controllers:group" of /proc/self/cgroup; version 2 names no controllers.
std::optional<std::uint64_t> free_in_own_groups(const fs::path& root) {
  std::ifstream in(root / "proc/self/cgroup");
  std::optional<std::uint64_t> free;
  std::string number, controllers, group;
  while (std::getline(in, number, ':') && std::getline(in, controllers, ':') &&
         std::getline(in, group)) {
    if (controllers.empty()) free = smaller(free, free_in_groups(root, group, version_2));
    if (has_word(controllers, "memory"))
      free = smaller(free, free_in_groups(root, group, version_1));
  }
  return free;
}

}  // namespace

std::optional<std::uint64_t> free_memory(const fs::path& root) {
  auto available = read_entry(root / "proc/meminfo", "MemAvailable:");
  if (available) *available *= 1024;
  return smaller(available, free_in_own_groups(root));
}

void require_memory(double bytes, const std::string& thing, const std::string& remedy) {
  const auto is_enough = [&](const std::optional<std::uint64_t>& free) {
    return !free || bytes <= static_cast<double>(*free);
  };
  if (is_enough(free_memory())) return;
  return_unused_memory();
  const auto free = free_memory();
  if (is_enough(free)) return;
  throw InputError(
      fmt::format("{}: {:.2f} GiB of memory needed, {:.2f} GiB free; {} or a machine "
                  "with more memory",
                  thing, bytes / 0x1p30, static_cast<double>(*free) / 0x1p30, remedy));
}

}  // namespace roughmesh::detail
