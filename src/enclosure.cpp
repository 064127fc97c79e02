// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "roughmesh/check.hpp"
#include "roughmesh/surface.hpp"

#include "corners.hpp"
#include "parallel.hpp"
#include "plane.hpp"
#include "volume_faces.hpp"

namespace roughmesh {
namespace {

// Volume of the cone from `apex` to a face (docs/math.md, eq. 53). A quadrangle is bilinear: the
// mean of its two splittings.
double cone(const Vec3& apex, std::span<const Index> face, std::span<const Vec3> nodes) {
  const auto tetrahedron = [&](std::size_t a, std::size_t b, std::size_t c) {
    return detail::determinant(apex, nodes[face[a]], nodes[face[b]], nodes[face[c]]) / 6;
  };
  if (face.size() == 3) return tetrahedron(0, 1, 2);
  return (tetrahedron(0, 1, 2) + tetrahedron(0, 2, 3) + tetrahedron(0, 1, 3) +
          tetrahedron(1, 2, 3)) /
         2;
}

double triangle(const Vec3& apex, std::span<const Index> line, std::span<const Vec3> nodes,
                const Vec3& normal) {
  return (nodes[line[0]] - apex).cross(nodes[line[1]] - apex).dot(normal) / 2;
}

// Signed, by the order of its nodes.
double size_of(const ElementBlock& block, Index element, std::span<const Vec3> nodes,
               const std::optional<Vec3>& plane_normal) {
  const auto corners = block.element(element);
  const Vec3& apex = nodes[corners[0]];
  double sum = 0;
  std::array<Index, 4> side{};
  for (const std::vector<int>& local : local_faces(block.type.shape)) {
    for (std::size_t k = 0; k < local.size(); ++k) side[k] = corners[local[k]];
    const std::span<const Index> face(side.data(), local.size());
    sum += plane_normal ? triangle(apex, face, nodes, *plane_normal) : cone(apex, face, nodes);
  }
  return sum;
}

double filled(const Mesh& mesh, std::span<const Vec3> nodes, const std::optional<Vec3>& normal) {
  constexpr std::size_t grain = 2048;
  double total = 0;
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != (normal ? 2 : 3)) continue;
    std::vector<double> sums((block.tags.size() + grain - 1) / grain);
    detail::parallel_for(block.tags.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e)
        sums[begin / grain] += size_of(block, static_cast<Index>(e), nodes, normal);
    });
    for (const double sum : sums) total += sum;
  }
  return total;
}

}  // namespace

Enclosure::Enclosure(const Mesh& mesh) {
  const int dim = dimension(mesh);
  if (dim == 2) plane_normal_ = detail::fit_plane(mesh).normal;
  if (dim < 2 || (dim == 2 && !plane_normal_)) return;
  for (const detail::CellFace& face : detail::boundary_faces(mesh, dim)) {
    auto& corners = faces_.emplace_back(std::array<Index, 4>{-1, -1, -1, -1});
    std::copy(face.corners().begin(), face.corners().end(), corners.begin());
  }
  is_exact_ = error(mesh, mesh.nodes, mesh.nodes) <= largest_error;
}

double Enclosure::enclosed(std::span<const Vec3> nodes) const {
  const Vec3& apex = nodes[faces_.front()[0]];
  double sum = 0;
  for (const auto& face : faces_) {
    const auto n = std::find(face.begin(), face.end(), -1) - face.begin();
    const std::span<const Index> corners(face.data(), static_cast<std::size_t>(n));
    sum +=
        plane_normal_ ? triangle(apex, corners, nodes, *plane_normal_) : cone(apex, corners, nodes);
  }
  return sum;
}

// @param outer  positions of the input's nodes, on its boundary
double Enclosure::error(const Mesh& mesh, std::span<const Vec3> nodes,
                        std::span<const Vec3> outer) const {
  if (faces_.empty()) return 0;
  const double volume = enclosed(outer);
  return std::abs(filled(mesh, nodes, plane_normal_) - volume) / std::abs(volume);
}

std::optional<double> Enclosure::volume_error(const Mesh& mesh, std::span<const Vec3> moved) const {
  if (!is_exact_) return std::nullopt;
  return error(mesh, moved, moved);
}

std::optional<double> Enclosure::volume_error_inside(const Mesh& remeshed,
                                                     std::span<const Vec3> moved) const {
  if (!is_exact_) return std::nullopt;
  return error(remeshed, remeshed.nodes, moved);
}

}  // namespace roughmesh
