// SPDX-License-Identifier: BSD-3-Clause
// How much memory there is left to allocate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace roughmesh::detail {

/// Bytes that can be allocated without swapping and without being killed: what the system has
/// available, or less where a control group (container, batch job) sets a limit. Nothing where the
/// system does not tell.
/// @param root  folder that holds proc/ and sys/
std::optional<std::uint64_t> free_memory(const std::filesystem::path& root = "/");

}  // namespace roughmesh::detail
