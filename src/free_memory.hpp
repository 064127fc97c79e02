// SPDX-License-Identifier: BSD-3-Clause
// How much memory there is left to allocate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace roughmesh::detail {

/// Bytes that can be allocated without swapping and without being killed: what the system has
/// available, or less where a control group (container, batch job) sets a limit. Nothing where the
/// system does not tell.
/// @param root  folder that holds proc/ and sys/
std::optional<std::uint64_t> free_memory(const std::filesystem::path& root = "/");

/// Before anything is allocated, because a system that promises more memory than it has kills the
/// process later.
/// @param bytes   needed
/// @param thing   that needs them, "field of 7 points"
/// @param remedy  "use a coarser mesh"
/// @throws InputError  fewer are free
void require_memory(double bytes, const std::string& thing, const std::string& remedy);

}  // namespace roughmesh::detail
