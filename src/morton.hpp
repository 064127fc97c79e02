// SPDX-License-Identifier: BSD-3-Clause
// Points along Morton's curve, which keeps near ones near each other in memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roughmesh/distance.hpp"
#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// The low 21 bits of three numbers, interleaved, those of x lowest.
std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z);

/// Position of each place along Morton's curve: its coordinates within the bounding cube, 21 bits
/// each, interleaved, those of x lowest.
/// @param places  finite
/// @param shift   in [0, 1): moves the places by this part of the cube along its diagonal, through
///                a curve that is twice as large
std::vector<std::uint64_t> morton_codes(std::span<const Vec3> places, double shift = 0);

/// Points by code, equal ones by their number.
std::vector<Index> morton_order(std::span<const std::uint64_t> codes);

/// Points along Morton's curve through their bounding cube.
std::vector<Index> morton_order(std::span<const Vec3> places);

/// Places whose Euclidean distance is small where this one is. Pieces of a curve, one step apart in
/// y, are moved as far apart as they are long.
std::vector<Vec3> comparable_places(std::span<const Vec3> places, const Distance& distance);

/// Points along Morton's curve through their comparable places.
std::vector<Index> morton_order(std::span<const Vec3> places, const Distance& distance);

}  // namespace roughmesh::detail
