// SPDX-License-Identifier: BSD-3-Clause
// The smoothest continuation of vectors from the rims of pieces of surface into them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "roughmesh/mesh.hpp"

namespace roughmesh::detail {

/// What is known of the vector at a node.
enum class NodeRole : std::uint8_t {
  given,   ///< it is handed over
  sought,  ///< it is found
  zero     ///< it is zero
};

/// Minimizes, for each component u, the integral of the squared Laplacian over triangles in space
/// (docs/math.md, eq. 56): a clamped plate. The factorization is made once; of n nodes it takes
/// some n^1.5 operations and n log n numbers.
class SmoothExtension {
 public:
  /// @param triangles  positions in `nodes`; nearly flat ones are left out
  /// @throws InputError      more memory is needed than is free
  /// @throws NumericalError  the factorization failed
  SmoothExtension(std::span<const Vec3> nodes, std::span<const std::array<Index, 3>> triangles,
                  std::span<const NodeRole> roles);
  ~SmoothExtension();

  const std::vector<Index>& given() const;   ///< nodes of triangles with that role, ascending
  const std::vector<Index>& sought() const;  ///< likewise

  /// @param values  one for each of given()
  /// @return        one for each of sought(); the same bits on any number of threads
  /// @throws NumericalError  the solution does not solve the system
  std::vector<Vec3> extend(std::span<const Vec3> values) const;

 private:
  struct Plan;
  std::unique_ptr<const Plan> plan_;
};

}  // namespace roughmesh::detail
