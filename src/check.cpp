// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "roughmesh/error.hpp"
#include "roughmesh/surface.hpp"

#include "corners.hpp"
#include "curved_quality.hpp"
#include "messages.hpp"
#include "parallel.hpp"
#include "plane.hpp"
#include "poor_elements.hpp"

namespace roughmesh {
namespace {

constexpr std::size_t most_findings = 10;
// Below this the sign of a corner Jacobian is round-off, and there is nothing to keep.
constexpr double zero_jacobian = 1e-14;

// Scaled Jacobians at the corners of one element (docs/math.md, eq. 17): the determinant of the
// three edge vectors that leave a corner (in a face: the component of the product of two along the
// normal), over their lengths, over the same for the ideal element.
struct CornerJacobians {
  std::array<double, 8> values{};
  std::size_t n = 0;

  void add(double value) { values[n++] = value; }
  double sum() const {
    double total = 0;
    for (std::size_t i = 0; i < n; ++i) total += values[i];
    return total;
  }
};

// One over the unscaled value of the ideal element: regular tetrahedron; cube; right prism on an
// equilateral triangle; pyramid of equilateral triangles on a square; equilateral triangle; square.
double ideal_factor(ElementShape shape) {
  switch (shape) {
    case ElementShape::tetrahedron:
    case ElementShape::pyramid:
      return std::numbers::sqrt2;
    case ElementShape::prism:
    case ElementShape::triangle:
      return 2 / std::numbers::sqrt3;
    default:
      return 1;
  }
}

double ratio(double determinant, double lengths) { return lengths > 0 ? determinant / lengths : 0; }

CornerJacobians volume_jacobians(ElementShape shape, std::span<const Index> nodes,
                                 std::span<const Vec3> positions) {
  CornerJacobians result;
  const double factor = ideal_factor(shape);
  for (const detail::CornerTetrahedron& corner : detail::corner_tetrahedra(shape)) {
    const Vec3& x = positions[nodes[corner[0]]];
    const Vec3 a = positions[nodes[corner[1]]] - x;
    const Vec3 b = positions[nodes[corner[2]]] - x;
    const Vec3 c = positions[nodes[corner[3]]] - x;
    result.add(factor * ratio(a.cross(b).dot(c), a.norm() * b.norm() * c.norm()));
  }
  return result;
}

Vec3 face_vector(std::span<const Index> nodes, std::span<const Vec3> positions) {
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < nodes.size(); ++k) corners[k] = positions[nodes[k]];
  return area_vector({corners.data(), nodes.size()});
}

// Corners as seen from the side to which `normal` points: negative where the face runs clockwise.
CornerJacobians face_jacobians(ElementShape shape, std::span<const Index> nodes,
                               std::span<const Vec3> positions, const Vec3& normal) {
  CornerJacobians result;
  const double factor = ideal_factor(shape);
  const std::size_t n = nodes.size();
  std::array<Vec3, 4> edges;  // from corner k to the next
  std::array<double, 4> lengths{};
  for (std::size_t k = 0; k < n; ++k) {
    edges[k] = positions[nodes[(k + 1) % n]] - positions[nodes[k]];
    lengths[k] = edges[k].norm();
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t previous = (k + n - 1) % n;
    result.add(factor *
               ratio(edges[previous].cross(edges[k]).dot(normal), lengths[k] * lengths[previous]));
  }
  return result;
}

// The corners of one block, before and after.
struct BlockView {
  const ElementBlock& block;
  std::span<const Vec3> original;
  std::span<const Vec3> moved;
  std::optional<Vec3> plane_normal = {};  // of both

  std::span<const Index> corners(Index element) const {
    const auto n = static_cast<std::size_t>(n_corners(block.type.shape));
    return block.element(element).first(n);
  }
  // At the original places, then at those moved to.
  std::array<CornerJacobians, 2> jacobians(Index element) const {
    return dimension(block.type.shape) == 3 ? of_cell(corners(element)) : of_face(corners(element));
  }
  // Are curved sides of its elements looked at?
  bool shows_curves() const {
    return (dimension(block.type.shape) == 3 || plane_normal) &&
           detail::JacobianPolynomial::of(block.type) != nullptr;
  }
  // Of the original element.
  detail::ElementOrientation orientation(Index element, double sign) const {
    if (!plane_normal) return {.sign = sign};
    const bool is_turned = plane_normal->dot(face_vector(corners(element), original)) < 0;
    return {.sign = 1, .normal = is_turned ? Vec3(-*plane_normal) : *plane_normal};
  }

