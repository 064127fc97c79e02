// SPDX-License-Identifier: BSD-3-Clause
// Curved elements that are inverted, or nearly so, although their corners are right.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "curved_quality.hpp"
#include "deforming.hpp"
#include "p2_harmonic.hpp"

namespace roughmesh::detail {

/// Linear functions c_k + g_k . y of one place y, of which the least is to become large.
struct LinearFunctions {
  std::vector<double> values;
  std::vector<Vec3> gradients;

  double least(const Vec3& y) const;
};

/// Moves nodes of elements of order 2 that are no corners, one after the other, to where the least
/// determinant of the elements around it is largest: a concave function of its place (docs/math.md,
/// eq. 63). First those of poor elements, then those of their neighbours as well.
class CurvedRepair {
 public:
  /// @param mesh            of volumes or planar; has to outlive this
  /// @param cell_dimension  of the elements
  /// @param is_free         per node: it is no corner and may be moved
  CurvedRepair(const Mesh& mesh, int cell_dimension, NodeFlags is_free);

  /// Leaves every bit of all other nodes, and of all where no element is poor. Elements that were
  /// inverted in the input are none of its business. The same bits on any number of threads.
  void mend(std::span<Vec3> positions) const;

  static constexpr int most_rounds = 20;

 private:
  ElementOrientation orientation(const ElementOfMesh& cell) const;
  enum class Defect : std::uint8_t { poor, inverted };
  bool has(Defect defect, const ElementOfMesh& cell, std::span<const Vec3> positions) const;
  std::vector<Index> poor_cells(std::span<const Index> among, std::span<const Vec3> positions,
                                Defect defect) const;
  std::vector<Index> free_nodes_of(std::span<const Index> cells) const;
  std::vector<std::vector<Index>> cells_at_free_nodes() const;
  std::vector<double> values(const ElementOfMesh& cell, std::span<const Vec3> positions) const;
  double least_quality(std::span<const Index> cells, std::span<const Vec3> positions) const;
  LinearFunctions functions_of(Index node, double size, std::span<const Index> around,
                               std::span<Vec3> positions) const;
  void improve(Index node, std::span<const Index> around, std::span<Vec3> positions) const;

  const Mesh& mesh_;
  NodeFlags is_free_;
  std::vector<ElementOfMesh> cells_;
  std::optional<Vec3> plane_normal_;
};

}  // namespace roughmesh::detail