 private:
  bool is_moved() const { return moved.data() != original.data(); }
  std::array<CornerJacobians, 2> of_cell(std::span<const Index> nodes) const {
    const CornerJacobians before = volume_jacobians(block.type.shape, nodes, original);
    return {before, is_moved() ? volume_jacobians(block.type.shape, nodes, moved) : before};
  }
  // Both as seen from the side from which the face at its original place runs counter-clockwise.
  std::array<CornerJacobians, 2> of_face(std::span<const Index> nodes) const {
    const Vec3 vector = face_vector(nodes, original);
    const auto normal = [&](const Vec3& own) {
      const Vec3 n = plane_normal ? *plane_normal : own.stableNormalized();
      return n.dot(vector) < 0 ? Vec3(-n) : n;
    };
    const auto before = face_jacobians(block.type.shape, nodes, original, normal(vector));
    if (!is_moved()) return {before, before};
    return {before, face_jacobians(block.type.shape, nodes, moved,
                                   normal(plane_normal ? vector : face_vector(nodes, moved)))};
  }
};

struct ElementResult {
  double quality = 1;
  double quality_before = 1;
  double sign = 1;  // of most Jacobians of the original element
  bool inverted = false;
  bool curved_inverted_before = false;
};

// A corner that has no sign in the input cannot lose it; an element whose corners point both ways
// there counts as oriented like most of it.
ElementResult compare(const BlockView& view, Index element) {
  const auto [before, after] = view.jacobians(element);
  const double orientation = before.sum() < 0 ? -1 : 1;
  constexpr double none = std::numeric_limits<double>::infinity();
  ElementResult result{.quality = none, .quality_before = none, .sign = orientation};
  for (std::size_t i = 0; i < before.n; ++i) {
    result.quality = std::min(result.quality, orientation * after.values[i]);
    result.quality_before = std::min(result.quality_before, orientation * before.values[i]);
    const bool has_sign = std::abs(before.values[i]) > zero_jacobian;
    const bool keeps_sign =
        std::signbit(before.values[i]) == std::signbit(after.values[i]) && after.values[i] != 0;
    if (has_sign && !keeps_sign) result.inverted = true;
  }
  return result;
}

// What curved sides add: elements of order 2 have to be positive everywhere (docs/math.md, eq. 61),
// those that are not in the input as far as their corners tell.
ElementResult compare_curved(const BlockView& view, Index element, const ElementResult& corners,
                             bool is_new) {
  const double sign = corners.sign;
  const detail::ElementOrientation orientation = view.orientation(element, sign);
  const auto at = [&](std::span<const Vec3> positions) {
    return detail::curved_quality(view.block.type, view.block.element(element), positions,
                                  orientation);
  };
  ElementResult result = corners;
  const std::optional<detail::LeastValue> after = at(view.moved);
  if (!after) return result;
  result.quality = std::min(result.quality, after->value);
  if (after->is_positive) return result;
  const auto before = is_new ? std::nullopt : at(view.original);
  result.curved_inverted_before = before && !before->is_positive;
  if (!result.curved_inverted_before) result.inverted = true;
  return result;
}

struct Bad {
  double value;
  Tag tag;
  std::size_t block;
  Index element;

  friend bool operator<(const Bad& a, const Bad& b) {
    return a.value != b.value ? a.value < b.value : a.tag < b.tag;
  }
};

struct Summary {
  std::int64_t n_inverted = 0;
  double min_quality = 1;
  std::int64_t n_corners_only = 0;
  std::int64_t n_inverted_before = 0;
  std::vector<Bad> worst;  // ascending, at most most_findings

  void add_inverted(const Bad& bad) {
    ++n_inverted;
    worst.push_back(bad);
  }
  void keep_worst() {
    std::stable_sort(worst.begin(), worst.end());
    if (worst.size() > most_findings) worst.resize(most_findings);
  }
  void add(const Summary& other) {
    n_inverted += other.n_inverted;
    min_quality = std::min(min_quality, other.min_quality);
    n_corners_only += other.n_corners_only;
    n_inverted_before += other.n_inverted_before;
    worst.insert(worst.end(), other.worst.begin(), other.worst.end());
    keep_worst();
  }
};

// Where to look; new curved elements have no former place that would excuse them.
enum class Depth : std::uint8_t { corners, curves, new_curves };

Summary summarize_range(const BlockView& view, std::size_t block, std::size_t begin,
                        std::size_t end, Depth depth) {
  Summary summary;
  const bool shows_curves = depth != Depth::corners && view.shows_curves();
  for (std::size_t i = begin; i < end; ++i) {
    const auto element = static_cast<Index>(i);
    ElementResult result = compare(view, element);
    if (shows_curves) result = compare_curved(view, element, result, depth == Depth::new_curves);
    summary.n_inverted_before += result.curved_inverted_before;
    summary.min_quality = std::min(summary.min_quality, result.quality);
    if (!result.inverted) continue;
    summary.add_inverted({result.quality, view.block.tags[i], block, element});
  }
  summary.keep_worst();
  return summary;
}

Summary summarize(const Mesh& mesh, std::span<const Vec3> moved,
                  const std::optional<Vec3>& plane_normal, Depth depth = Depth::curves) {
  constexpr std::size_t grain = 2048;
  const int dim = dimension(mesh);
  Summary total;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const BlockView view{mesh.blocks[b], mesh.nodes, moved, plane_normal};
    if (dim < 2 || dimension(view.block.type.shape) != dim) continue;
    if (view.block.type.order > 1 && !view.shows_curves())
      total.n_corners_only += view.block.size();
    const std::size_t n = view.block.tags.size();
    std::vector<Summary> parts((n + grain - 1) / grain);
    detail::parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
      parts[begin / grain] = summarize_range(view, b, begin, end, depth);
    });
    for (const Summary& part : parts) total.add(part);
  }
  return total;
}

std::vector<std::uint8_t> volume_nodes(const Mesh& mesh) {
  std::vector<std::uint8_t> in_volume(mesh.nodes.size(), 0);
  for (const ElementBlock& block : mesh.blocks)
    if (dimension(block.type.shape) == 3)
      for (const Index node : block.nodes) in_volume[node] = 1;
  return in_volume;
}

// Folded faces beside the volume. A face that is one of the volume's only has nodes of the volume,
// and the elements there tell whether it is valid.
Summary summarize_loose_faces(const Mesh& mesh, std::span<const Vec3> moved) {
  Summary summary;
  if (dimension(mesh) < 3) return summary;
  const std::vector<std::uint8_t> in_volume = volume_nodes(mesh);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const BlockView view{mesh.blocks[b], mesh.nodes, moved};
    if (dimension(view.block.type.shape) != 2) continue;
    for (Index e = 0; e < view.block.size(); ++e) {
      const auto corners = view.corners(e);
      if (std::all_of(corners.begin(), corners.end(), [&](Index n) { return in_volume[n]; }))
        continue;
      const ElementResult result = compare(view, e);
      if (result.inverted) summary.add_inverted({result.quality, view.block.tags[e], b, e});
    }
  }
  summary.keep_worst();
  return summary;
}

Finding make_finding(const BlockView& view, const Bad& bad) {
  Vec3 centre = Vec3::Zero();
  const auto corners = view.corners(bad.element);
  for (const Index node : corners) centre += view.moved[node];
  const bool is_cell = dimension(view.block.type.shape) == 3 || view.plane_normal;
  const char* what = is_cell ? "inverted" : "folded";
  return {fmt::format("{} {}", what, name(view.block.type)), bad.tag,
          centre / static_cast<double>(corners.size()), bad.value, 0.0};
}

// Normal of the plane of a planar mesh that was moved within it.
std::optional<Vec3> common_plane(const Mesh& mesh, std::span<const Vec3> moved) {
  if (dimension(mesh) != 2) return std::nullopt;
  const detail::PlaneFit plane = detail::fit_plane(mesh);
  if (!plane.is_planar()) return std::nullopt;
  double in_plane = 0, out_of_plane = 0;
  for (std::size_t node = 0; node < moved.size(); ++node) {
    const Vec3 shift = moved[node] - mesh.nodes[node];
    in_plane = std::max(in_plane, shift.cross(*plane.normal).norm());
    out_of_plane = std::max(out_of_plane, std::abs(shift.dot(*plane.normal)));
  }
  constexpr double round_off = 1e-6;
  return out_of_plane <= round_off * in_plane ? plane.normal : std::nullopt;
}

void check_positions(const Mesh& mesh, std::span<const Vec3> moved) {
  if (moved.size() != mesh.nodes.size())
    throw InputError(fmt::format("{} positions for a mesh of {} nodes; give one per node",
                                 moved.size(), mesh.nodes.size()));
  for (std::size_t node = 0; node < moved.size(); ++node)
    if (!moved[node].allFinite())
      throw NumericalError(
          fmt::format("node {} moved from {} to a position that is not finite; lower the heights",
                      mesh.node_tags[node], detail::place(mesh.nodes[node])));
}

}  // namespace

namespace detail {

std::vector<std::uint8_t> nodes_of_poor_elements(const Mesh& mesh, std::span<const Vec3> moved,
                                                 const PoorLimit& limit,
                                                 std::span<const std::uint8_t> others) {
  constexpr std::size_t grain = 2048;
  std::vector<std::uint8_t> result(mesh.nodes.size(), 0);
  const std::optional<Vec3> plane_normal = common_plane(mesh, moved);
  for (const ElementBlock& block : mesh.blocks) {
    if (dimension(block.type.shape) != dimension(mesh)) continue;
    const BlockView view{block, mesh.nodes, moved, plane_normal};
    std::vector<std::uint8_t> is_poor(block.tags.size(), 0);
    parallel_for(is_poor.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ElementResult element = compare(view, static_cast<Index>(i));
        const double least = limit.share * std::min(element.quality_before, limit.enough);
        is_poor[i] = element.inverted || element.quality < least;
      }
    });
    const auto is_other = [&](Index node) { return !others.empty() && others[node] != 0; };
    for (Index e = 0; e < block.size(); ++e) {
      const auto corners = view.corners(e);
      if (is_poor[e] == 0 || std::any_of(corners.begin(), corners.end(), is_other)) continue;
      for (const Index node : corners) result[node] = 1;
    }
  }
  return result;
}

}  // namespace detail

double min_quality(const Mesh& mesh) {
  return summarize(mesh, mesh.nodes, common_plane(mesh, mesh.nodes)).min_quality;
}

namespace {

MeshCheck check_to(Depth depth, const Mesh& mesh, std::span<const Vec3> moved) {
  check_positions(mesh, moved);
  const std::optional<Vec3> plane_normal = common_plane(mesh, moved);
  Summary summary = summarize(mesh, moved, plane_normal, depth);
  summary.add(summarize_loose_faces(mesh, moved));
  MeshCheck check{.inverted_elements = summary.n_inverted,
                  .min_quality = summary.min_quality,
                  .n_corners_only = summary.n_corners_only,
                  .curved_inverted_before = summary.n_inverted_before,
                  .findings = {}};
  for (const Bad& bad : summary.worst)
    check.findings.push_back(
        make_finding({mesh.blocks[bad.block], mesh.nodes, moved, plane_normal}, bad));
  return check;
}

}  // namespace

MeshCheck detail::check_corners(const Mesh& mesh, std::span<const Vec3> moved) {
  return check_to(Depth::corners, mesh, moved);
}

MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved) {
  return check_to(Depth::curves, mesh, moved);
}

namespace {

void add_volume_error(std::optional<double> error, MeshCheck& check) {
  check.volume_error = error;
  if (!check.volumes_add_up())
    check.findings.push_back(
        {"the volumes of the elements do not add up to what the boundary "
         "encloses",
         0, Vec3::Zero(), *check.volume_error, Enclosure::largest_error});
}

}  // namespace

MeshCheck check_mesh(const Mesh& mesh, std::span<const Vec3> moved, const Enclosure& enclosure) {
  MeshCheck check = check_mesh(mesh, moved);
  add_volume_error(enclosure.volume_error(mesh, moved), check);
  return check;
}

MeshCheck check_remeshed(const Mesh& remeshed, std::span<const Vec3> moved,
                         const Enclosure& enclosure) {
  MeshCheck check = check_to(Depth::new_curves, remeshed, remeshed.nodes);
  add_volume_error(enclosure.volume_error_inside(remeshed, moved), check);
  return check;
}

}  // namespace roughmesh
